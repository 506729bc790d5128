#include "inference/engine/run_cost.hpp"

#include <algorithm>

#include "base/parallel.hpp"
#include "inference/chains/draw_list.hpp"
#include "inference/engine/run_context.hpp"
#include "inference/engine/run_plan.hpp"
#include "inference/model/likelihood_probe.hpp"

namespace wheeltap::inference {
namespace {

constexpr double kWarmup = 20'000;  // iterations per chain chosen by the engine
constexpr double kThin = 4;

// Processor time without likelihoods [s], for proposals, mixtures and storage: per likelihood
// evaluation, per evaluation and dimension, and per run. Core of 2.5 GHz (docs/scale.md).
constexpr double kBesidesACall = 3e-6, kBesidesADimension = 2e-7, kBesidesARun = 0.3;
constexpr double kSearchSlices = 8.0;  // slices of a search that run at the same time

}  // namespace

RunCost cost_of_sampling(const ProblemSize& size, const Options& options, double most_in_memory) {
  const double draws = options.draws > 0 ? options.draws : (options.quick ? 1000.0 : kDefaultDraws);
  const double warmup = options.warmup > 0 ? options.warmup : (options.quick ? 1000.0 : kWarmup);
  // Sizes as in Chain. Lists above kOnHeap, parts of a checkpoint and posterior.nc are on the disk.
  // The memory then contains only the values of one parameter at a time, for sorting.
  constexpr double kProgram = 3e7, kLists = 7.0;
  const double predictions = options.prior_only ? 0.0 : size.predictions;
  const double draw = 23.0 + 8.0 * size.largest + 4.0 * predictions;
  const double all = options.chains * draws;
  const double on_heap = options.chains * kLists * double{DrawMemory::kOnHeap};
  const bool streamed = all * draw > most_in_memory;
  const double explored =
      size.explored * (options.quick ? 0.2 : 1.0) * (size.models + size.dimensions);
  const double in_memory = streamed ? std::min(all * draw, on_heap) + 80.0 * all
                                    : all * (1.8 * draw + 28.0 * size.largest + 40.0);
  RunCost cost{.bytes = kProgram + in_memory,
               .disk = streamed ? 3.0 * all * draw : 0.0,
               .likelihoods = options.chains * (warmup + draws * kThin) + explored};
  const int threads = std::min(base::thread_count(options.threads), options.chains);
  cost.seconds = cost.likelihoods * size.seconds_a_likelihood / threads;
  return cost;
}

void measure(RunCost& cost, const Problem& problem, const Options& options, double seconds) {
  const LikelihoodTime time = probe(problem, seconds);
  const RunPlan plan = plan_of(problem, options);
  const double besides = kBesidesACall + kBesidesADimension * problem.space.max_dimension();
  const double threads = base::thread_count(options.threads);
  const double searching = plan.explore_on_all_data * time.mean + plan.explore * besides;
  const double drawing = (plan.tune + plan.sample + plan.evidence) * (time.middle + besides);
  cost.likelihoods = plan.calls();
  cost.seconds_a_likelihood = time.middle;
  cost.seconds = cost.preparation + searching / std::min(threads, kSearchSlices) +
                 drawing / std::min(threads, static_cast<double>(options.chains)) + kBesidesARun;
}

}  // namespace wheeltap::inference
