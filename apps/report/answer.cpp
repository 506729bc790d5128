#include "apps/report/answer.hpp"

#include <algorithm>
#include <cmath>

namespace wheeltap::apps {
namespace {

constexpr double kDecided = 0.6;
constexpr double kCertain = 0.95;
constexpr double kWorthNaming = 0.1;
constexpr double kLocated = 0.25;  // of the beam

std::string in_words(const std::vector<std::string>& items, const std::string& last) {
  std::string text;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (i > 0) text += i + 1 == items.size() ? " " + last + " " : ", ";
    text += items[i];
  }
  return text;
}

// "2 damages" is said "two damages", "0 damages" "no damage"; a sid model's name stays as it is.
std::string said(const std::string& model, bool counts) {
  if (!counts) return "“" + model + "”";
  static const char* words[] = {"no",  "one",   "two",   "three", "four", "five",
                                "six", "seven", "eight", "nine",  "ten"};
  std::string text;
  for (std::size_t from = 0; from < model.size();) {
    const std::size_t end = std::min(model.find(", ", from), model.size());
    std::string part = model.substr(from, end - from);
    const std::size_t space = part.find(' ');
    const bool number = space != std::string::npos && space > 0 &&
                        part.find_first_not_of("0123456789") == space && space < 3;
    if (number && std::stoi(part) <= 10) {
      const int n = std::stoi(part);
      part = words[n] + part.substr(space);
      if (n == 0 && part.ends_with('s')) part.pop_back();
    }
    text += (text.empty() ? "" : " and ") + part;
    from = end + 2;
  }
  return text;
}

std::string percent_of(double fraction) {
  return fixed(100.0 * fraction, 0) + " %";
}

bool usable(const Report& row, const char* key) {
  return row.contains(key) && row[key].is_number();
}

std::string median(const Report& row) {
  return resolved(row["q50"], row["q97.5"].get<double>() - row["q2.5"].get<double>());
}

std::string interval(const Report& row, const std::string& unit) {
  const double low = row["q2.5"], high = row["q97.5"];
  return resolved(low, high - low) + " to " + resolved(high, high - low) + unit;
}

// One component: "near 0.095 m (0.09 to 0.1 m) or its mirror image 0.905 m, with stiffness …".
std::string between(const Report& x) {
  return fixed(x["q2.5"].get<double>(), 3) + " to " + fixed(x["q97.5"].get<double>(), 3) + " m";
}

std::string place(const Report& table, const std::string& location, const std::string& severity,
                  double length, bool mirrored) {
  const Report& x = table[location];
  const double at = x["q50"];
  const double width = x["q97.5"].get<double>() - x["q2.5"].get<double>();
  std::string text;
  if (width > kLocated * length) {
    text = "not located: anywhere from " + between(x) +
           (mirrored ? " or in the mirror image of that" : "") + " (95 %)";
  } else {
    text = "near " + fixed(at, 3) + " m (95 % interval " + between(x) + ")";
    if (mirrored && std::abs(length - 2.0 * at) > 0.01 * length) {
      text += " or its mirror image " + fixed(length - at, 3) + " m";
    }
  }
  if (!table.contains(severity)) return text;
  const Report& s = table[severity];
  if (severity.find("reduction") != std::string::npos) {
    text += ", stiffness reduced by " + percent_of(s["q50"]) + " (" +
            fixed(100.0 * s["q2.5"].get<double>(), 0) + " to " + percent_of(s["q97.5"]) + ")";
  } else {
    text += ", stiffness " + median(s) + " (" + interval(s, "") + ")";
  }
  return text;
}

std::string where_and_how_bad(const Report& summary, const std::string& model) {
  const bool mirrored = summary["diagnostics"].contains("symmetry");
  const Report& damage = summary["damage"];
  const bool folded = mirrored && damage.contains("folded") && damage["folded"].contains(model);
  const Report& all = folded ? damage["folded"] : summary["parameters"];
  if (!all.contains(model)) return {};
  const double length = summary["beam"]["length"];
  std::vector<std::string> places;
  for (const auto& [name, row] : all[model].items()) {
    const std::size_t at = name.find("location[");
    if (at == std::string::npos || !usable(row, "q50")) continue;
    const std::string prefix = name.substr(0, at), index = name.substr(at + 8);
    std::string severity;
    for (const char* word : {"reduction", "stiffness"}) {
      // A kind's name stands before its parameters only where two kinds share a parameter's name.
      for (const std::string& candidate : {prefix + word + index, word + index}) {
        if (severity.empty() && all[model].contains(candidate) &&
            (prefix.empty() ||
             (prefix == "support ") == (candidate.find("stiff") != std::string::npos))) {
          severity = candidate;
        }
      }
    }
    places.push_back(prefix + place(all[model], name, severity, length, mirrored));
  }
  if (places.empty()) return {};
  std::string text;
  for (std::size_t i = 0; i < places.size(); ++i) {
    std::string one = places[i];
    if (places.size() > 1)
      one = "(" + std::to_string(i + 1) + ") " + one;
    else
      one[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(one[0])));
    text += (i == 0 ? "" : "; ") + one;
  }
  text += ".";
  if (mirrored) text += " Frequencies cannot tell a place from its mirror image.";
  return text;
}

std::string values(const Report& summary, const std::string& model) {
  if (!summary["parameters"].contains(model)) return {};
  std::vector<std::string> parts;
  for (const auto& [name, row] : summary["parameters"][model].items()) {
    if (!usable(row, "q50")) continue;
    if (parts.size() == 6) {
      parts.push_back("others, tabulated below");
      break;
    }
    parts.push_back(name + " = " + median(row) + " (" + interval(row, "") + ")");
  }
  if (parts.empty()) return {};
  return "With 95 % intervals: " + in_words(parts, "and") + ".";
}

// A sweep: which model is the most probable, and where along the values that changes.
Answer answer_of_sweep(const Report& sweep) {
  Answer out;
  const Report& rows = sweep["rows"];
  std::vector<std::string> best;
  std::size_t failed = 0;
  for (const Report& row : rows) {
    const Report* most = nullptr;
    for (const Report& m : row["models"]) {
      if (most == nullptr ||
          m["probability"].get<double>() > (*most)["probability"].get<double>()) {
        most = &m;
      }
    }
    best.push_back(most == nullptr ? "" : (*most)["name"].get<std::string>());
    failed += row.value("converged", false) ? 0 : 1;
  }
  if (failed > 0) {
    out.caution = std::to_string(failed) + " of " + std::to_string(rows.size()) +
                  " runs have not converged: do not trust their numbers yet.";
  }
  std::vector<std::string> stretches;
  for (std::size_t i = 0, j = 0; i < best.size(); i = j) {
    for (j = i; j < best.size() && best[j] == best[i];) ++j;
    const std::string from = rows[i]["value"].dump(), to = rows[j - 1]["value"].dump();
    stretches.push_back(said(best[i], false) +
                        (j - i == 1 ? " at " + from : " from " + from + " to " + to));
  }
  out.headline = "Most probable over " + sweep["path"].get<std::string>() + ": " +
                 in_words(stretches, "and") + ".";
  return out;
}

}  // namespace

Answer answer(const Report& summary) {
  if (summary.contains("sweep")) return answer_of_sweep(summary["sweep"]);
  Answer out;
  const bool damage = summary["wheeltap"].value("command", "") == "damage";
  const Report& diagnostics = summary["diagnostics"];
  const bool converged = diagnostics.value("converged", false);
  if (!converged) {
    out.caution = diagnostics.value("stopped_early", false)
                      ? "This run was stopped before it had converged: do not trust these numbers "
                        "yet."
                      : "The chains have not converged: do not trust these numbers yet.";
  }
  std::vector<Report> models(summary["models"].begin(), summary["models"].end());
  const auto p = [](const Report& m) { return m["probability"].get<double>(); };
  std::ranges::stable_sort(models, [&](const Report& a, const Report& b) { return p(a) > p(b); });
  const std::string best = models[0]["name"];
  const auto named = [&](const Report& m) {
    return said(m["name"], damage) + " (" + percent(p(m)) +
           (m.value("basis", "draws") == "evidence" ? ", by its evidence)" : ")");
  };

  if (models.size() == 1) {
    out.headline = "The case allows only " + said(best, damage) + ".";
  } else if (p(models[0]) >= kDecided) {
    const std::string name = named(models[0]);
    out.headline = p(models[0]) >= kCertain ? name + "." : "Most likely " + name + ".";
    if (!converged) out.headline = "So far: " + out.headline;
    const auto at = static_cast<unsigned char>(out.headline[0]);
    out.headline[0] = static_cast<char>(std::toupper(at));
  } else {
    std::vector<std::string> list;
    for (const Report& m : models) {
      if (p(m) >= kWorthNaming || list.empty()) list.push_back(named(m));
    }
    if (list.size() == 1) list.push_back("others, each below 10 %");
    out.headline = std::string(converged ? "Undecided" : "So far undecided") +
                   (damage ? ": the data allow " : " between models: ") + in_words(list, "or") +
                   ".";
  }

  if (!damage) {
    out.detail = values(summary, best);
    return out;
  }
  const bool none = best.find_first_of("123456789") == std::string::npos;
  if (!none) {
    out.detail = where_and_how_bad(summary, best);
    if (p(models[0]) < kDecided && !out.detail.empty()) {
      out.detail = "If " + said(best, true) + ": " + out.detail;
    }
  } else if (models.size() > 1) {
    out.detail =
        "That there is any at all has a probability of " + percent(1.0 - p(models[0])) +
        (p(models[0]) >= kDecided ? "; what is said below of places is for that case." : ".");
  }
  return out;
}

}  // namespace wheeltap::apps
