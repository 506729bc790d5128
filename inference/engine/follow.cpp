#include "inference/engine/follow.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "base/parcel.hpp"
#include "inference/diagnosis/convergence.hpp"

namespace wheeltap::inference {
namespace {

constexpr int kWalks = 64;
constexpr int kSteps = 1000;
constexpr int kApart = 10;  // steps between two checks

constexpr double kLowest = 0.01;  // share of the chains' draws below the limit of ln π

// Region outside a mixture: ln (π / q) above `ratio`, and ln π at least that of nearly all draws.
// The second condition excludes SMC samples that descend from a few draws in the tails, as may
// occur in many dimensions.
struct Beyond {
  const NormalMixture& mixture;
  double ratio, log_posterior;
  [[nodiscard]] bool operator()(double at, std::span<const double> z) const {
    return at >= log_posterior && at - mixture.log_density(z) > ratio;
  }
};

Beyond beyond_mixture(const RunState& state, int model) {
  const auto m = static_cast<std::size_t>(model);
  std::vector<double> drawn;
  for (const ChainState& chain : state.chains) {
    const std::vector<double>& of_chain = chain.kept->of(model).log_posterior;
    drawn.insert(drawn.end(), of_chain.begin(), of_chain.end());
  }
  double lowest = -std::numeric_limits<double>::infinity();
  if (!drawn.empty()) {
    const auto at =
        drawn.begin() + static_cast<std::ptrdiff_t>(kLowest * static_cast<double>(drawn.size()));
    std::ranges::nth_element(drawn, at);
    lowest = *at;
  }
  return {.mixture = *state.pilot.fit->density[m],
          .ratio = state.posterior.found[m].bridged.log_evidence + std::log(kLimits.beyond_mixture),
          .log_posterior = lowest};
}

// The checked states of a chain.
struct Walk {
  std::vector<double> z;  // states outside the mixture
  long beyond = 0, looks = 0;
  long evaluations = 0;
};

// Runs a chain from `from` with the kernels of tuning, which make mostly small steps.
Walk walk(const RunContext& run, const RunState& state, int model, const Beyond& is_beyond,
          int number, const Eigen::VectorXd& from) {
  const auto kernels =
      sampling_kernels(run.problem, run.options, run.atlases, state.pilot, Reach::tuning);
  Target target(run.problem, false);
  target.set_model_bias(state.sampling_bias);
  State at;
  at.model = model;
  at.z.assign(from.begin(), from.end());
  target.evaluate(at);
  Walk out;
  const auto stream = static_cast<std::uint64_t>(model) << 32U | static_cast<std::uint64_t>(number);
  for (int i = 0; i < kSteps && !run.monitor.stopped(); ++i) {
    base::Random random(run.options.seed, stream, static_cast<std::uint64_t>(i),
                        base::Purpose::following);
    Kernel::Outcome outcome;
    kernels->step(at, {target, random, 1.0, false}, outcome);
    if (i % kApart != 0) continue;
    // The first half of the steps is burn-in, in which the chain may return to the mixture.
    const bool late = i >= kSteps / 2;
    if (at.model != model) continue;
    out.looks += late ? 1 : 0;
    // Within the model, as the densities of the draws.
    const double log_posterior = target.log_prior(at) + at.log_likelihood -
                                 run.space()[model].log_prior -
                                 state.sampling_bias[static_cast<std::size_t>(model)];
    if (!is_beyond(log_posterior, at.z)) continue;
    out.beyond += late ? 1 : 0;
    out.z.insert(out.z.end(), at.z.begin(), at.z.end());
  }
  out.evaluations = target.evaluations();
  return out;
}

}  // namespace

std::vector<Eigen::MatrixXd> follow_annealed(RunContext& run, RunState& state) {
  std::vector<Eigen::MatrixXd> met(run.models());
  for (std::size_t m = 0; m < std::min(run.models(), state.posterior.found.size()); ++m) {
    const auto model = static_cast<int>(m);
    const ModelExploration& explored = state.explorations[m];
    ModelFindings& found = state.posterior.found[m];
    const Eigen::MatrixXd& drawn = explored.annealed_draws;
    if (drawn.cols() == 0 || !state.pilot.fit->density[m] ||
        !std::isfinite(found.bridged.log_evidence) || run.monitor.stopped() ||
        state.posterior.probability(model).value < kLimits.judged_model)
      continue;
    const Beyond is_beyond = beyond_mixture(state, model);
    std::vector<Eigen::Index> beyond;
    for (Eigen::Index i = 0; i < drawn.cols(); ++i) {
      const auto column = drawn.col(i);
      if (is_beyond(explored.annealed_log_posterior[static_cast<std::size_t>(i)],
                    {column.data(), static_cast<std::size_t>(column.size())}))
        beyond.push_back(i);
    }
    found.annealed_draws = static_cast<long>(drawn.cols());
    found.annealed_beyond = static_cast<double>(beyond.size()) / static_cast<double>(drawn.cols());
    if (!lacks_annealed(found, kWorthFollowing)) continue;
    const int walks = static_cast<int>(std::min<std::size_t>(beyond.size(), kWalks));
    std::vector<Walk> walked(static_cast<std::size_t>(walks));
    base::parallel_for(
        walks, run.options.threads,
        [&](int w) {
          const std::size_t from =
              static_cast<std::size_t>(w) * beyond.size() / static_cast<std::size_t>(walks);
          walked[static_cast<std::size_t>(w)] =
              walk(run, state, model, is_beyond, w, drawn.col(beyond[from]));
        },
        base::carriage([&](int w, auto& parcel) {
          Walk& one = walked[static_cast<std::size_t>(w)];
          parcel(one.z, one.beyond, one.looks, one.evaluations);
        }));
    std::vector<double> z;
    long stayed = 0, looks = 0, calls = 0;
    for (const Walk& one : walked) {
      z.insert(z.end(), one.z.begin(), one.z.end());
      stayed += one.beyond;
      looks += one.looks;
      calls += one.evaluations;
    }
    state.shared_evaluations += calls;
    state.posterior.calls.evidence += calls;
    run.monitor.evaluated(calls);
    if (run.monitor.stopped()) return met;
    found.annealed_beyond *= static_cast<double>(stayed) / static_cast<double>(std::max(1L, looks));
    met[m] = Eigen::Map<const Eigen::MatrixXd>(z.data(), drawn.rows(),
                                               static_cast<Eigen::Index>(z.size()) / drawn.rows());
  }
  return met;
}

}  // namespace wheeltap::inference
