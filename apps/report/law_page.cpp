#include "apps/report/law_page.hpp"

#include <cctype>
#include <vector>

#include "apps/law_words.hpp"
#include "apps/report/law_figure.hpp"

namespace wheeltap::apps {
namespace {

using dynamics::LawCoefficient;
using dynamics::LawInfo;

std::span<const LawCoefficient> coefficients(const LawInfo& info) {
  return std::span(info.coefficients).first(static_cast<std::size_t>(info.size()));
}

/// A force law as a JSON object with `value` of each coefficient, and with the side.
template <class Value>
std::string object(const LawInfo& info, const Value& value, bool everything) {
  std::string text;
  for (const LawCoefficient& c : coefficients(info)) {
    if (!c.required() && !everything) continue;
    text += (text.empty() ? "\"" : ", \"") + std::string(c.name) + "\": " + value(c);
  }
  return "{" + text + (info.one_sided ? R"(, "side": "opening")" : "") + "}";
}

std::string quoted_law(std::string_view text) {
  return '"' + std::string(text) + '"';
}

std::string parameter_form(const LawInfo& info) {
  if (has_short_form(info)) return quoted_law(info.coefficients[0].symbol);
  return object(
      info, [](const LawCoefficient& c) { return quoted_law(c.symbol); }, false);
}

/// The forms in which a case may state the law, one per line.
std::string forms(const LawInfo& info) {
  const auto number = [](const LawCoefficient& c) {
    return plain_number(c.required() ? c.example : c.otherwise);
  };
  const std::string key = quoted_law(info.name) + ": ", known = object(info, number, true);
  std::vector<std::string> lines;
  if (has_short_form(info)) {
    lines = {number(info.coefficients[0]), parameter_form(info)};
  } else {
    lines = {parameter_form(info)};
  }
  lines.push_back(known);
  lines.push_back("[" + parameter_form(info) + ", " + known + "]");
  std::string text;
  for (const std::string& line : lines) text += key + line + "\n";
  return text;
}

std::string prior(const LawCoefficient& c) {
  const double x = c.example;
  return c.above_lower
             ? R"({"log_uniform": [)" + plain_number(x / 10) + ", " + plain_number(x * 10) + "]}"
             : R"({"uniform": [0, )" + plain_number(5 * x) + "]}";
}

}  // namespace

std::string law_section(const LawInfo& info) {
  const std::string name(info.name);
  std::string told = std::string(info.description) + ". " + std::string(info.notes);
  told[0] = static_cast<char>(std::toupper(told[0]));
  std::string text = "## " + name + "\n\n`" + std::string(info.formula) + "`\n\n" + told + "\n\n";
  text += "![" + law_caption(info) + "](figures/" + law_figure_name(info) + ")\n\n*" +
          law_caption(info) + ".*\n\n";
  text +=
      "| key | symbol | unit | default | bounds | description |\n"
      "|---|---|---|---|---|---|\n";
  for (const LawCoefficient& c : coefficients(info)) {
    const std::string bounds = bounds_in_words(c);
    text += "| `" + std::string(c.name) + "` | " + std::string(c.symbol) + " | " +
            std::string(c.unit) + " | " + (c.required() ? "required" : plain_number(c.otherwise)) +
            " | " + (bounds.empty() ? "any number" : bounds) + " | " + std::string(c.words) +
            " |\n";
  }
  if (info.one_sided) {
    text +=
        "| `side` | | | required | `\"opening\"` or `\"closing\"` | `\"opening\"`: acts for e > 0; "
        "`\"closing\"`: acts for e < 0 |\n";
  }
  text += "\nForms in a link:\n\n```text\n" + forms(info) + "```\n\n";
  text += "Complete case:\n\n```json\n" + law_example(info) + "```\n\n```sh\n" + "wheeltap laws " +
          name + " --example > " + name + ".json\n" + "wheeltap sid " + name + ".json -o results/" +
          name + " --quick\n```\n";
  return text;
}

constexpr const char* kIntroduction = R"(# Force laws

In a `sid` case, a link can have a linear spring (`stiffness`), a linear damper (`damping`) and any of the force laws
below. For each force law, this page gives the formula, the keys with their units, a figure and a complete case.
`wheeltap laws` prints this page, `wheeltap laws NAME` prints the section of one law, and `wheeltap laws NAME --example`
prints the complete case of one law.

## Sign conventions and values

```text
      y_a →                    y_b →
      mass a ──── link ──── mass b            "between": [a, b]
           T →          ← T
```

- **Extension.** The extension of a link `"between": [a, b]` is e = y_b - y_a, where y_a and y_b are the displacements
  of the masses. ė is the rate of e. Wheeltap calls e > 0 *opening* and e < 0 *closing*. Mass 0 is the ground or the
  moving base. For the link `[0, 1]` on the ground, e is the displacement of mass 1.
- **Tension.** A tension T > 0 pulls the masses together: the force on mass a is +T, and the force on mass b is -T. A
  linear spring has T = k e, a linear damper has T = c ė, and dry friction has T = F sgn(ė). A spring with k > 0 acts
  towards e = 0. A damper and friction with positive coefficients oppose the relative motion. One mass on the ground
  under the external force f obeys m ÿ = f - T.
- **Sum of laws.** The tension of a link is `stiffness` · e + `damping` · ė plus the tensions of all its force laws. The
  tensions of links between the same two masses add up.
- **Values.** A coefficient is a number (known) or the name of a parameter (unknown, with its prior under `parameters`),
  in SI units. If a law needs only one coefficient, its value may stand in place of the object with the coefficients. A list
  contains several laws of the same kind.
- **Sides.** A law that acts for one sign of e has the key `side`: `"opening"` (e > 0) or `"closing"` (e < 0). The
  tension of a closing law is the mirror image of that of the opening law: T(e) = -T_open(-e). *Opening* and *closing*
  refer to the extension of the link, not to the gap. Example: a mass on the ground, link `[0, 1]`, with a stop at
  positive displacements has `"opening"`; with a stop at negative displacements it has `"closing"`. The gap of a stop on
  the wrong side never closes. If you do not know the side, compare a model with a stop on each side.
- **Rest position.** Springs, gaps and stops are measured from e = 0, where the links of the chain carry no force. The
  `offset` of a channel shifts the zero of its sensor to this position. The value of `offset` may be a parameter.

Example: a link with dry friction and a stop after a gap of unknown width:

```json
{"between": [0, 1], "stiffness": "k", "damping": "c", "coulomb": "F",
 "contact": {"stiffness": "kc", "gap": "g", "side": "opening"}}
```

The priors under `parameters` are then those of k and c, and `"F": {"uniform": [0, 20]}`, `"kc": {"log_uniform":
[1e3, 1e6]}` and `"g": {"uniform": [0, 0.01]}`. For the examples below, add the program to the search path of the shell:

```sh
export PATH="$PWD/build/release/apps:$PATH"
```

The examples are [quick runs](long-runs.md#quick-runs); for complete runs, omit `--quick`. Each example compares a chain
of masses without the law and one with the law. The data are a record that is simulated with the law.

)";

std::string law_example(const LawInfo& info) {
  const std::string name(info.name);
  std::string priors, values;
  for (const LawCoefficient& c : coefficients(info)) {
    if (!c.required()) continue;
    priors += ",\n    " + quoted_law(c.symbol) + ": " + prior(c);
    values += ", " + quoted_law(c.symbol) + ": " + plain_number(c.example);
  }
  return R"({
  "kind": "sid",
  "title": "One mass on a spring, a damper and )" +
         name + R"(",
  "record": {
    "channels": [
      {"column": "force [N]", "role": "force", "mass": 1},
      {"column": "displacement [m]", "role": "response", "mass": 1, "quantity": "displacement"}
    ]
  },
  "parameters": {
    "k": {"uniform": [200, 8000]},
    "c": {"uniform": [0, 40]},
    "noise": {"log_uniform": [1e-6, 1e-2]})" +
         priors + R"(
  },
  "models": [
    {"name": "without )" +
         name + R"(", "masses": [2.0], "noise": "noise",
     "links": [{"between": [0, 1], "stiffness": "k", "damping": "c"}]},
    {"name": "with )" +
         name + R"(", "masses": [2.0], "noise": "noise",
     "links": [{"between": [0, 1], "stiffness": "k", "damping": "c",
                ")" +
         name + "\": " + parameter_form(info) + R"(}]}
  ],
  "truth": {
    "model": "with )" +
         name + R"(",
    "parameters": {"k": 2000, "c": 4, "noise": 1e-4)" +
         values + R"(},
    "noise": 1e-4, "samples": 400, "sample_rate": 200, "seed": 1,
    "excitation": [{"mass": 1, "kind": "white", "variance": 200}]
  }
}
)";
}

std::string laws_page() {
  std::string text = kIntroduction;
  text += "| law | formula | description |\n|---|---|---|\n";
  for (const LawInfo& info : dynamics::law_infos()) {
    std::string formula(info.formula);
    for (std::size_t at = 0; (at = formula.find('|', at)) != std::string::npos; at += 2) {
      formula.replace(at, 1, "\\|");
    }
    text += "| [`" + std::string(info.name) + "`](#" + std::string(info.name) + ") | " + formula +
            " | " + std::string(info.description) + " |\n";
  }
  for (const LawInfo& info : dynamics::law_infos()) text += "\n" + law_section(info);
  return text;
}

}  // namespace wheeltap::apps
