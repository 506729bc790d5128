#include "identification/plausibility.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/random.hpp"
#include "identification/sid_predictive.hpp"
#include "identification/structure_plausibility.hpp"

namespace wheeltap::identification {
namespace {

constexpr int kDraws = 200;
constexpr double kApart = 0.1;         // of a frequency
constexpr double kApartInNoise = 5.0;  // sd
constexpr double kHidden = 0.5;        // effect over noise
constexpr double kOtherSize = 30.0;    // of a response
constexpr double kPlausibilitySeconds = 2.0;
constexpr int kSamples = 2000;  // a size needs no more of them

/// Draw `i` of the prior within a model, always the same.
std::vector<double> prior_draw(const inference::ModelSpace& space, int model, int i) {
  base::Random random(1, 0, static_cast<std::uint64_t>(i), base::Purpose::prediction);
  std::vector<double> x;
  for (int p = 0; p < space[model].dimension; ++p) {
    x.push_back(space.prior(model, p).from_standard_normal(random.normal()));
  }
  return x;
}

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void take(double x) { low = std::min(low, x), high = std::max(high, x); }
  /// The nearest of it to x > 0, in terms of ratios.
  [[nodiscard]] double nearest(double x) const { return std::clamp(x, low, high); }
};

double rms_about_mean(std::span<const double> y) {
  const auto n = static_cast<double>(y.size());
  const double mean = std::accumulate(y.begin(), y.end(), 0.0) / n;
  double sum = 0.0;
  for (const double value : y) sum += (value - mean) * (value - mean);
  return std::sqrt(sum / n);
}

double median(std::vector<double> x) {
  std::ranges::sort(x);
  return x[x.size() / 2];
}

/// Root mean squares about their means of the responses that draws of the prior predict, all models
/// in turn.
std::vector<Range> predicted_sizes(const SidProblem& problem) {
  const auto& space = problem.problem.space;
  const auto samples = static_cast<std::size_t>(problem.misfits.front().samples());
  const std::size_t responses = problem.sid_case.responses().size();
  const int draws =
      std::clamp(static_cast<int>(kPlausibilitySeconds / problem.seconds_a_likelihood),
                 2 * space.size(), kDraws);
  std::vector<Range> out(responses);
  std::vector<double> residuals(responses * samples);
  for (int i = 0; i < draws; ++i) {
    const int m = i % space.size();
    const auto theta = problem.theta(m, prior_draw(space, m, i));
    if (!problem.misfits[static_cast<std::size_t>(m)].residuals(theta, residuals)) continue;
    for (std::size_t c = 0; c < responses; ++c) {
      std::vector<double> y = observed(problem, c, theta);
      for (std::size_t n = 0; n < samples; ++n) y[n] -= residuals[c * samples + n];
      out[c].take(rms_about_mean(y));
    }
  }
  return out;
}

void judge_sizes(const SidProblem& problem, std::vector<Remark>& remarks) {
  const auto responses = problem.sid_case.responses();
  const std::vector<Range> predicted = predicted_sizes(problem);
  // Offsets may be parameters; they count nothing about the mean.
  const auto any = problem.theta(0, prior_draw(problem.problem.space, 0, 0));
  remark::ResponsesOutOfReach out_of_reach;
  remark::NoiseAboveResponse noisy;
  for (std::size_t c = 0; c < responses.size(); ++c) {
    if (!responses[c]->signal.scale.is_constant()) continue;
    const double measured = rms_about_mean(observed(problem, c, any));
    const Range& range = predicted[c];
    if (measured > kOtherSize * range.high || measured * kOtherSize < range.low) {
      out_of_reach.channels.push_back({responses[c]->name(), measured, range.low, range.high});
    }
    double least = std::numeric_limits<double>::infinity();
    for (const SidModel& model : problem.sid_case.models) {
      if (!model.noise[c].is_constant()) least = 0.0;
      least = std::min(least, model.noise[c].value);
    }
    if (least > measured && !problem.sid_case.simulated) {
      noisy.channels.push_back({responses[c]->name(), least, measured});
    }
  }
  if (!out_of_reach.channels.empty()) remarks.push_back(std::move(out_of_reach));
  if (!noisy.channels.empty()) remarks.push_back(std::move(noisy));
}

void judge_truth(const SidCase& sid_case, std::vector<Remark>& remarks) {
  if (!sid_case.simulated || !sid_case.truth) return;
  const SidTruth& truth = *sid_case.truth;
  const SidModel& model = sid_case.models[static_cast<std::size_t>(truth.model)];
  remark::TruthOutsidePriors outside;
  for (const int p : sid_case.parameters_of(model)) {
    const auto at = static_cast<std::size_t>(p);
    const inference::Parameter& parameter = sid_case.parameters[at];
    // The noise that was added rules, whatever the parameter is said to be.
    const auto noise = std::ranges::find(model.noise, p, &dynamics::Coefficient::parameter);
    const double value = noise == model.noise.end()
                             ? truth.theta[at]
                             : truth.noise[static_cast<std::size_t>(noise - model.noise.begin())];
    if (std::isinf(parameter.prior.log_density(value)))
      outside.parameters.push_back({parameter.name, value, parameter.prior.describe()});
  }
  if (!outside.parameters.empty()) remarks.emplace_back(std::move(outside));
}

}  // namespace

std::vector<Remark> implausible(const DamageProblem& problem) {
  const DamageCase& damage_case = problem.damage_case;
  std::vector<Remark> remarks = damage_case.structure ? implausible(damage_case.structure->nominal)
                                                      : implausible(damage_case.beam);
  if (damage_case.modal)
    for (Remark& remark : implausible(damage_case.modal->sensors))
      remarks.push_back(std::move(remark));
  const FrequencyData& data = problem.damage_case.data;
  const auto& space = problem.problem.space;
  const auto modes = static_cast<std::size_t>(data.modes());
  FrequencyPredictor predictor(problem);
  std::vector<Range> predicted(modes);
  std::vector<double> f(modes), ignored(modes);
  // A model of someone else's is asked no more than it must be.
  const bool emulated = problem.outside && problem.emulator && !problem.exact();
  for (int i = 0; i < kDraws; ++i) {
    const int m = i % space.size();
    if (emulated)
      predictor.emulate(m, prior_draw(space, m, i), f, ignored);
    else
      predictor.solve(m, prior_draw(space, m, i), f);
    for (std::size_t mode = 0; mode < modes; ++mode) {
      if (std::isfinite(f[mode])) predicted[mode].take(f[mode]);
    }
  }
  std::vector<double> ratios, effects;
  remark::FrequenciesOutOfReach away{};
  int measured = 0;
  for (std::size_t mode = 0; mode < modes; ++mode) {
    const double observed = data.frequencies_hz[mode];
    const Range& range = predicted[mode];
    if (std::isnan(observed) || !(range.high > 0.0)) continue;
    ++measured;
    const double sd = data.sd_hz.empty() ? 0.0 : data.sd_hz[mode];
    const double nearest = range.nearest(observed);
    if (std::abs(observed - nearest) > std::max(kApart * nearest, kApartInNoise * sd)) {
      if (ratios.empty()) {
        away = {.ratio = 0.0,
                .measured = observed,
                .lowest = range.low,
                .highest = range.high,
                .mode = static_cast<int>(mode) + 1};
      }
      ratios.push_back(observed / nearest);
    }
    if (sd > 0.0) effects.push_back((range.high - range.low) / sd);
  }
  if (!ratios.empty() && 2 * static_cast<int>(ratios.size()) >= measured) {
    away.ratio = median(ratios);
    remarks.push_back(away);
  }
  if (!effects.empty() && space.size() > 1) {
    const auto most = std::ranges::max_element(effects);
    if (*most < kHidden) {
      remarks.push_back(remark::NoiseHidesDamage{data.cv.value_or(std::nan("")), *most});
    }
  }
  return remarks;
}

std::vector<Remark> implausible(const UpdateCase& update_case) {
  std::vector<Remark> remarks = implausible(update_case.structure->nominal);
  for (Remark& remark : implausible(update_case.data.sensors)) remarks.push_back(std::move(remark));
  return remarks;
}

std::vector<Remark> implausible(const SidProblem& problem) {
  // What the prior draws first are the dearest trajectories of a run: stiff, stuck, far away.
  if (problem.misfits.front().samples() > kSamples) {
    return implausible(*make_sid_problem(shortened(problem.sid_case, kSamples)));
  }
  std::vector<Remark> remarks;
  judge_truth(problem.sid_case, remarks);
  judge_sizes(problem, remarks);
  for (const auto& record : problem.further) judge_sizes(*record, remarks);
  return remarks;
}

}  // namespace wheeltap::identification
