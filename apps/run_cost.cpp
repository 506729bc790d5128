#include "apps/run_cost.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "apps/failure.hpp"
#include "base/number.hpp"
#include "base/parallel.hpp"
#include "inference/evidence/model_posterior.hpp"

namespace wheeltap::apps {
namespace {

constexpr double kGigabyte = 1e9;
constexpr double kWarmup = 20'000;  // iterations a chain where the engine chooses
constexpr double kDraws = 25'000;   // a chain
constexpr double kThin = 4;

std::string rounded(double x) {
  return x >= 1e4 && x < 1e15 ? base::grouped(std::lround(std::stod(base::significant(x, 2))))
                              : base::significant(x, 2);
}

}  // namespace

std::string in_words(const RunCost& cost) {
  std::string text = "about " + base::significant(cost.bytes / kGigabyte, 2) + " GB of memory";
  if (cost.likelihoods > 0.0) {
    text += ", " + rounded(cost.likelihoods) + " likelihoods or FE runs";
  }
  if (cost.seconds > 0.0) {
    text += ", " + (cost.seconds < 3600.0 ? rounded(cost.seconds) + " s"
                                          : rounded(cost.seconds / 3600.0) + " h");
  }
  return text;
}

void require_affordable(const CaseFile& file, const Pointer& where, const RunCost& cost,
                        const CommonOptions& common) {
  const auto refuse = [&](const std::string& option, double limit, const std::string& unit) {
    file.refuse(where, "would take " + in_words(cost) + "; --" + option + " allows " +
                           base::significant(limit, 4) + " " + unit);
  };
  if (cost.bytes > common.max_memory_gb * kGigabyte)
    refuse("max-memory", common.max_memory_gb, "GB");
  if (cost.seconds > common.max_hours * 3600.0) refuse("max-hours", common.max_hours, "h");
}

RunCost cost_of_sampling(const inference::ModelSpace& space, int predictions,
                         double seconds_a_likelihood, const CommonOptions& common,
                         const SamplingOptions& options) {
  const double draws = options.draws > 0 ? options.draws : (options.quick ? 1000.0 : kDraws);
  const double warmup = options.warmup > 0 ? options.warmup : (options.quick ? 1000.0 : kWarmup);
  const double dimension = space.max_dimension();
  // As inference::Chain has it, and a second time while it is judged and written.
  const double draw = 23.0 + 8.0 * dimension + 4.0 * predictions;
  // Each model is explored by itself before anything is drawn, most of it annealing where that is
  // needed: 5 000 to 14 000 a dimension on the starter cases.
  const double each = options.quick ? 2'000.0 : 10'000.0;
  double explored = 0.0;
  for (int m = 0; m < space.size(); ++m) explored += each * (1.0 + space[m].dimension);
  RunCost cost{.bytes = 2.0 * options.chains * draws * draw,
               .likelihoods = options.chains * (warmup + draws * kThin) + explored};
  const int threads = std::min(base::thread_count(common.threads), options.chains);
  cost.seconds = cost.likelihoods * seconds_a_likelihood / threads;
  return cost;
}

double seconds_a_likelihood(const inference::Problem& problem, int model) {
  using Clock = std::chrono::steady_clock;
  inference::ModelPosterior posterior(problem, model);
  // Components in order, all near the middle: none on another.
  std::vector<double> z(static_cast<std::size_t>(posterior.dimension()));
  for (std::size_t i = 0; i < z.size(); ++i) z[i] = 0.02 * static_cast<double>(i);
  posterior.order(z);
  const auto began = Clock::now();
  double seconds = 0.0;
  int calls = 0;
  for (; calls < 100 && seconds < 0.005; ++calls) {
    if (!z.empty()) z[0] += 1e-6;
    try {
      (void)posterior(z);
    } catch (const inference::LikelihoodError&) {
      return 0.0;  // the run says why
    }
    seconds = std::chrono::duration<double>(Clock::now() - began).count();
  }
  return seconds / calls;
}

RunCost cost_of_truth(const CaseFile& file) {
  if (!file.json.contains("truth")) return {};
  const Json& truth = file.json["truth"];
  const double samples = truth["samples"];
  std::size_t columns = 0;
  const auto count = [&](const Json& record) {
    columns += record["channels"].size() + truth["excitation"].size();
  };
  if (file.json.contains("record")) count(file.json["record"]);
  for (const Json& record : file.json.value("records", Json::array())) count(record);
  // Every column as drawn, between samples, simulated and with noise.
  return {.bytes = 8.0 * samples * (4.0 + 6.0 * static_cast<double>(columns))};
}

RunCost cost_of_tables(const identification::DamageCase& damage_case) {
  if (!damage_case.emulator || damage_case.emulator->sites.empty()) return {};
  const identification::EmulatorSpec& spec = *damage_case.emulator;
  const int modes = damage_case.modes();
  RunCost cost;
  for (int count = 1; count <= spec.tables(damage_case.kinds[0].max_count); ++count) {
    double runs = 1.0;
    for (int d = 0; d < count; ++d) {
      const auto list = std::min(static_cast<std::size_t>(d), spec.sites.size() - 1);
      runs *= static_cast<double>(spec.sites[list].size() * spec.reductions.size());
    }
    cost.likelihoods += runs;
    cost.bytes += 8.0 * runs * (2.0 * count + 2.0 * modes);
  }
  constexpr double kSecondsARun = 2e-5;
  cost.seconds = cost.likelihoods * kSecondsARun;
  return cost;
}

}  // namespace wheeltap::apps
