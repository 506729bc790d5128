#include "identification/structural/damage/findings/damage_findings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/constants.hpp"
#include "identification/findings/prior_bound.hpp"
#include "identification/structural/damage/damage_plausibility.hpp"
#include "identification/structural/damage/findings/common_factor.hpp"
#include "identification/structural/damage/findings/damage_modes.hpp"
#include "identification/structural/damage/findings/rival_places.hpp"
#include "identification/structural/damage/findings/symmetry_finding.hpp"
#include "inference/diagnosis/convergence.hpp"

namespace wheeltap::identification {
namespace {

using inference::ChainsOf;
using inference::Posterior;
using Component = DamageProblem::Component;

// ---- places --------------------------------------------------------------------------------

KindFinding where(const UnpackedDraws& draws, int kind) {
  const SiteLine& line = draws.problem().damage_case.kinds[static_cast<std::size_t>(kind)].line;
  const auto elements = static_cast<std::size_t>(line.cells());
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
      tally.expected[static_cast<std::size_t>(line.cell_at(component.location))] += weight;
    }
  });
  double all = 0.0;
  for (const auto& [count, tally] : by_count) all += tally.draws;
  KindFinding out{.expected = std::vector<double>(elements), .given_count = {}, .places = {}};
  for (auto& [count, tally] : by_count) {
    for (std::size_t e = 0; e < elements; ++e) {
      out.expected[e] += tally.expected[e] / all;
      tally.expected[e] /= tally.draws;
    }
    if (count > 0) out.given_count[count] = tally.expected;
  }
  return out;
}

// Parts of a beam with an expected number of defects of at least 0.1, from the numbers per element.
std::vector<Place> places(const UnpackedDraws& draws, int kind,
                          const std::vector<double>& overall) {
  const DamageProblem& problem = draws.problem();
  const SiteLine& line = problem.damage_case.kinds[static_cast<std::size_t>(kind)].line;
  constexpr double kTenth = 0.1;
  // A uniform part of the expected number counts as background. Joints and storeys have no
  // background, because they are few.
  const bool points = !line.is_beam() && line.stretches().front().size == 0.0;
  const double total = std::accumulate(overall.begin(), overall.end(), 0.0);
  const double background =
      points ? 0.0 : std::min(2.0 * total / static_cast<double>(overall.size()), kTenth);
  std::vector<Place> list;
  for (std::size_t e = 0; e < overall.size();) {
    if (overall[e] <= background) {
      ++e;
      continue;
    }
    std::size_t end = e;
    double expected = 0.0;
    const int stretch = line.stretch_of_cell(static_cast<int>(e));
    while (end < overall.size() && overall[end] > background &&
           line.stretch_of_cell(static_cast<int>(end)) == stretch)
      expected += overall[end++];
    if (expected >= kTenth) {
      std::vector<double> location, severity, extent, weight;
      draws.for_each([&](std::size_t c, std::size_t i) {
        for (const Component& component : draws.at(c, i)) {
          if (component.kind != kind) continue;
          const auto at = static_cast<std::size_t>(line.cell_at(component.location));
          if (at < e || at >= end) continue;
          location.push_back(line.is_beam() ? component.location : line.spot(component.location).s);
          severity.push_back(component.severity);
          extent.push_back(component.extent);
          weight.push_back(draws.weight(c, i));
        }
      });
      ChainsOf weights;
      if (!draws.posterior().log_weight.empty()) weights.push_back(std::move(weight));
      const SiteLine::Stretch& on = line.stretches()[static_cast<std::size_t>(stretch)];
      const double scale = line.is_beam() ? 1.0 : on.size / (on.end - on.start);
      Place place{.stretch = stretch,
                  .from = scale * (line.cell_start(static_cast<int>(e)) - on.start),
                  .to = scale * (line.cell_start(static_cast<int>(end)) - on.start),
                  .expected = expected,
                  .location = marginal({location}, weights),
                  .severity = {}};
      const DefectKind& k = problem.damage_case.kinds[static_cast<std::size_t>(kind)];
      if (k.severity_prior()) place.severity = marginal({severity}, weights);
      if (k.extent_prior) place.extent = marginal({extent}, weights);
      list.push_back(std::move(place));
    }
    e = end;
  }
  return list;
}

// ---- limits of the data --------------------------------------------------------------------

// Neighbours of a component on both sides, at these median locations.
std::pair<remark::Landmark, remark::Landmark> neighbours(const UnpackedDraws& draws,
                                                         const std::vector<double>& medians,
                                                         std::size_t component,
                                                         const std::string& name) {
  using remark::Landmark;
  using Kind = Landmark::Kind;
  const fem::Beam& beam = draws.problem().damage_case.beam;
  std::vector<Landmark> landmarks = {{Kind::left_end, 0.0, {}}, {Kind::right_end, beam.length, {}}};
  for (const fem::Support& s : beam.supports) {
    landmarks.push_back({s.deflection && s.rotation ? Kind::clamp : Kind::support, s.at, {}});
  }
  for (std::size_t i = 0; i < medians.size(); ++i) {
    if (i != component) landmarks.push_back({Kind::defect, medians[i], name});
  }
  Landmark below = landmarks[0], above = landmarks[1];
  for (const Landmark& l : landmarks) {
    if (l.at <= medians[component] && l.at >= below.at) below = l;
    if (l.at > medians[component] && l.at <= above.at) above = l;
  }
  return {below, above};
}

// Reports models with at least as many unknowns as data, and the defects that they could hide. Does
// not apply if shapes were measured, because frequencies are then not all the data.
void unidentified(const UnpackedDraws& draws, const std::vector<ModelFinding>& models,
                  std::vector<Remark>& remarks) {
  const DamageProblem& problem = draws.problem();
  const DamageCase& damage_case = problem.damage_case;
  if ((damage_case.modal() && damage_case.modal()->has_shapes()) ||
      (damage_case.states() && damage_case.states()->has_shapes()))
    return;
  const int data = damage_case.data.measured();
  for (std::size_t m = 0; m < models.size(); ++m) {
    const ModelFinding& model = models[m];
    if (model.probability() < kWorthReporting || model.dimension < data || data == 0) continue;
    if (model.parameters.empty()) continue;  // model without draws: only its evidence is known
    const bool simpler = std::ranges::any_of(models, [&](const ModelFinding& other) {
      return other.dimension < model.dimension && other.probability() >= kWorthReporting;
    });
    if (!simpler) {
      remarks.push_back(remark::FittedNotTested{model.name, model.dimension, data});
      continue;
    }
    remark::CannotExclude cannot{.model = model.name,
                                 .probability = model.probability(),
                                 .unknowns = model.dimension,
                                 .frequencies = data,
                                 .hidden = {}};
    for (std::size_t k = 0; k < model.counts.size(); ++k) {
      const DefectKind& kind = problem.damage_case.kinds[k];
      const int smaller = draws.space().neighbour(static_cast<int>(m), static_cast<int>(k), -1);
      if (smaller < 0 || model.counts[k] < 2 || !kind.line.is_beam()) continue;
      const ModelFinding& other = models[static_cast<std::size_t>(smaller)];
      if (other.parameters.empty()) continue;
      // The hidden component is the one farthest from all components of the smaller model.
      const auto location = [&](const ModelFinding& of, int n) -> const Marginal& {
        return *of.find(static_cast<int>(k), n, 0);
      };
      std::vector<double> medians;
      int hidden = 0;
      double farthest = -1.0;
      for (int n = 0; n < model.counts[k]; ++n) {
        const double median = location(model, n).q50;
        double nearest = std::numeric_limits<double>::infinity();
        for (int o = 0; o < other.counts[k]; ++o) {
          nearest = std::min(nearest, std::abs(median - location(other, o).q50));
        }
        medians.push_back(median);
        if (nearest > farthest) farthest = nearest, hidden = n;
      }
      const auto [below, above] =
          neighbours(draws, medians, static_cast<std::size_t>(hidden), kind.name);
      cannot.hidden.push_back({.kind = kind.name,
                               .below = below,
                               .above = above,
                               .from = location(model, hidden).q2_5,
                               .to = location(model, hidden).q97_5});
    }
    remarks.push_back(std::move(cannot));
  }
}

// Number of draws per evaluation of a slow emulator; evaluating all draws would take minutes.
long emulator_stride(const DamageProblem& problem) {
  return problem.emulator && !problem.exact() && problem.emulator->is_slow() ? 50 : 1;
}

// False if the chains disagree by more than the misfit. A chain that improved as much as the chains
// differ would then explain the data. `best` is the smallest χ² of the draws.
bool excludes_fit(const Posterior& posterior, int measured, double best) {
  if (inference::chains_agree(posterior)) return true;
  double low = kInfinity, high = -kInfinity;  // mean log likelihoods of the chains
  for (const inference::Chain& chain : posterior.chains) {
    const double sum =
        std::accumulate(chain.log_likelihood.begin(), chain.log_likelihood.end(), 0.0);
    const double mean = sum / static_cast<double>(std::max<std::size_t>(1, chain.size()));
    low = std::min(low, mean);
    high = std::max(high, mean);
  }
  return !(chi_square_tail(measured, std::max(0.0, best - 2.0 * (high - low))) >= kMisfit);
}

// Fit of the models to the data, and the diagnosis of the fit.
std::optional<FitFinding> fit(const UnpackedDraws& draws, FitVerdict& verdict,
                              std::vector<Remark>& remarks) {
  const DamageProblem& problem = draws.problem();
  const FrequencyData& data = problem.damage_case.data;
  const Posterior& posterior = draws.posterior();
  const auto modes = static_cast<std::size_t>(data.modes());
  if (posterior.predictions != data.modes()) return {};
  const auto prediction = [&](std::size_t c, std::size_t i, std::size_t mode) {
    return static_cast<double>(posterior.chains[c].prediction[i * modes + mode]);
  };
  const NoiseModel noise = problem.noise();
  EmulatorVariances emulator_error(problem);
  long stride = emulator_stride(problem);
  constexpr long kSolved = 2000, kKept = 20'000;
  long all = 0;
  for (const auto& chain : posterior.chains) all += static_cast<long>(chain.model.size());
  if (problem.by_modes()) stride = std::max(1L, all / kSolved);  // each needs an FE solution
  // One draw in `kept_every` keeps its values per mode.
  const long kept_every = stride * std::max(1L, all / (stride * kKept));
  StructuralPredictor by_shapes(problem);
  ModeObservation::Scored scored;
  const ModalLikelihood::Score& score = scored.score;
  long visited = 0;
  double mean_p = 0.0, weight_seen = 0.0, best = kInfinity;  // best: smallest χ²
  std::vector<double> mean_residual(modes), spurious(modes), densities(modes);
  SingleModes single(problem);
  draws.for_each([&](std::size_t c, std::size_t i) {
    const std::span<const double> x = posterior.theta(c, i);
    const auto variances = emulator_error.next(posterior.chains[c].model[i], x);
    if (visited++ % stride != 0) return;
    const double weight = draws.weight(c, i);
    double squares = 0.0;
    for (std::size_t mode = 0; mode < modes && !problem.by_modes(); ++mode) {
      if (std::isnan(data.frequencies_hz[mode])) continue;
      const double variance = variances.empty() ? 0.0 : variances[mode];
      const double sd = noise.sd(mode, noise.cv(x), variance);
      const double r = (data.frequencies_hz[mode] - prediction(c, i, mode)) / sd;
      densities[mode] = -0.5 * r * r - std::log(sd);
      squares += r * r;
      mean_residual[mode] += weight * r;
    }
    if (problem.by_modes()) {
      if (!by_shapes.score(posterior.chains[c].model[i], x, scored)) return;
      mean_p += weight * chi_square_tail(std::max(score.freedoms, 1), score.chi_square);
      best = std::min(best, score.chi_square);
      for (std::size_t mode = 0; mode < modes; ++mode)
        spurious[mode] += weight * score.matches[mode].spurious;
      // Normalised by the full covariance, which includes the model discrepancy.
      std::vector<int> with;
      const Eigen::MatrixXd covariance =
          problem.modes().covariance(scored, problem.modal_noise(x), with);
      for (std::size_t k = 0; k < with.size(); ++k) {
        const auto mode = static_cast<std::size_t>(with[k]);
        const auto at = static_cast<Eigen::Index>(k);
        mean_residual[mode] += weight *
                               (data.frequencies_hz[mode] - score.matches[mode].frequency_hz) /
                               std::sqrt(covariance(at, at));
      }
      single.pass(posterior.chains[c].model[i], weight, x, scored);
    } else {
      if ((visited - 1) % kept_every == 0)
        single.pass(posterior.chains[c].model[i], weight, densities);
      mean_p += weight * chi_square_tail(data.measured(), squares);
      best = std::min(best, squares);
    }
    weight_seen += weight;
  });
  const ChainsOf weights = draw_weights(posterior);
  FitFinding out{.modes = {}, .posterior_predictive_p = mean_p / weight_seen};
  std::vector<int> off;
  for (std::size_t mode = 0; mode < modes; ++mode) {
    const Marginal predicted = marginal(
        all_draws(posterior, [&](auto c, auto i) { return prediction(c, i, mode); }), weights);
    const bool measured = !std::isnan(data.frequencies_hz[mode]);
    const double residual = mean_residual[mode] / weight_seen;
    const double doubted = spurious[mode] / weight_seen;
    if (doubted > kSpurious)
      remarks.push_back(remark::SpuriousMode{.mode = static_cast<int>(mode) + 1,
                                             .hz = data.frequencies_hz[mode],
                                             .probability = doubted});
    const StructuralProblem::Row row = problem.row(static_cast<int>(mode));
    out.modes.push_back({.observed = data.frequencies_hz[mode],
                         .sd = measured && !data.sd_hz.empty() ? data.sd_hz[mode] : kNaN,
                         .mean = predicted.mean,
                         .q2_5 = predicted.q2_5,
                         .q97_5 = predicted.q97_5,
                         .standardised_residual = measured ? residual : kNaN,
                         .state = row.state,
                         .mode = row.mode});
    if (measured && std::abs(residual) > 3.0 && doubted < 0.5)
      off.push_back(static_cast<int>(mode) + 1);
  }
  single.write(verdict.model, out);
  if (problem.by_modes()) out.shapes = best_shapes(problem, posterior);
  if (out.posterior_predictive_p < kMisfit) {
    verdict.why.emplace_back(
        misfit::BeyondNoise{.p = out.posterior_predictive_p,
                            .modes = off,
                            .emulated = problem.emulator != nullptr,
                            .chains_agree = excludes_fit(posterior, data.measured(), best)});
  } else if (out.posterior_predictive_p < 0.005) {
    remarks.push_back(remark::NoModelFits{off, problem.emulator != nullptr});
  } else if (out.posterior_predictive_p > 1.0 - kMisfit) {
    verdict.why.emplace_back(
        misfit::WithinNoise{out.posterior_predictive_p, data.cv.value_or(kNaN)});
  }
  verdict.p = out.posterior_predictive_p;
  return out;
}

// Reports damage inferred from frequency changes if the model's frequencies are inaccurate.
void trusted_changes(const UnpackedDraws& draws, const std::vector<ModelFinding>& models,
                     std::vector<Remark>& remarks) {
  constexpr double kOff = 0.003;
  const DamageProblem& problem = draws.problem();
  const auto& states = problem.damage_case.states();
  if (!states || !states->joined().mixing.none() ||
      !states->joined().stiffness_discrepancy.none() ||
      std::ranges::all_of(states->list, &ObservedState::damaged))
    return;
  double damaged = 0.0;
  for (const ModelFinding& model : models)
    if (std::ranges::any_of(model.counts, [](int n) { return n > 0; }))
      damaged += model.probability();
  const Posterior& posterior = draws.posterior();
  double sum = 0.0, weights = 0.0;
  draws.for_each([&](std::size_t c, std::size_t i) {
    sum += draws.weight(c, i) * problem.modal_noise(posterior.theta(c, i)).discrepancy;
    weights += draws.weight(c, i);
  });
  if (damaged > 0.5 && sum > kOff * weights)
    remarks.push_back(remark::ChangesTakenForExact{sum / weights});
}

// Reports severities at the upper bound of their prior, and counts at the largest allowed.
void bounds(const UnpackedDraws& draws, const std::vector<ModelFinding>& models,
            std::vector<Remark>& remarks) {
  const auto& kinds = draws.problem().damage_case.kinds;
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    double at_most = 0.0;
    for (const ModelFinding& model : models) {
      if (model.counts[k] == kinds[k].max_count) at_most += model.probability();
    }
    if (at_most > 0.5 && kinds[k].max_count > kinds[k].min_count) {
      const bool untested = std::ranges::any_of(remarks, [](const Remark& r) {
        return std::holds_alternative<remark::FittedNotTested>(r) ||
               std::holds_alternative<remark::CannotExclude>(r);
      });
      remarks.push_back(remark::LargestCount{static_cast<int>(k), at_most, untested});
    }
    const inference::Prior* severity = kinds[k].severity_prior();
    if (severity == nullptr || !std::isfinite(severity->upper())) continue;
    // Ten thousand draws suffice for shares and quantiles; millions do not fit into memory.
    constexpr std::size_t kEnough = 20'000;
    std::size_t all = 0;
    for (const inference::Chain& chain : draws.posterior().chains) all += chain.size();
    const std::size_t every = std::max<std::size_t>(1, all / kEnough);
    std::vector<double> severities, weights;
    draws.for_each([&](std::size_t c, std::size_t i) {
      if (i % every != 0) return;
      for (const Component& component : draws.at(c, i)) {
        if (component.kind != static_cast<int>(k)) continue;
        severities.push_back(component.severity);
        weights.push_back(draws.weight(c, i));
      }
    });
    if (bound_of(*severity, severities, weights) == PriorBound::upper)
      remarks.push_back(remark::SeverityAtBound{static_cast<int>(k)});
  }
}

// Replaces the location on the line of a structure by the site (member, node, link) and, for a
// member, by the position along it.
void split_locations(const UnpackedDraws& draws, std::vector<ModelFinding>& models) {
  const std::vector<DefectKind>& kinds = draws.problem().damage_case.kinds;
  for (std::size_t m = 0; m < models.size(); ++m) {
    std::vector<ParameterFinding> split;
    for (ParameterFinding& p : models[m].parameters) {
      if (p.unknown.kind < 0 || p.unknown.parameter != 0 ||
          kinds[static_cast<std::size_t>(p.unknown.kind)].line.is_beam()) {
        split.push_back(std::move(p));
        continue;
      }
      const DefectKind& kind = kinds[static_cast<std::size_t>(p.unknown.kind)];
      const auto of_spot = [&](auto value) {
        return marginal(draws_in_model(
            draws.posterior(), static_cast<int>(m), [&](std::size_t c, std::size_t i) {
              int n = 0;
              for (const Component& component : draws.at(c, i)) {
                if (component.kind != p.unknown.kind || n++ != p.unknown.component) continue;
                return value(kind.line.spot(component.location));
              }
              return std::numeric_limits<double>::quiet_NaN();
            }));
      };
      Unknown site = p.unknown;
      site.name = kind.site_name();
      const std::size_t at = site.label.rfind(p.unknown.name);
      if (at != std::string::npos) site.label.replace(at, p.unknown.name.size(), site.name);
      site.unit = "1";
      const bool on_members = kind.type->sites == DefectType::Sites::members;
      split.push_back({.unknown = site,
                       .estimate = of_spot([](const SiteLine::Spot& spot) {
                         return static_cast<double>(spot.site);
                       }),
                       .prior_overlap = on_members ? kNaN : p.prior_overlap});
      if (on_members)
        split.push_back({.unknown = p.unknown,
                         .estimate = of_spot([](const SiteLine::Spot& spot) { return spot.s; }),
                         .prior_overlap = p.prior_overlap});
    }
    models[m].parameters = std::move(split);
  }
}

}  // namespace

EmulatorVariances::EmulatorVariances(const DamageProblem& problem)
    : stride_(emulator_stride(problem)),
      last_(static_cast<std::size_t>(problem.problem.space.size())) {
  predicted_.frequencies_hz.resize(static_cast<std::size_t>(problem.rows()));
  if (problem.emulator && !problem.exact()) predictor_.emplace(problem, *problem.emulated);
}

std::span<const double> EmulatorVariances::next(int model, std::span<const double> x) {
  if (!predictor_) return {};
  std::vector<double>& variance = last_[static_cast<std::size_t>(model)];
  if (visited_++ % stride_ == 0 || variance.empty()) {
    predictor_->predict(model, x, ForwardModel::Quantity::frequencies, predicted_);
    variance = predicted_.error_variance;
  }
  return variance;
}

std::vector<double> measurement_noise(const DamageCase& damage_case,
                                      std::span<const double> intact) {
  if (!damage_case.data.sd_hz.empty()) return damage_case.data.sd_hz;
  std::optional<double> cv = damage_case.data.cv;
  if (!cv && damage_case.simulation && damage_case.simulation->cv > 0.0) {
    cv = damage_case.simulation->cv;
  }
  std::vector<double> noise;
  if (cv && !damage_case.data.cv_prior) {
    for (const double f : intact) noise.push_back(*cv * f);
  }
  return noise;
}

EmulatorFinding emulator_finding(const FrequencyEmulator& emulator,
                                 const std::vector<double>& noise) {
  EmulatorFinding out;
  for (int count = 1; count <= emulator.max_count(); ++count) {
    const EmulatorError& of = emulator.error(count);
    EmulatorFinding::Count entry{.kind = emulator.describe(count),
                                 .runs = static_cast<long>(emulator.runs(count)),
                                 .modes = {},
                                 .blind = {}};
    for (int mode = 0; mode < emulator.modes(); ++mode) {
      const auto at = static_cast<std::size_t>(mode);
      const auto& error = of.holdout[at];
      const double sd = at < noise.size() ? noise[at] : std::nan("");
      EmulatorFinding::Mode row{.rmse = error.rmse,
                                .max_error = error.max_error,
                                .q2 = error.q2,
                                .relative_rmse = error.relative_rmse(),
                                .noise = sd,
                                .leave_one_out = {},
                                .standardised = {}};
      if (!of.leave_one_out.empty()) row.leave_one_out = of.leave_one_out[at];
      if (!of.standardised.empty()) row.standardised = of.standardised[at];
      entry.modes.push_back(row);
      if (error.rmse / sd > entry.rmse_to_noise) {
        entry.rmse_to_noise = error.rmse / sd;
        entry.worst_mode = mode + 1;
      }
      entry.largest_to_noise = std::max(entry.largest_to_noise, error.max_error / sd);
      if (error.cannot_be_predicted()) entry.blind.push_back(mode + 1);
    }
    out.counts.push_back(std::move(entry));
  }
  return out;
}

DamageFindings damage_findings(const DamageProblem& problem, const Posterior& posterior,
                               const std::vector<MethodEvidence>& evidence, std::uint64_t seed) {
  const DamageCase& damage_case = problem.damage_case;
  const UnpackedDraws draws(problem, posterior);

  std::vector<Remark> remarks = implausible(problem);
  std::vector<inference::Watched> watched;
  const auto modes = static_cast<std::size_t>(posterior.predictions);
  for (std::size_t mode = 0; mode < modes; ++mode) {
    watched.push_back({"frequency " + std::to_string(mode + 1), [&posterior, modes, mode] {
                         return all_draws(posterior, [&](auto c, auto i) {
                           return static_cast<double>(
                               posterior.chains[c].prediction[i * modes + mode]);
                         });
                       }});
  }
  std::optional<SymmetryFinding> symmetric;
  if (problem.symmetric || !problem.symmetries.empty()) {
    const ChainsOf difference = left_less_right(draws);
    symmetric = symmetry(draws, difference, remarks);
    watched.push_back({"left minus right", [difference] { return difference; }});
  }
  DamageFindings out;
  static_cast<Findings&>(out) = run_findings(posterior, inference::judge(posterior, watched), seed);
  out.symmetry = symmetric;
  if (damage_case.structure)
    out.drawn_modes = drawn_modes(damage_case.structure->nominal, damage_case.modes());
  for (std::size_t k = 0; k < damage_case.kinds.size(); ++k) {
    out.kinds.push_back(where(draws, static_cast<int>(k)));
    out.kinds.back().places = places(draws, static_cast<int>(k), out.kinds.back().expected);
  }
  for (std::size_t k = 0; k < damage_case.kinds.size(); ++k) {
    constexpr double kWorthRemark = 0.2;
    auto merged = merged_damages(draws, out.models, static_cast<int>(k));
    if (!merged) continue;
    if (merged->merged > kWorthRemark)
      remarks.push_back(remark::NeighbouringDamages{static_cast<int>(k)});
    out.merged.push_back(std::move(*merged));
  }
  if (problem.symmetric) out.folded = folded(draws);
  add_rival_remarks(draws, symmetric, remarks);

  if (const auto factor = common_factor(draws, out.models)) remarks.push_back(*factor);
  unidentified(draws, out.models, remarks);
  out.fit_verdict.model = static_cast<int>(out.by_probability()[0]);
  out.fit = fit(draws, out.fit_verdict, remarks);
  trusted_changes(draws, out.models, remarks);
  bounds(draws, out.models, remarks);
  if (problem.emulator) {
    out.emulator = emulator_finding(*problem.emulator, damage_case.data.sd_hz);
    out.emulator->exact = problem.exact();
    out.emulator->error_in_likelihood = damage_case.emulator->emulator_error;
    // 50 runs of an external model may take minutes; the default number of FE solutions takes a
    // second.
    constexpr int kOfOutside = 50;
    out.emulator->check = problem.program() != nullptr
                              ? check_emulator(problem, posterior, kOfOutside)
                              : check_emulator(problem, posterior);
    if (out.emulator->check && out.emulator->check->answer_moved()) {
      remarks.push_back(remark::EmulatorMoved{});
    }
    out.emulator->training_calls = problem.emulator->trained_runs();
    out.emulator->validation_calls = problem.emulator->fresh_runs();
    out.emulator->likelihood_calls = posterior.full_evaluations;
    out.sampling.full_evaluations = out.emulator->training_calls + out.emulator->validation_calls +
                                    out.emulator->likelihood_calls +
                                    (out.emulator->check ? out.emulator->check->draws : 0);
    for (const ModelFinding& model : out.models) {
      const auto count = static_cast<std::size_t>(model.counts[0]);
      if (problem.exact() || model.probability() < kWorthReporting || count == 0 ||
          count > out.emulator->counts.size()) {
        continue;
      }
      const auto& blind = out.emulator->counts[count - 1].blind;
      if (!blind.empty()) {
        remarks.push_back(remark::EmulatorBlind{static_cast<int>(count), blind});
      }
    }
  }
  if (problem.states() != nullptr) out.baseline = baseline_findings(problem, posterior);
  out.remarks = std::move(remarks);
  if (damage_case.structure) split_locations(draws, out.models);
  conclude(out, draws.space(), evidence);
  return out;
}

}  // namespace wheeltap::identification
