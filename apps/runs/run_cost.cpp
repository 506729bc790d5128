#include "apps/runs/run_cost.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>

#include "apps/failure.hpp"
#include "apps/runs/likelihood_probe.hpp"
#include "apps/words.hpp"
#include "base/number.hpp"
#include "base/parallel.hpp"
#include "fem/structures/reanalysis/structure_reanalysis.hpp"
#include "fem/structures/reanalysis/structure_spectrum.hpp"
#include "identification/structural/likelihood/states_likelihood.hpp"
#include "inference/chains/draw_list.hpp"
#include "inference/engine/run_plan.hpp"
#include "io/file_error.hpp"
#include "io/netcdf/write_netcdf.hpp"

namespace wheeltap::apps {
namespace {

constexpr double kGigabyte = 1e9;
constexpr double kWarmup = 20'000;  // iterations a chain where the engine chooses
constexpr double kDraws = 25'000;   // a chain
constexpr double kThin = 4;

// Beside likelihoods: proposals, mixtures and what is kept of an iteration, and of a run [s of
// processor]. Measured on a core of 2.5 GHz (docs/scale.md).
constexpr double kBesidesACall = 3e-6, kBesidesADimension = 2e-7, kBesidesARun = 0.3;
constexpr double kSlices = 8.0;  // of a search, at the same time

std::string gigabytes(double bytes) {
  return base::significant(bytes / kGigabyte, 2);
}

std::string rounded(double x) {
  return x >= 1e3 && x < 1e15 ? base::grouped(std::lround(std::stod(base::significant(x, 2))))
                              : base::significant(x, 2);
}

}  // namespace

std::string in_words(const RunCost& cost) {
  std::string text = "about " + gigabytes(cost.bytes) + " GB of memory";
  if (cost.disk > 0.0) text += " and " + gigabytes(cost.disk) + " of disk";
  if (cost.likelihoods > 0.0) {
    text += ", " + rounded(cost.likelihoods) + " likelihoods or FE runs";
  }
  if (cost.seconds_a_likelihood > 0.0)
    text += " of " + base::significant(1e3 * cost.seconds_a_likelihood, 2) + " ms each";
  if (cost.seconds > 0.0) {
    text += ", " + duration(cost.seconds);
  }
  return text;
}

void print_estimate(const std::string& what, const RunCost& cost) {
  std::cout << "The " << what << " would take " << in_words(cost) << ".\n";
}

std::string estimate_json(const std::string& what, const RunCost& cost) {
  return Json({{"what", what},
               {"memory_bytes", cost.bytes},
               {"disk_bytes", cost.disk},
               {"likelihoods", cost.likelihoods},
               {"seconds", cost.seconds}})
      .dump();
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
  if (common.max_disk_gb && cost.disk > *common.max_disk_gb * kGigabyte)
    refuse("max-disk", *common.max_disk_gb, "GB");
}

void require_room(const RunCost& cost, const CommonOptions& common) {
  const std::filesystem::path& folder = common.output;
  std::error_code unknown;
  const std::filesystem::space_info room = std::filesystem::space(folder, unknown);
  if (unknown || common.max_disk_gb) return;
  auto left = static_cast<double>(room.available);
  for (const auto& entry : std::filesystem::directory_iterator(folder, unknown))
    if (entry.path().filename().string().starts_with("checkpoint") &&
        entry.is_regular_file(unknown))
      left += static_cast<double>(entry.file_size(unknown));
  if (cost.disk <= left) return;
  throw io::FileError(io::FileError::Kind::unwritable, folder,
                      "the draws would take about " + gigabytes(cost.disk) + " GB there; " +
                          gigabytes(left) + " GB are free (--max-disk allows more)");
}

double bytes_held() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

void measure(RunCost& cost, const inference::Problem& problem, const inference::Options& engine,
             double seconds) {
  const LikelihoodTime time = probe(problem, seconds);
  const inference::RunPlan plan = inference::plan_of(problem, engine);
  const double besides = kBesidesACall + kBesidesADimension * problem.space.max_dimension();
  const double threads = base::thread_count(engine.threads);
  const double searching = plan.explore_on_all_data * time.mean + plan.explore * besides;
  const double drawing = (plan.tune + plan.sample + plan.evidence) * (time.middle + besides);
  cost.likelihoods = plan.calls();
  cost.seconds_a_likelihood = time.middle;
  cost.seconds = cost.preparation + searching / std::min(threads, kSlices) +
                 drawing / std::min(threads, static_cast<double>(engine.chains)) + kBesidesARun;
}

RunCost cost_of_sampling(const Sampled& sampled, const CommonOptions& common,
                         const SamplingOptions& options) {
  const double share = sampled.records && options.draws == 0 ? 0.5 : 1.0;
  const double draws = options.draws > 0 ? options.draws : (options.quick ? 1000.0 : kDraws);
  const double warmup =
      options.warmup > 0 ? options.warmup : (options.quick ? 1000.0 : kWarmup * share);
  // As inference::Chain has it. Beyond kOnHeap a list is on the disk, and so are the parts of a
  // checkpoint and posterior.nc: what is kept in memory of each draw is what is sorted, one
  // parameter at a time.
  constexpr double kProgram = 3e7, kLists = 7.0;
  const double predictions = options.prior_only ? 0.0 : sampled.predictions;
  const double draw = 23.0 + 8.0 * sampled.largest + 4.0 * predictions;
  const double all = options.chains * draws;
  const double on_heap = options.chains * kLists * double{inference::DrawMemory::kOnHeap};
  const bool has_folder = !common.output.empty() || common.dry_run;  // as every command's run has
  const bool streamed = has_folder && all * draw > double{io::kNetcdfInMemory};
  const double explored =
      sampled.explored * (options.quick ? 0.2 : 1.0) * (sampled.models + sampled.dimensions);
  const double in_memory = streamed ? std::min(all * draw, on_heap) + 80.0 * all
                                    : all * (1.8 * draw + 28.0 * sampled.largest + 40.0);
  RunCost cost{.bytes = kProgram + in_memory,
               .disk = streamed ? 3.0 * all * draw : 0.0,
               .likelihoods = options.chains * (warmup + draws * kThin * share) + explored};
  const int threads = std::min(base::thread_count(common.threads), options.chains);
  cost.seconds = cost.likelihoods * sampled.seconds_a_likelihood / threads;
  return cost;
}

RunCost cost_of_damages(const identification::DamageCase& damage_case, const CommonOptions& common,
                        const SamplingOptions& options) {
  const bool structure = damage_case.solved_as_structure();
  const auto n =
      structure
          ? static_cast<double>(identification::discretise(damage_case.solved_structure()).size())
          : 2.0 * damage_case.beam.elements;
  const double modes = damage_case.modes();
  const double common_ones = damage_case.data.cv_prior ? 1.0 : 0.0;
  const double kept =
      structure ? fem::StructureReanalysis::kept_modes(static_cast<int>(n), damage_case.modes())
                : n;
  // Measured on a core of 2.5 GHz.
  Sampled sampled{.largest = common_ones,
                  .predictions = modes,
                  .explored = 10'000.0,  // 5 000 to 14 000 on the starter cases
                  .seconds_a_likelihood =
                      1e-6 * modes * (structure ? 1.5 + 0.01 * kept : 0.6 + 0.00125 * kept)};
  if (damage_case.states) {
    const identification::StatesLikelihood states(damage_case.states, damage_case.kinds);
    sampled.seconds_a_likelihood = states.check(8).seconds_a_solution;
    sampled.largest += static_cast<double>(damage_case.states->parameters().size());
  }
  double mean = sampled.largest;
  for (const identification::DefectKind& kind : damage_case.kinds) {
    const double each = kind.severity_prior() != nullptr ? 2.0 : 1.0;
    sampled.models *= kind.max_count - kind.min_count + 1.0;
    sampled.largest += each * kind.max_count;
    mean += each * 0.5 * (kind.min_count + kind.max_count);
  }
  sampled.dimensions = sampled.models * mean;
  RunCost cost = cost_of_sampling(sampled, common, options);
  cost.seconds_a_likelihood = sampled.seconds_a_likelihood;
  if (damage_case.states) return cost;
  const double likelihoods = cost.seconds;
  if (kept < n) {
    // The lowest modes; then, once a place, four vectors that the others yield.
    cost.seconds += 3.3e-6 * n * kept + 1.2e-6 * n * n;
    cost.bytes += 32.0 * n * kept + 2e3 * n +
                  std::min(32.0 * n * n, double{fem::StructureReanalysis::kResidualMemory});
  } else if (structure) {  // all n modes of the intact structure
    cost.seconds += (n <= fem::kWideSpectrum ? 1.2e-8 : 1.35e-9) * n * n * n;
    cost.bytes += 52.0 * n * n;
  } else {
    cost.seconds += 4e-6 * n * n;
    cost.bytes += 24.0 * n * n;
  }
  cost.preparation = cost.seconds - likelihoods;
  return cost;
}

RunCost cost_of_modes(double numbers) {
  // Measured: 2 s for eight channels of 61 440 samples, 90 s for twenty of a million.
  return {.bytes = 2e8 + 4.0 * 8.0 * numbers, .seconds = 1.0 + 4e-6 * numbers};
}

RunCost cost_of_truth(const CaseFile& file) {
  if (!file.json.contains("truth")) return {};
  const Json& truth = file.json["truth"];
  const double samples = truth["samples"].get<double>();
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
