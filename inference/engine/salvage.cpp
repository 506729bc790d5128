#include "inference/engine/salvage.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "inference/engine/model_probabilities.hpp"
#include "inference/engine/sample.hpp"
#include "inference/engine/temper.hpp"
#include "inference/engine/tune.hpp"
#include "inference/engine/weigh.hpp"

namespace wheeltap::inference {
namespace {

// The user waits after a request to stop. After kPatience, a chain repeats its draws. A chain
// without draws continues until kMostPatience.
constexpr std::chrono::milliseconds kPatience{400}, kMostPatience{2000};

// The best available approximation of each model's posterior, dimension × n.
std::vector<Eigen::MatrixXd> populations(const RunContext& run, const RunState& state) {
  std::vector<Eigen::MatrixXd> out;
  for (int m = 0; m < run.space().size(); ++m) {
    const ModelExploration& found = state.explorations[static_cast<std::size_t>(m)];
    out.push_back(found.population);
    for (const ChainState& chain : state.chains) {
      if (found.population.cols() > 0 || chain.by_rung.empty()) continue;
      const Eigen::MatrixXd more = chain.by_rung.back().states(m);
      if (more.cols() == 0) continue;
      Eigen::MatrixXd& all = out.back();
      const Eigen::Index had = all.cols();
      all.conservativeResize(more.rows(), had + more.cols());
      all.rightCols(more.cols()) = more;
    }
  }
  return out;
}

}  // namespace

void salvage(RunContext& run, RunState& state) {
  Posterior& posterior = state.posterior;
  if (posterior.draws >= kSalvaged || run.options.prior_only) return;
  const std::vector<Eigen::MatrixXd> of = populations(run, state);
  if (state.probability.empty()) {
    if (state.by_rung.empty() && state.chains.front().ladder) pool_ladders(run, state);
    estimate_probabilities(run, state);
  }
  std::vector<double> cumulative;
  double sum = 0.0;
  for (std::size_t m = 0; m < of.size(); ++m) {
    const bool any = of[m].cols() > 0 || (run.space()[static_cast<int>(m)].dimension == 0 &&
                                          std::isfinite(state.explorations[m].log_evidence()));
    cumulative.push_back(sum += any ? state.probability[m] : 0.0);
  }
  if (!(sum > 0.0)) return;
  if (!state.pilot.fit) fit_proposals(run, state, 0);
  state.sampling_bias.assign(run.models(), 0.0);
  posterior.log_weight.clear();
  posterior.tempered_draws = false;
  prepare_draws(run, state);
  run.each_chain(state, [&](int c, ChainState& chain, Target& target) {
    target.set_model_bias(state.sampling_bias);
    Chain& out = posterior.chains[static_cast<std::size_t>(c)];
    out.clear();
    base::Random random(run.options.seed, static_cast<std::uint64_t>(c), 2, base::Purpose::start);
    std::vector<State> drawn;
    const auto began = std::chrono::steady_clock::now();
    for (int tries = 0; out.size() < kSalvaged && tries < 10 * kSalvaged; ++tries) {
      if (const auto took = std::chrono::steady_clock::now() - began; took > kPatience) {
        if (drawn.empty() && took > kMostPatience) break;
        if (!drawn.empty()) {
          chain.state =
              drawn[static_cast<std::size_t>(random.index(static_cast<int>(drawn.size())))];
          record(run, state, target, -1, false, chain, out);
          continue;
        }
      }
      const double u = sum * random.uniform();
      const auto m =
          static_cast<std::size_t>(std::ranges::upper_bound(cumulative, u) - cumulative.begin());
      State at;
      at.model = static_cast<int>(std::min(m, cumulative.size() - 1));
      const Eigen::MatrixXd& population = of[static_cast<std::size_t>(at.model)];
      if (population.cols() > 0) {
        const auto column = population.col(random.index(static_cast<int>(population.cols())));
        at.z.assign(column.begin(), column.end());
      }
      target.sort_components(at);
      target.evaluate(at);
      if (!std::isfinite(at.log_likelihood)) continue;
      chain.state = std::move(at);
      drawn.push_back(chain.state);
      record(run, state, target, -1, false, chain, out);
    }
  });
  std::size_t common = posterior.chains.front().size();
  for (const Chain& chain : posterior.chains) common = std::min(common, chain.size());
  for (Chain& chain : posterior.chains) chain.truncate(common);
  posterior.draws = static_cast<int>(common);
  posterior.thin = 1;
  for (const ChainState& chain : state.chains) {
    posterior.moves = chain.moves;
    posterior.jumps_proposed = chain.proposed;
    posterior.jumps_accepted = chain.accepted;
  }
  const Chain& any = posterior.chains.front();
  posterior.predictions =
      any.size() == 0 ? 0 : static_cast<int>(any.prediction.size() / any.size());
  weigh(run, state);
  posterior.choices.push_back(Choice::drawn_by_searches);
}

}  // namespace wheeltap::inference
