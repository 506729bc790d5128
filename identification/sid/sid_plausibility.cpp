#include "identification/sid/sid_plausibility.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "identification/findings/prior_draws.hpp"
#include "identification/sid/sid_predictive.hpp"

namespace wheeltap::identification {
namespace {

constexpr double kOtherSize = 30.0;  // factor between measured and predicted size of a response
constexpr double kPlausibilitySeconds = 2.0;
constexpr int kSamples = 2000;  // samples sufficient to estimate a size

double rms_about_mean(std::span<const double> y) {
  const auto n = static_cast<double>(y.size());
  const double mean = std::accumulate(y.begin(), y.end(), 0.0) / n;
  double sum = 0.0;
  for (const double value : y) sum += (value - mean) * (value - mean);
  return std::sqrt(sum / n);
}

/// RMS about the mean of responses predicted by prior draws; the draws alternate over all models.
std::vector<PriorRange> predicted_sizes(const SidProblem& problem) {
  const auto& space = problem.problem.space;
  const auto samples = static_cast<std::size_t>(problem.misfits.front().samples());
  const std::size_t responses = problem.sid_case.responses().size();
  const int draws =
      std::clamp(static_cast<int>(kPlausibilitySeconds / problem.seconds_a_likelihood),
                 2 * space.size(), kPriorDraws);
  std::vector<PriorRange> out(responses);
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
  const std::vector<PriorRange> predicted = predicted_sizes(problem);
  // Offsets may be parameters, but do not affect the RMS about the mean.
  const auto any = problem.theta(0, prior_draw(problem.problem.space, 0, 0));
  remark::ResponsesOutOfReach out_of_reach;
  remark::NoiseAboveResponse noisy;
  for (std::size_t c = 0; c < responses.size(); ++c) {
    if (!responses[c]->signal.scale.is_constant()) continue;
    const double measured = rms_about_mean(observed(problem, c, any));
    const PriorRange& range = predicted[c];
    const bool computed = range.low <= range.high;  // false if no draw has a bounded response
    if (computed && (measured > kOtherSize * range.high || measured * kOtherSize < range.low)) {
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
    // For a noise parameter, compare the noise that was added, not the stated value.
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

std::vector<Remark> implausible(const SidProblem& problem) {
  // Prior draws can have the most expensive trajectories of a run (stiff, sticking or far from the
  // data): use a short part of the record.
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
