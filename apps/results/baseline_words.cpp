#include "apps/results/baseline_words.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "apps/results/summary.hpp"
#include "apps/words.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

/// Relative error of frequencies below which modes count as exact.
constexpr double kExact = 1e-5;

std::string baseline_interval(const Marginal& e) {
  return resolved(e.q2_5, e.width()) + " to " + resolved(e.q97_5, e.width());
}

std::string check_in_words(const StatesLikelihood::Check& check) {
  return "Wheeltap compared computed modes with full solutions at " + std::to_string(check.points) +
         " draws of the priors: the largest relative error of a frequency is " +
         significant(check.largest_error, 2) +
         (check.missed > 0 ? ", and " + std::to_string(check.missed) + " modes were missed" : "") +
         ".";
}

/// The inferred discrepancies under the most probable model; empty if none is inferred.
std::string model_error_in_words(const DamageFindings& findings) {
  const auto model = std::ranges::max_element(
      findings.models, {}, [](const ModelFinding& m) { return m.probability(); });
  if (model == findings.models.end()) return {};
  std::vector<std::string> list;
  const auto share = [](double x) { return significant(100.0 * x, 2); };
  for (const auto& [name, words] :
       {std::pair{"discrepancy", "frequencies "},
        {"shape_discrepancy", "components of mode shapes "},
        {"stiffness_discrepancy", "stiffnesses of members or links "}}) {
    const auto p = std::ranges::find(model->parameters, name,
                                     [](const ParameterFinding& f) { return f.unknown.name; });
    if (p == model->parameters.end()) continue;
    const Marginal& e = p->estimate;
    list.push_back(words + share(e.q50) + " % (" + share(e.q2_5) + " to " + share(e.q97_5) + ")");
  }
  if (list.empty()) return {};
  return "Inferred standard deviation of the model error: " + in_words(list) + ".";
}

}  // namespace

std::vector<std::string> baseline_sentences(const DamageFindings& findings) {
  std::vector<std::string> out;
  if (!findings.baseline) return out;
  const BaselineFindings& b = *findings.baseline;
  std::vector<std::string> unmoved;
  for (const Contraction& c : b.contractions)
    if (c.at_prior()) unmoved.push_back(c.name);
  if (!unmoved.empty())
    out.push_back(
        "The data contain almost no information about " + in_words(unmoved) +
        " of the intact structure beyond " +
        (unmoved.size() == 1 ? "its prior: its value is" : "their priors: their values are") +
        " assumed, not measured.");
  for (const Contraction& c : b.contractions)
    if (c.bound != Contraction::Bound::none)
      out.push_back("The posterior of " + c.name + " of the intact structure piles up at the " +
                    (c.bound == Contraction::Bound::upper ? "upper" : "lower") +
                    " bound of its prior: widen the prior unless this bound is certain.");
  for (const Entangled& e : b.entangled)
    out.push_back(e.a + " and " + e.b +
                  " of the intact structure are not identifiable separately (correlation " +
                  fixed(e.correlation, 2) + "): the data determine only a combination of both.");
  for (const HiddenDamage& h : b.hidden)
    out.push_back("With " + h.model + ", " + h.severity + " and " + h.parameter +
                  " of the intact structure are not identifiable separately (correlation " +
                  fixed(h.correlation, 2) +
                  "): measure the healthy structure better, or narrow the prior.");
  if (findings.fit) {
    std::vector<std::string> off;
    for (const FitFinding::Mode& m : findings.fit->modes)
      if (std::abs(m.standardised_residual) > 3.0)
        off.push_back("mode " + std::to_string(m.mode) + " of " + m.state + " (" +
                      fixed(m.standardised_residual, 1) + " sd)");
    if (!off.empty()) out.push_back("Frequencies with errors above 3 sd: " + in_words(off) + ".");
  }
  if (b.check.missed > 0 || b.check.largest_error > kExact) out.push_back(check_in_words(b.check));
  return out;
}

Report baseline_report(const DamageCase& damage_case, const DamageFindings& findings) {
  const BaselineFindings& b = *findings.baseline;
  Report parameters = Report::object(), states = Report::array(), entangled = Report::array(),
         hidden = Report::array();
  for (std::size_t p = 0; p < b.contractions.size(); ++p) {
    const Contraction& c = b.contractions[p];
    using Bound = Contraction::Bound;
    parameters[c.name] = {{"prior", b.priors[p]},
                          {"posterior", json(b.marginals[p])},
                          {"contraction", c.contraction},
                          {"shift", c.shift},
                          {"at_prior", c.at_prior()},
                          {"bound", c.bound == Bound::none    ? Report()
                                    : c.bound == Bound::upper ? Report("upper")
                                                              : Report("lower")}};
  }
  for (const ObservedState& s : damage_case.states()->list) {
    Report masses = Report::array();
    for (const auto& m : s.masses) masses.push_back(m.mass);
    states.push_back({{"name", s.name},
                      {"damaged", s.damaged},
                      {"modes", s.data.modes()},
                      {"origin", s.data.origin},
                      {"added_masses", masses},
                      {"above_reference_kelvin", s.temperature}});
  }
  for (const Entangled& e : b.entangled)
    entangled.push_back({{"parameters", {e.a, e.b}}, {"correlation", e.correlation}});
  for (const HiddenDamage& h : b.hidden)
    hidden.push_back({{"model", h.model},
                      {"parameter", h.parameter},
                      {"severity", h.severity},
                      {"correlation", h.correlation}});
  Report out = {{"parameters", parameters},
                {"states", states},
                {"entangled", entangled},
                {"hides_damage", hidden},
                {"sentences", baseline_sentences(findings)},
                {"check",
                 {{"statement", check_in_words(b.check)},
                  {"points", b.check.points},
                  {"largest_error", b.check.largest_error},
                  {"missed", b.check.missed},
                  {"seconds_a_solution", b.check.seconds_a_solution}}}};
  if (const std::string error = model_error_in_words(findings); !error.empty())
    out["model_error"] = error;
  return out;
}

void print_baseline(const Page& page, const DamageFindings& findings) {
  if (!findings.baseline) return;
  const BaselineFindings& b = *findings.baseline;
  if (!b.contractions.empty()) {
    page.heading("The intact structure");
    std::vector<std::vector<std::string>> rows = {
        {"parameter", "prior", "median", "95 %", "contracted"}};
    for (std::size_t p = 0; p < b.contractions.size(); ++p)
      rows.push_back({b.contractions[p].name, b.priors[p],
                      resolved(b.marginals[p].q50, b.marginals[p].width()),
                      baseline_interval(b.marginals[p]),
                      percent(std::max(0.0, b.contractions[p].contraction))});
    page.table(rows);
  }
  page.wrapped(check_in_words(b.check), "", "  ");
  if (const std::string error = model_error_in_words(findings); !error.empty())
    page.wrapped(error, "", "  ");
}

}  // namespace wheeltap::apps
