#include "apps/damage_summary.hpp"

#include "apps/emulator_check.hpp"

#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <map>
#include <numeric>

namespace wheeltap::apps {
namespace {

using inference::ChainsOf;
using inference::Posterior;
using Component = DamageProblem::Component;

constexpr double kWorthTelling = 0.05;  // counts with less probability are not described

std::string in_words(const std::vector<std::string>& items) {
  std::string text;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (i > 0) text += i + 1 == items.size() ? " and " : ", ";
    text += items[i];
  }
  return text;
}

// Everything the draws say, unpacked once.
class Draws {
 public:
  Draws(const DamageProblem& problem, const Posterior& posterior)
      : problem_(problem), posterior_(posterior), weights_(model_weights(posterior)) {
    const auto width = static_cast<std::size_t>(posterior.dimension);
    for (const auto& chain : posterior.chains) {
      components_.emplace_back();
      for (std::size_t i = 0; i < chain.model.size(); ++i) {
        components_.back().push_back(
            problem.components(chain.model[i], {chain.theta.data() + i * width, width}));
      }
    }
  }
  [[nodiscard]] const std::vector<Component>& at(std::size_t chain, std::size_t draw) const {
    return components_[chain][draw];
  }
  [[nodiscard]] const Posterior& posterior() const { return posterior_; }
  [[nodiscard]] const DamageProblem& problem() const { return problem_; }
  [[nodiscard]] int model(std::size_t chain, std::size_t draw) const {
    return posterior_.chains[chain].model[draw];
  }
  /// What it counts in averages over models, 1 on average.
  [[nodiscard]] double weight(std::size_t chain, std::size_t draw) const {
    return weights_[static_cast<std::size_t>(model(chain, draw))];
  }
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (std::size_t c = 0; c < components_.size(); ++c) {
      for (std::size_t i = 0; i < components_[c].size(); ++i) visit(c, i);
    }
  }
  [[nodiscard]] const inference::ModelSpace& space() const { return problem_.problem.space; }

 private:
  const DamageProblem& problem_;
  const Posterior& posterior_;
  std::vector<double> weights_;
  std::vector<std::vector<std::vector<Component>>> components_;
};

// ---- where
// ----------------------------------------------------------------------------------------

Report inclusion(const Draws& draws, int kind) {
  const fem::Beam& beam = draws.problem().damage_case.beam;
  const auto elements = static_cast<std::size_t>(beam.elements);
  struct Tally {
    double draws = 0.0;
    std::vector<double> expected;
  };
  std::map<int, Tally> by_count;
  draws.for_each([&](std::size_t c, std::size_t i) {
    const int count = draws.space()[draws.model(c, i)].counts[static_cast<std::size_t>(kind)];
    Tally& tally = by_count[count];
    tally.expected.resize(elements);
    const double weight = draws.weight(c, i);
    tally.draws += weight;
    for (const Component& component : draws.at(c, i)) {
      if (component.kind != kind) continue;
      tally.expected[static_cast<std::size_t>(beam.element_at(component.location))] += weight;
    }
  });
  double all = 0.0;
  for (const auto& [count, tally] : by_count) all += tally.draws;
  std::vector<double> overall(elements);
  Report given = Report::object();
  for (auto& [count, tally] : by_count) {
    for (std::size_t e = 0; e < elements; ++e) {
      overall[e] += tally.expected[e] / all;
      tally.expected[e] /= tally.draws;
    }
    if (count > 0) given[std::to_string(count)] = tally.expected;
  }
  return {{"overall", overall}, {"given_count", given}};
}

// Stretches of beam that hold a tenth of a defect or more, from the expected number per element.
Report places(const Draws& draws, int kind, const std::vector<double>& overall) {
  const DamageProblem& problem = draws.problem();
  const fem::Beam& beam = problem.damage_case.beam;
  constexpr double kTenth = 0.1;
  // What a uniform spread of the expected number would put on an element is background.
  const double total = std::accumulate(overall.begin(), overall.end(), 0.0);
  const double background = 2.0 * total / static_cast<double>(overall.size());
  Report list = Report::array();
  for (std::size_t e = 0; e < overall.size();) {
    if (overall[e] <= background) {
      ++e;
      continue;
    }
    std::size_t end = e;
    double expected = 0.0;
    while (end < overall.size() && overall[end] > background) expected += overall[end++];
    if (expected >= kTenth) {
      std::vector<double> location, severity, weight;
      draws.for_each([&](std::size_t c, std::size_t i) {
        for (const Component& component : draws.at(c, i)) {
          const auto at = static_cast<std::size_t>(beam.element_at(component.location));
          if (component.kind != kind || at < e || at >= end) continue;
          location.push_back(component.location);
          severity.push_back(component.severity);
          weight.push_back(draws.weight(c, i));
        }
      });
      ChainsOf weights;
      if (!draws.posterior().log_weight.empty()) weights.push_back(std::move(weight));
      Report place = {{"from", static_cast<double>(e) * beam.element_length()},
                      {"to", static_cast<double>(end) * beam.element_length()},
                      {"expected", expected},
                      {"location", summarise({location}, weights)}};
      const DefectKind& k = problem.damage_case.kinds[static_cast<std::size_t>(kind)];
      if (k.severity_prior()) place[k.severity_name()] = summarise({severity}, weights);
      list.push_back(std::move(place));
    }
    e = end;
  }
  return list;
}

// Locations counted from the nearer end, and the components ordered by that: for a symmetric beam
// the plain summaries average over mirror images.
Report folded(const Draws& draws) {
  const DamageProblem& problem = draws.problem();
  const double length = problem.damage_case.beam.length;
  Report tables = Report::object();
  for (int m = 0; m < draws.space().size(); ++m) {
    const auto& model = draws.space()[m];
    Report table = Report::object();
    for (std::size_t k = 0; k < model.counts.size(); ++k) {
      const DefectKind& kind = problem.damage_case.kinds[k];
      for (int n = 0; n < model.counts[k]; ++n) {
        const auto nth = [&](std::size_t c, std::size_t i) {
          std::vector<Component> list;
          for (Component component : draws.at(c, i)) {
            if (component.kind != static_cast<int>(k)) continue;
            component.location = std::min(component.location, length - component.location);
            list.push_back(component);
          }
          std::ranges::sort(list, {}, &Component::location);
          return list[static_cast<std::size_t>(n)];
        };
        const ChainsOf location = draws_in_model(
            draws.posterior(), m, [&](auto c, auto i) { return nth(c, i).location; });
        if (std::ranges::all_of(location, [](const auto& chain) { return chain.empty(); }))
          continue;
        const std::string prefix = model.counts.size() > 1 ? kind.name + " " : "";
        const std::string index = "[" + std::to_string(n + 1) + "]";
        table[prefix + "location" + index] = summarise(location);
        if (kind.severity_prior()) {
          table[prefix + kind.severity_name() + index] = summarise(draws_in_model(
              draws.posterior(), m, [&](auto c, auto i) { return nth(c, i).severity; }));
        }
      }
    }
    if (!table.empty()) tables[model.name] = std::move(table);
  }
  return tables;
}

// Expected number left less that right of the middle, a quantity that mirrors must balance.
ChainsOf left_less_right(const Draws& draws) {
  const double middle = 0.5 * draws.problem().damage_case.beam.length;
  return all_draws(draws.posterior(), [&](std::size_t c, std::size_t i) {
    double difference = 0.0;
    for (const Component& component : draws.at(c, i)) {
      difference += component.location < middle ? 1.0 : -1.0;
    }
    return difference;
  });
}

Report symmetry(const Draws& draws, const ChainsOf& difference,
                std::vector<std::string>& warnings) {
  const DamageProblem& problem = draws.problem();
  const double middle = 0.5 * problem.damage_case.beam.length;
  Report chains = Report::array();
  double expected = 0.0;
  for (std::size_t c = 0; c < difference.size(); ++c) {
    double left = 0.0, right = 0.0, all = 0.0;
    for (std::size_t i = 0; i < difference[c].size(); ++i) all += draws.weight(c, i);
    for (std::size_t i = 0; i < difference[c].size(); ++i) {
      for (const Component& component : draws.at(c, i)) {
        (component.location < middle ? left : right) += draws.weight(c, i) / all;
      }
    }
    const double mcse = inference::mcse_mean({difference[c]});
    chains.push_back({{"left", left}, {"right", right}, {"mcse_of_difference", mcse}});
    expected += (left + right) / static_cast<double>(difference.size());
  }
  std::string statement =
      "The intact beam is symmetric, so its frequencies cannot tell a place x from its mirror "
      "image "
      "L - x: each location named here stands for both.";
  if (problem.emulator && !problem.exact()) {
    statement =
        "The intact beam is symmetric, so its frequencies cannot tell a place x from its mirror "
        "image "
        "L - x. Where the posterior prefers a side all the same, that comes from the emulator, "
        "not from the data.";
  }
  if (expected > kWorthTelling) {
    warnings.push_back(
        statement + " To tell them apart, measure mode shapes or add a small mass off the middle.");
  }
  return {{"mirror_symmetric", true},
          {"center", middle},
          {"statement", statement},
          {"per_chain", chains}};
}

// ---- what the data cannot say
// -----------------------------------------------------------------------

// "between the support at 0 m and location[2]": what stands on both sides of a slot.
std::string neighbours(const Draws& draws, const std::vector<double>& means, std::size_t slot,
                       const std::string& name) {
  const fem::Beam& beam = draws.problem().damage_case.beam;
  struct Landmark {
    double at;
    std::string name;
  };
  std::vector<Landmark> landmarks = {{0.0, "the left end"}, {beam.length, "the right end"}};
  for (const fem::Support& s : beam.supports) {
    const std::string what = s.deflection && s.rotation ? "clamp" : "support";
    landmarks.push_back({s.at, "the " + what + " at " + significant(s.at, 3) + " m"});
  }
  for (std::size_t i = 0; i < means.size(); ++i) {
    if (i == slot) continue;
    landmarks.push_back({means[i], "the " + name + " near " + significant(means[i], 3) + " m"});
  }
  Landmark below = landmarks[0], above = landmarks[1];
  for (const Landmark& l : landmarks) {
    if (l.at <= means[slot] && l.at >= below.at) below = l;
    if (l.at > means[slot] && l.at <= above.at) above = l;
  }
  return "between " + below.name + " and " + above.name;
}

// Models with at least as many unknowns as data, and what they hide.
void unidentified(const Draws& draws, const Report& models, const Report& parameters,
                  std::vector<std::string>& warnings) {
  const DamageProblem& problem = draws.problem();
  const int data = problem.damage_case.data.measured();
  for (int m = 0; m < draws.space().size(); ++m) {
    const auto& model = draws.space()[m];
    const double p = models[static_cast<std::size_t>(m)]["probability"];
    if (p < kWorthTelling || model.dimension < data || data == 0) continue;
    if (!parameters.contains(model.name)) continue;  // known by its evidence alone
    bool simpler = false;
    for (int o = 0; o < draws.space().size(); ++o) {
      simpler = simpler || (draws.space()[o].dimension < model.dimension &&
                            models[static_cast<std::size_t>(o)]["probability"] >= kWorthTelling);
    }
    const std::string measured = std::to_string(data) + (data == 1 ? " frequency" : " frequencies");
    const std::string unknowns =
        std::to_string(model.dimension) + (model.dimension == 1 ? " unknown" : " unknowns");
    if (!simpler) {
      warnings.push_back(
          "The " + unknowns + " of " + model.name + " are fitted to " + measured +
          ", not tested by them: how bad the fit of a wrong model would be cannot "
          "be seen, and the intervals lean on the priors. Measure more frequencies.");
      continue;
    }
    std::string text =
        measured + " cannot exclude " + model.name + " (" + probability_is(p) + "): with " +
        unknowns + " it has as many as there are data, or more, and fits them however they fall";
    for (std::size_t k = 0; k < model.counts.size(); ++k) {
      const DefectKind& kind = problem.damage_case.kinds[k];
      const int smaller = draws.space().neighbour(m, static_cast<int>(k), -1);
      if (smaller < 0 || model.counts[k] < 2) continue;
      const std::string& smaller_name = draws.space()[smaller].name;
      if (!parameters.contains(smaller_name)) continue;
      // The slot that the smaller model explains least is the hidden one.
      const auto label = [&](int of_model, int n) {
        return parameter_label(
            draws.space(), of_model,
            draws.space()[of_model].offsets[k] + n * (kind.severity_prior() ? 2 : 1));
      };
      std::vector<double> means;
      std::size_t hidden = 0;
      double farthest = -1.0;
      for (int n = 0; n < model.counts[k]; ++n) {
        const double mean = parameters[model.name][label(m, n)]["mean"];
        double nearest = std::numeric_limits<double>::infinity();
        for (int o = 0; o < draws.space()[smaller].counts[k]; ++o) {
          const double other = parameters[smaller_name][label(smaller, o)]["mean"];
          nearest = std::min(nearest, std::abs(mean - other));
        }
        means.push_back(mean);
        if (nearest > farthest) farthest = nearest, hidden = static_cast<std::size_t>(n);
      }
      const Report& slot = parameters[model.name][label(m, static_cast<int>(hidden))];
      text += ". Under it, a further " + kind.name + " would hide " +
              neighbours(draws, means, hidden, kind.name) + ", at " +
              significant(slot["q2.5"].get<double>(), 2) + " to " +
              significant(slot["q97.5"].get<double>(), 2) + " m (95 %)";
    }
    warnings.push_back(text +
                       ". Measure more frequencies, or rule it out by inspection and lower "
                       "damage.count.max.");
  }
}

// How well the best models reproduce the data, and whether they do at all.
Report fit(const Draws& draws, std::vector<std::string>& warnings) {
  const DamageProblem& problem = draws.problem();
  const FrequencyData& data = problem.damage_case.data;
  const Posterior& posterior = draws.posterior();
  const auto modes = static_cast<std::size_t>(data.modes());
  Report rows = Report::array();
  if (posterior.predictions != data.modes()) return rows;
  const auto width = static_cast<std::size_t>(posterior.dimension);
  std::vector<int> off;
  const auto prediction = [&](std::size_t c, std::size_t i, std::size_t mode) {
    return static_cast<double>(posterior.chains[c].prediction[i * modes + mode]);
  };
  FrequencyPredictor predictor(problem);
  const bool emulated = problem.emulator && !problem.exact();
  std::vector<double> emulator_variance(modes, 0.0), ignored(modes);
  const long stride = emulated && problem.emulator->is_slow() ? 50 : 1;
  long visited = 0;
  double mean_p = 0.0, weight_seen = 0.0;
  std::vector<double> mean_residual(modes);
  draws.for_each([&](std::size_t c, std::size_t i) {
    if (visited++ % stride != 0) return;
    const auto& chain = posterior.chains[c];
    const std::span<const double> x(chain.theta.data() + i * width, width);
    if (emulated) predictor.emulate(chain.model[i], x, ignored, emulator_variance);
    const double weight = draws.weight(c, i);
    double squares = 0.0;
    for (std::size_t mode = 0; mode < modes; ++mode) {
      if (std::isnan(data.frequencies_hz[mode])) continue;
      const double sd =
          problem.total_sd(mode, data.cov_prior ? x[0] : 0.0, emulator_variance[mode]);
      const double r = (data.frequencies_hz[mode] - prediction(c, i, mode)) / sd;
      squares += r * r;
      mean_residual[mode] += weight * r;
    }
    mean_p += weight * boost::math::gamma_q(0.5 * data.measured(), 0.5 * squares);
    weight_seen += weight;
  });
  mean_p /= weight_seen;
  const ChainsOf weights = draw_weights(posterior);
  for (std::size_t mode = 0; mode < modes; ++mode) {
    const Report predicted = summarise(
        all_draws(posterior, [&](auto c, auto i) { return prediction(c, i, mode); }), weights);
    const bool measured = !std::isnan(data.frequencies_hz[mode]);
    const double residual = mean_residual[mode] / weight_seen;
    rows.push_back({{"mode", mode + 1},
                    {"observed", measured ? Report(data.frequencies_hz[mode]) : Report()},
                    {"sd", measured && !data.sd_hz.empty() ? Report(data.sd_hz[mode]) : Report()},
                    {"mean", predicted["mean"]},
                    {"q2.5", predicted["q2.5"]},
                    {"q97.5", predicted["q97.5"]},
                    {"standardised_residual", measured ? Report(residual) : Report()}});
    if (measured && std::abs(residual) > 3.0) off.push_back(static_cast<int>(mode) + 1);
  }
  if (mean_p < 0.005) {
    warnings.push_back(
        "No model here fits the data within the stated noise" +
        (off.empty() ? std::string() : " (off by more than 3 sd: " + name_modes(off) + ")") +
        (problem.emulator
             ? ". The emulator's error may be larger here than on average over its box: try "
               "\"predictor\": \"fe\". Otherwise check"
             : ". Check") +
        " the beam's properties, the mode numbering and data.cov before believing the locations; "
        "or "
        "infer the noise: \"cov\": {\"log_uniform\": [1e-4, 1e-1]}.");
  }
  return {{"modes", rows}, {"posterior_predictive_p", mean_p}};
}

// Posteriors that lean on the end of a prior, or counts on the largest allowed.
void bounds(const Draws& draws, const Report& models, std::vector<std::string>& warnings) {
  const DamageProblem& problem = draws.problem();
  const auto& kinds = problem.damage_case.kinds;
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    double at_most = 0.0;
    for (int m = 0; m < draws.space().size(); ++m) {
      if (draws.space()[m].counts[k] == kinds[k].max_count) {
        at_most += models[static_cast<std::size_t>(m)]["probability"].get<double>();
      }
    }
    if (at_most > 0.5 && kinds[k].max_count > kinds[k].min_count) {
      std::string key = kinds[k].where.to_string().substr(1) + ".count.max";
      std::ranges::replace(key, '/', '.');
      warnings.push_back("The largest number of " + kinds[k].plural + " that the case allows, " +
                         std::to_string(kinds[k].max_count) + ", has " + probability_is(at_most) +
                         ". More were never asked about: raise " + key + " to ask.");
    }
    const inference::Prior* severity = kinds[k].severity_prior();
    if (severity == nullptr || !std::isfinite(severity->upper())) continue;
    double near = 0.0, all = 0.0;
    const double edge = severity->from_standard_normal(2.0);  // the prior's upper 2.3 %
    draws.for_each([&](std::size_t c, std::size_t i) {
      for (const Component& component : draws.at(c, i)) {
        if (component.kind != static_cast<int>(k)) continue;
        all += draws.weight(c, i);
        near += component.severity > edge ? draws.weight(c, i) : 0.0;
      }
    });
    if (near > 0.25 * all) {
      warnings.push_back("The " + kinds[k].severity_name() + " leans on the end of its prior, " +
                         severity->describe() +
                         ": the data would go beyond it. Widen the prior if that is possible.");
    }
  }
}

Report supports_of(const fem::Beam& beam) {
  Report list = Report::array();
  for (const fem::Support& s : beam.supports) {
    list.push_back({{"at", s.at},
                    {"deflection", s.deflection},
                    {"rotation", s.rotation},
                    {"stiffness", s.stiffness ? Report(*s.stiffness) : Report("rigid")}});
  }
  return list;
}

}  // namespace

std::string name_modes(const std::vector<int>& modes) {
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < modes.size();) {
    std::size_t j = i;
    while (j + 1 < modes.size() && modes[j + 1] == modes[j] + 1) ++j;
    if (j > i + 1) {
      parts.push_back(std::to_string(modes[i]) + " to " + std::to_string(modes[j]));
    } else {
      for (std::size_t n = i; n <= j; ++n) parts.push_back(std::to_string(modes[n]));
    }
    i = j + 1;
  }
  return (modes.size() == 1 ? "mode " : "modes ") + in_words(parts);
}

std::vector<double> measurement_noise(const DamageCase& damage_case,
                                      std::span<const double> intact) {
  if (!damage_case.data.sd_hz.empty()) return damage_case.data.sd_hz;
  std::optional<double> cov = damage_case.data.cov;
  if (!cov && damage_case.simulation && damage_case.simulation->cov > 0.0) {
    cov = damage_case.simulation->cov;
  }
  std::vector<double> noise;
  if (cov && !damage_case.data.cov_prior) {
    for (const double f : intact) noise.push_back(*cov * f);
  }
  return noise;
}

Report emulator_report(const FrequencyEmulator& emulator, const std::vector<double>& noise) {
  Report counts = Report::object();
  for (int count = 1; count <= emulator.max_count(); ++count) {
    const EmulatorError& of = emulator.error(count);
    Report rows = Report::array();
    std::vector<int> blind;
    double worst = 0.0, worst_single = 0.0;
    int worst_mode = 0;
    for (int mode = 0; mode < emulator.modes(); ++mode) {
      const auto at = static_cast<std::size_t>(mode);
      const auto& error = of.holdout[at];
      const double sd = at < noise.size() ? noise[at] : std::nan("");
      Report row = {{"mode", mode + 1},
                    {"rmse", error.rmse},
                    {"max_error", error.max_error},
                    {"q2", std::isfinite(error.q2) ? Report(error.q2) : Report()},
                    {"relative_rmse", error.relative_rmse()},
                    {"noise", std::isnan(sd) ? Report() : Report(sd)}};
      if (!of.leave_one_out.empty()) row["leave_one_out"] = of.leave_one_out[at];
      if (!of.standardised.empty()) {
        const auto& s = of.standardised[at];
        row["standardised"] = {{"mean", s.mean},
                               {"rms", std::isfinite(s.rms) ? Report(s.rms) : Report()},
                               {"beyond_two", s.beyond_two}};
      }
      rows.push_back(std::move(row));
      if (error.rmse / sd > worst) worst = error.rmse / sd, worst_mode = mode + 1;
      worst_single = std::max(worst_single, error.max_error / sd);
      if (error.cannot_be_predicted()) blind.push_back(mode + 1);
    }
    Report warning;
    if (!blind.empty()) {
      warning = "With " + std::to_string(count) + (count == 1 ? " damage" : " damages") +
                " the emulator cannot predict " + name_modes(blind) +
                ": its error there is of the size of the damage effect itself (Q2 < 0.9). Use more "
                "sites (\"sites\": \"every-element\"), \"coordinate\": \"compliance\", or "
                "\"predictor\": \"fe\".";
    }
    Report& entry = counts[std::to_string(count)] = {{"kind", emulator.describe(count)},
                                                     {"runs", emulator.runs(count)},
                                                     {"modes", rows},
                                                     {"warning", warning}};
    if (worst_mode > 0) {
      entry["worst"] = {
          {"mode", worst_mode}, {"rmse_to_noise", worst}, {"largest_to_noise", worst_single}};
    }
  }
  return {{"counts", counts}};
}

Report summarise_damage(const DamageProblem& problem, const Posterior& posterior,
                        const std::vector<MethodEvidence>& evidence, const RunInfo& info) {
  const DamageCase& damage_case = problem.damage_case;
  const Draws draws(problem, posterior);

  std::vector<std::string> warnings;
  std::vector<inference::Watched> watched;
  const auto modes = static_cast<std::size_t>(posterior.predictions);
  for (std::size_t mode = 0; mode < modes; ++mode) {
    watched.push_back(
        {"frequency " + std::to_string(mode + 1), all_draws(posterior, [&](auto c, auto i) {
           return static_cast<double>(posterior.chains[c].prediction[i * modes + mode]);
         })});
  }
  Report symmetric;
  if (problem.symmetric) {
    const ChainsOf difference = left_less_right(draws);
    symmetric = symmetry(draws, difference, warnings);
    watched.push_back({"left less right", difference});
  }
  const inference::Verdict verdict = inference::judge(posterior, watched);
  const Report models = model_table(posterior, verdict);
  const Report parameters = parameter_tables(posterior);

  Report where = {{"inclusion_by_element", Report::object()}, {"places", Report::object()}};
  const bool several = damage_case.kinds.size() > 1;
  for (std::size_t k = 0; k < damage_case.kinds.size(); ++k) {
    const Report by_element = inclusion(draws, static_cast<int>(k));
    const Report spots = places(draws, static_cast<int>(k), by_element["overall"]);
    const std::string& name = damage_case.kinds[k].name;
    (several ? where["inclusion_by_element"][name] : where["inclusion_by_element"]) = by_element;
    where["places"][name] = spots;
  }
  if (problem.symmetric) where["folded"] = folded(draws);

  unidentified(draws, models, parameters, warnings);
  const Report fitted = fit(draws, warnings);
  bounds(draws, models, warnings);
  Report emulator;
  if (problem.emulator) {
    emulator = emulator_report(*problem.emulator, damage_case.data.sd_hz);
    emulator["exact"] = problem.exact();
    emulator["error_in_likelihood"] = damage_case.emulator->emulator_error;
    const Report check = check_emulator(problem, posterior, warnings);
    emulator["full_model_calls"] = {{"training", problem.emulator->trained_runs()},
                                    {"validation", problem.emulator->fresh_runs()},
                                    {"likelihood", posterior.full_evaluations},
                                    {"check", check.is_null() ? 0 : check["draws"].get<long>()}};
    if (!check.is_null()) emulator["check"] = check;
    for (int m = 0; m < draws.space().size() && !problem.exact(); ++m) {
      const std::string count = std::to_string(draws.space()[m].counts[0]);
      const double p = models[static_cast<std::size_t>(m)]["probability"];
      if (p < kWorthTelling || !emulator["counts"].contains(count)) continue;
      const auto& warning = emulator["counts"][count]["warning"];
      if (warning.is_string()) warnings.push_back(warning);
    }
  }

  const Report compared = evidence_report(draws.space(), models, evidence, warnings);
  Report diagnosed = diagnostics(posterior, verdict, info.seed, warnings);
  if (problem.symmetric) diagnosed["symmetry"] = symmetric;
  Report kinds = Report::array();
  for (const DefectKind& kind : damage_case.kinds) {
    Report truth = Report::array();
    for (const auto& t : kind.truth) {
      truth.push_back({{"location", t.location},
                       {kind.severity_name(),
                        std::isfinite(t.severity) ? Report(t.severity) : Report("rigid")}});
    }
    kinds.push_back({{"name", kind.name},
                     {"plural", kind.plural},
                     {"severity", kind.severity_prior() ? Report(kind.severity_name()) : Report()},
                     {"unit", kind.severity_unit()},
                     {"truth", truth}});
  }
  Report summary = {
      {"wheeltap", about("damage", info, damage_case.file)},
      {"title", damage_case.title},
      {"notes", damage_case.notes},
      {"models", models},
      {"parameters", parameters},
      {"damage", where},
      {"data", {{"origin", damage_case.data.origin}, {"simulated", damage_case.data.simulated}}},
      {"beam",
       {{"length", damage_case.beam.length},
        {"elements", damage_case.beam.elements},
        {"supports", supports_of(damage_case.beam)},
        {"shear_coefficient", damage_case.beam.section.shear_coefficient}}},
      {"kinds", kinds},
      {"diagnostics", diagnosed},
      {"cost", cost(posterior)}};
  if (problem.emulator) {
    long calls = 0;
    for (const auto& [what, n] : emulator["full_model_calls"].items()) calls += n.get<long>();
    summary["cost"]["full_model_calls"] = calls;
  }
  if (damage_case.data.discrepancy_cov > 0.0) {
    summary["data"]["discrepancy_cov"] = damage_case.data.discrepancy_cov;
  }
  if (!fitted.empty()) summary["data"].update(fitted);
  if (!emulator.is_null()) summary["emulator"] = emulator;
  if (!evidence.empty()) summary["evidence"] = compared;
  return summary;
}

}  // namespace wheeltap::apps
