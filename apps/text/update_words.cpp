#include "apps/text/update_words.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "apps/words.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

constexpr std::size_t kMostNamed = 6;

std::string interval(const Marginal& e) {
  return resolved(e.q2_5, e.width()) + " to " + resolved(e.q97_5, e.width());
}

std::string named(std::vector<std::string> names) {
  if (names.size() > 2 * kMostNamed) {
    const std::size_t more = names.size() - kMostNamed;
    names.resize(kMostNamed);
    names.push_back(std::to_string(more) + " others");
  }
  return in_words(names);
}

std::vector<std::string> at_prior(const UpdateFindings& findings) {
  std::vector<std::string> names;
  for (const Contraction& c : findings.contractions)
    if (c.at_prior()) names.push_back(c.name);
  return names;
}

std::string one_mode(const ModeFinding& m) {
  std::string text = m.state.empty() ? "mode " + std::to_string(m.mode)
                                     : "mode " + std::to_string(m.mode_of_state) + " of " + m.state;
  std::vector<std::string> why;
  if (!std::isnan(m.residual) && std::abs(m.residual) > 3.0)
    why.push_back("its frequency is " + fixed(std::abs(m.residual), 1) + " sd " +
                  (m.residual > 0.0 ? "above" : "below") + " the model's");
  if (m.has_shape && m.shape_p < kMisfit)
    why.push_back("its shape does not match the model (MAC " + fixed(m.mac.q50, 3) + ", " +
                  p_value(m.shape_p) + ")");
  return text + " (" + in_words(why) + ")";
}

/// Parameters sorted by the largest distance between solutions, relative to their intervals.
std::vector<std::size_t> by_separation(const std::vector<Solution>& solutions) {
  const std::size_t n = solutions.front().parameters.size();
  std::vector<double> apart(n, 0.0);
  for (std::size_t p = 0; p < n; ++p)
    for (const Solution& a : solutions)
      for (const Solution& b : solutions) {
        const Marginal &x = a.parameters[p], &y = b.parameters[p];
        const double width = std::max(x.width() + y.width(), 1e-12 * std::abs(x.q50));
        if (width > 0.0) apart[p] = std::max(apart[p], std::abs(x.q50 - y.q50) / width);
      }
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::ranges::greater{}, [&](std::size_t p) { return apart[p]; });
  return order;
}

/// Names of the parameters in which the solutions differ most.
std::vector<std::string> separated(const UpdateFindings& findings) {
  std::vector<std::size_t> order = by_separation(findings.solutions);
  if (order.size() > kMostNamed) order.resize(kMostNamed);
  std::ranges::sort(order);
  std::vector<std::string> names;
  for (const std::size_t p : order) names.push_back(findings.models[0].parameters[p].unknown.label);
  return names;
}

/// Numbers as a list: "[1, 3, 4]".
std::string listed_numbers(const std::vector<int>& numbers) {
  std::string text;
  for (const int n : numbers) text += (text.empty() ? "" : ", ") + std::to_string(n);
  return "[" + text + "]";
}

std::string probabilities(const std::vector<Solution>& solutions) {
  std::vector<std::string> out;
  for (const Solution& s : solutions) out.push_back(percent(s.probability));
  return in_words(out);
}

std::string one_solution(const UpdateFindings& findings, std::size_t which) {
  const Solution& solution = findings.solutions[which];
  std::vector<std::size_t> order = by_separation(findings.solutions);
  const std::size_t left = order.size() > kMostNamed ? order.size() - kMostNamed : 0;
  order.resize(order.size() - left);
  std::ranges::sort(order);
  std::vector<std::string> parts;
  for (const std::size_t p : order) {
    const Marginal& e = solution.parameters[p];
    parts.push_back(findings.models[0].parameters[p].unknown.label + " = " +
                    resolved(e.q50, e.width()) + " (" + interval(e) + ")");
  }
  if (left > 0) parts.emplace_back("others, tabulated below");
  return "Solution " + std::to_string(which + 1) + " (" + percent(solution.probability) +
         "): " + in_words(parts) + ".";
}

/// True if some modes may be spurious: the model lacks the shapes of at most a third of the modes,
/// and the case does not allow for spurious modes ("doubt").
bool may_be_spurious(const UpdateFindings& findings) {
  std::size_t strange = 0;
  for (const ModeFinding& m : findings.modes) {
    if (m.spurious > 0.0) return false;
    strange += m.has_shape && m.shape_p < kMisfit;
  }
  return strange > 0 && 3 * strange <= findings.modes.size();
}

}  // namespace

std::string in_words(const UntouchedDirection& direction) {
  std::string text;
  for (const auto& [name, weight] : direction.weights) {
    const std::string size = fixed(std::abs(weight), 2) + " · " + name;
    text += text.empty() ? (weight < 0.0 ? "-" : "") + size : (weight < 0.0 ? " - " : " + ") + size;
  }
  return text;
}

std::string matched_in_words(const ModeFinding& mode) {
  const int number = mode.state.empty() ? mode.mode : mode.mode_of_state;
  if (!mode.is_measured()) return {};
  if ((mode.computed == number && mode.matched > 0.999) || mode.spurious > 0.5) return {};
  return "mode " + std::to_string(number) + (mode.state.empty() ? "" : " of " + mode.state) +
         " is the model's mode " + std::to_string(mode.computed) +
         (mode.matched > 0.999 ? "" : " in " + percent(mode.matched) + " of the draws");
}

std::vector<std::string> misfit_sentences(const UpdateFindings& findings) {
  std::vector<std::string> out;
  const UpdateFit& fit = findings.fit;
  if (fit.p < kMisfit || fit.best_p < kMisfit) {
    std::vector<std::string> modes;
    for (const ModeFinding& m : findings.modes)
      if (m.is_off()) modes.push_back(one_mode(m));
    out.push_back(
        "No values of these parameters explain the measured modes within their stated standard "
        "deviations (" +
        (fit.p < kMisfit ? "predictive " + p_value(fit.p)
                         : "even the best draw has " + p_value(fit.best_p)) +
        ")" + (modes.empty() ? "." : ": " + in_words(modes) + ".") +
        " Check standard deviations, units, sensors and directions, then the model. To infer the "
        "model error, add "
        "\"discrepancy\": {\"cov\": {\"log_uniform\": [1e-3, 0.3]}}" +
        (may_be_spurious(findings) ? "; to allow for spurious modes, add \"doubt\": 0.05." : "."));
  }
  for (const PredictedMode& p : findings.predictions)
    if (p.misses())
      out.push_back("Held-out mode " + std::to_string(p.mode) +
                    (p.state.empty() ? "" : " of " + p.state) + " was measured at " +
                    significant(*p.measured_hz, 5) + " Hz, outside the prediction interval, " +
                    significant(p.low_hz, 4) + " to " + significant(p.high_hz, 4) +
                    " Hz: the model is inaccurate in this range, even if it fits the other modes.");
  return out;
}

std::vector<std::string> cannot_tell(const UpdateFindings& findings) {
  std::vector<std::string> out;
  const auto unmoved = at_prior(findings);
  if (!unmoved.empty())
    out.push_back(
        "The data contain almost no information about " + named(unmoved) + " beyond " +
        (unmoved.size() == 1 ? "its prior: its value is" : "their priors: their values are") +
        " assumed, not measured.");
  for (std::size_t i = 0; i < findings.entangled.size(); ++i) {
    if (i == kMostNamed) {
      out.push_back(std::to_string(findings.entangled.size() - kMostNamed) +
                    " more pairs are not identifiable separately (summary.json lists them).");
      break;
    }
    const Entangled& e = findings.entangled[i];
    out.push_back(e.a + " and " + e.b + " are not identifiable separately (correlation " +
                  fixed(e.correlation, 2) + "): the data determine only a combination of both.");
  }
  // Omit directions along a single parameter that is already named.
  std::vector<std::string> directions;
  for (const UntouchedDirection& d : findings.untouched) {
    const bool single =
        d.weights.size() == 1 && std::ranges::find(unmoved, d.weights[0].first) != unmoved.end();
    if (!single && !d.weights.empty()) directions.push_back(in_words(d));
  }
  if (!findings.untouched.empty()) {
    std::string text = "The data contain almost no information about " +
                       std::to_string(findings.untouched.size()) + " of " +
                       std::to_string(findings.contractions.size()) +
                       " directions in the parameter space (each parameter in units of its "
                       "prior's sd; variance reduced by less than " +
                       percent(kUntouched) + ")";
    if (!directions.empty()) {
      const std::size_t shown = std::min(directions.size(), kMostNamed);
      text += ", among them ";
      for (std::size_t i = 0; i < shown; ++i) text += (i == 0 ? "" : "; ") + directions[i];
    }
    out.push_back(text + ".");
  }
  return out;
}

std::vector<std::string> solution_sentences(const UpdateFindings& findings) {
  if (findings.solutions.empty()) return {};
  return {"The posterior has " + std::to_string(findings.solutions.size()) +
          " separate solutions (" + probabilities(findings.solutions) +
          "): an interval over all solutions contains values that no solution has. To distinguish "
          "the solutions, measure mode shapes at two or more sensors or further modes, or state "
          "narrower "
          "priors of " +
          in_words(separated(findings)) + "."};
}

std::string numbering_sentence(const UpdateFindings& findings) {
  if (!findings.numbering || !findings.numbering->is_doubtful()) return {};
  const NumberingFinding& n = *findings.numbering;
  std::string nulls;
  for (int mode = 1, i = 0; mode <= n.likeliest.modes.back(); ++mode) {
    const bool measured = n.likeliest.modes[static_cast<std::size_t>(i)] == mode;
    nulls += (mode == 1 ? "" : ", ") +
             (measured ? "f" + std::to_string(n.measured[static_cast<std::size_t>(i)])
                       : std::string("null"));
    if (measured) ++i;
  }
  return "The numbering of the modes is doubtful. Without shapes, Wheeltap assigns each measured "
         "mode to the model's mode with the same number (" +
         name_modes(n.measured) + "). This numbering has " + probability_is(n.probability) +
         " under the priors. The model's " + name_modes(n.likeliest.modes) + " have " +
         probability_is(n.likeliest.probability) +
         ". If these numbers are right, state \"model_modes\": " +
         listed_numbers(n.likeliest.modes) + " beside \"from\", or \"frequencies\": [" + nulls +
         "]; or measure mode shapes at two or more sensors.";
}

std::vector<std::string> update_warnings(const UpdateFindings& findings) {
  std::vector<std::string> out = misfit_sentences(findings);
  if (std::string one = numbering_sentence(findings); !one.empty()) out.push_back(std::move(one));
  for (std::string& one : solution_sentences(findings)) out.push_back(std::move(one));
  for (std::string& one : warnings(findings, {})) out.push_back(std::move(one));
  for (std::string& one : cannot_tell(findings)) out.push_back(std::move(one));
  std::vector<std::string> elsewhere;
  for (const ModeFinding& m : findings.modes)
    if (std::string one = matched_in_words(m); !one.empty()) elsewhere.push_back(std::move(one));
  if (!elsewhere.empty())
    out.push_back("Matched by shape and frequency, " + in_words(elsewhere) +
                  ": data and model have their modes in different orders.");
  for (const PredictedMode& p : findings.predictions)
    if (p.useless())
      out.push_back("The prediction interval of mode " + std::to_string(p.mode) + ", " +
                    significant(p.low_hz, 3) + " to " + significant(p.high_hz, 3) +
                    " Hz, is too wide to be useful.");
  return out;
}

Answer answer(const UpdateFindings& findings) {
  Answer out;
  out.caution = caution(findings);
  const std::size_t all = findings.contractions.size(), unmoved = at_prior(findings).size();
  const std::string numbers = std::to_string(findings.numbers) + " measured numbers";
  out.headline = unmoved == 0
                     ? "The " + numbers + " contain information about every parameter."
                     : "The " + numbers + " contain information about " +
                           std::to_string(all - unmoved) + " of the " + std::to_string(all) +
                           " parameters; " +
                           (unmoved == 1 ? "one stays" : std::to_string(unmoved) + " stay") +
                           " at " + (unmoved == 1 ? "its prior." : "their priors.");
  if (!findings.solutions.empty())
    out.headline = "The " + numbers + " allow " + std::to_string(findings.solutions.size()) +
                   " separate solutions, with probabilities of " +
                   probabilities(findings.solutions) + ".";
  if (findings.numbering && findings.numbering->probability < 0.5)
    out.headline = "The mode numbers are probably wrong (" +
                   probability_is(findings.numbering->probability) + " that they are right). " +
                   out.headline;
  if (!findings.fit.ok()) {
    out.misfit = true;
    const bool fits = findings.fit.p >= kMisfit && findings.fit.best_p >= kMisfit;
    std::vector<std::string> off;
    for (const int mode : fits ? findings.fit.missed : findings.fit.off)
      off.push_back(std::to_string(mode));
    out.headline = (fits ? "The updated structure does not predict the held-out modes"
                         : "The structure does not explain the measured modes") +
                   (off.empty() ? std::string()
                                : std::string(" (mode") + (off.size() == 1 ? " " : "s ") +
                                      in_words(off) + ")") +
                   ". " + out.headline;
  }
  if (!findings.solutions.empty()) {
    out.detail = "With 95 % intervals:";
    for (std::size_t s = 0; s < findings.solutions.size(); ++s)
      out.detail += " " + one_solution(findings, s);
    return out;
  }
  // Parameters with the most information first.
  std::vector<std::size_t> order;
  const auto& parameters = findings.models[0].parameters;
  for (std::size_t p = 0; p < parameters.size(); ++p)
    if (!findings.contractions[p].at_prior()) order.push_back(p);
  std::ranges::stable_sort(order, std::ranges::greater{},
                           [&](std::size_t p) { return findings.contractions[p].contraction; });
  std::vector<std::string> parts;
  for (const std::size_t p : order) {
    if (parts.size() == kMostNamed) {
      parts.emplace_back("others, tabulated below");
      break;
    }
    const Marginal& e = parameters[p].estimate;
    parts.push_back(parameters[p].unknown.label + " = " + resolved(e.q50, e.width()) + " (" +
                    interval(e) + ")");
  }
  if (!parts.empty()) out.detail = "With 95 % intervals: " + in_words(parts) + ".";
  return out;
}

}  // namespace wheeltap::apps
