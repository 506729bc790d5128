#include "apps/cases/syntax/case_remedies.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "apps/nearest.hpp"
#include "apps/written_number.hpp"

namespace wheeltap::apps {

std::string unknown_parameter(const std::string& text, const std::vector<std::string>& names) {
  if (const std::string number = number_to_write(text); !number.empty())
    return "is a string, but no parameter has this name; " + number;
  const std::string meant = nearest(text, names);
  return "no parameter has this name" + (meant.empty() ? "" : "; did you mean \"" + meant + "\"?") +
         " (/parameters holds: " + listed(names) + ")" +
         (meant.empty() ? "; write a number here, or add \"" + text +
                              "\": {\"uniform\": [lowest, highest]} to /parameters"
                        : "");
}

namespace {

/// The advice to write this prior; empty if it is not within the bounds.
std::string prior_to_write(const CaseFile& file, const Pointer& where, const std::string& text,
                           double lower, double upper) {
  CaseFile changed = file;
  changed.json[where] = Json::parse(text);
  try {
    const inference::Prior prior = parse_prior(changed, where);
    if (!(prior.lower() >= lower && prior.upper() <= upper)) return {};
  } catch (const Failure&) {
    return {};
  }
  return "; write " + text;
}

/// An upper bound for a prior, rounded to few digits within the allowed bounds. For an open bound,
/// a slightly smaller number: 0.999 for [0, 1).
double written_bound(double high, double low, double upper) {
  if (!std::isfinite(high) || std::strtod(pasted(high).c_str(), nullptr) <= upper) return high;
  constexpr double kShare = 1e-3;  // distance from an open bound
  const double rounded = std::strtod(pasted(high).c_str(), nullptr);
  return rounded - kShare * (std::isfinite(low) ? rounded - low : std::abs(rounded));
}

}  // namespace

std::string kept_within(const CaseFile& file, const Pointer& where, double lower, double upper) {
  if (!file.json.contains(where) || !file.json.at(where).is_object()) return {};
  const inference::Prior prior = parse_prior(file, where);
  if (prior.lower() >= lower && prior.upper() <= upper) return {};
  const Json& given = file.json.at(where);
  const double low = std::max(prior.lower(), lower);
  const double high = written_bound(std::min(prior.upper(), upper), low, upper);
  const auto numbers_of = [](const std::vector<double>& numbers) {
    std::string text;
    for (const double x : numbers) {
      if (!std::isfinite(x)) return std::string();
      text += (text.empty() ? "" : ", ") + pasted(x);
    }
    return "[" + text + "]";
  };
  const auto list = [&](const std::string& family, const std::vector<double>& numbers) {
    const std::string text = numbers_of(numbers);
    if (text.empty()) return text;
    return prior_to_write(file, where, "{\"" + family + "\": " + text + "}", lower, upper);
  };
  // Beyond six standard deviations, a normal distribution has a probability below 1e-8.
  constexpr double kFar = 6.0;
  const auto truncated = [&](double mean, double sd) {
    const double from = std::isfinite(low) ? low : mean - kFar * sd;
    const double to = std::isfinite(high) ? high : mean + kFar * sd;
    return from < to ? list("truncated_normal", {mean, sd, from, to}) : std::string();
  };
  if (given.contains("normal"))
    return truncated(given["normal"][0].get<double>(), given["normal"][1].get<double>());
  if (given.contains("half_normal"))
    return truncated(
        0.0, (given["half_normal"].is_number() ? given["half_normal"] : given["half_normal"][0])
                 .get<double>());
  if (given.contains("student_t"))
    return truncated(given["student_t"][1].get<double>(), given["student_t"][2].get<double>());
  if (given.contains("truncated_normal"))
    return truncated(given["truncated_normal"][0].get<double>(),
                     given["truncated_normal"][1].get<double>());
  if (!(low < high)) return {};
  if (given.contains("beta")) {
    const std::string on = numbers_of({low, high});
    return on.empty() ? on
                      : prior_to_write(
                            file, where,
                            "{\"beta\": " + numbers_of(given["beta"].get<std::vector<double>>()) +
                                ", \"on\": " + on + "}",
                            lower, upper);
  }
  if (given.contains("log_uniform")) return list("log_uniform", {low, high});
  return list("uniform", {low, high});
}

std::string increasing(const std::vector<double>& frequencies) {
  std::vector<double> measured;
  for (const double f : frequencies)
    if (!std::isnan(f)) measured.push_back(f);
  const auto list = [](const std::vector<double>& values) {
    std::string text;
    for (const double x : values) text += (text.empty() ? "" : ", ") + pasted(x);
    return "[" + text + "]";
  };
  const auto whole = [](double x) { return x >= 0.0 && x == std::floor(x) && x < 1e6; };
  if (measured.size() == frequencies.size() && measured.size() % 2 == 0 &&
      std::ranges::all_of(measured, whole)) {
    std::vector<double> joined;
    for (std::size_t i = 0; i < measured.size(); i += 2) {
      const auto text = [&](std::size_t j) { return std::to_string(std::lround(measured[j])); };
      joined.push_back(std::strtod((text(i) + "." + text(i + 1)).c_str(), nullptr));
    }
    if (std::ranges::is_sorted(joined))
      return "; use decimal points, not commas: write " + list(joined);
  }
  std::ranges::sort(measured);
  return "; write " + list(measured);
}

}  // namespace wheeltap::apps
