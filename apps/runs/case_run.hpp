// A sampling run of a case: the steps that differ between kinds of cases, and their order.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "apps/cases/syntax/case_file.hpp"
#include "apps/remote/umbridge_server.hpp"
#include "apps/run_options.hpp"
#include "apps/runs/finished_run.hpp"
#include "apps/runs/run_cost.hpp"
#include "apps/runs/run_watch.hpp"

namespace wheeltap::apps {

/// A parsed case with the options of its run. `run_case` and Python call the steps in the order of
/// their declaration; `serve` calls only the preparation.
class CaseRun {
 public:
  CaseRun(const CommonOptions& common, const SamplingOptions& options)
      : common_(common), options_(options) {}
  CaseRun(const CaseRun&) = delete;
  CaseRun& operator=(const CaseRun&) = delete;
  virtual ~CaseRun() = default;

  [[nodiscard]] const CommonOptions& common() const { return common_; }
  [[nodiscard]] const SamplingOptions& options() const { return options_; }
  [[nodiscard]] std::uint64_t seed() const { return common_.seed.value_or(1); }
  [[nodiscard]] virtual const CaseFile& file() const = 0;
  /// The key of the requested options in /wheeltap of a summary.
  [[nodiscard]] virtual const char* options_key() const { return "options"; }

  /// Returns the estimated memory and time of the run. If the cost is known only after prepare(),
  /// the result is std::nullopt, and the function must be called again after prepare(). Throws
  /// Failure (65) if the cost exceeds the limits in common().
  virtual std::optional<RunCost> estimate() = 0;
  /// Passes the cost to the callback CommonOptions::dry_run. `cost` is the result of estimate().
  virtual void dry_run(const std::optional<RunCost>& cost, RunWatch& watch);
  /// Trains or opens the predictor of the case. Throws Failure, io::FileError, OutsideModelError.
  virtual void prepare(RunWatch& /*watch*/) {}
  /// Prints the results of the preparation.
  virtual void print_preparation() const {}
  /// Samples the posterior and diagnoses convergence. Returns std::nullopt on ranks other than the
  /// first. Propagates every exception that `watch` throws.
  virtual std::optional<FinishedRun> sample(RunWatch& watch) = 0;

  /// Returns the case's predictor, likelihood and posterior, after prepare(). Throws Failure.
  virtual std::vector<ServedModel> served() = 0;

 private:
  CommonOptions common_;
  SamplingOptions options_;
};

[[nodiscard]] std::unique_ptr<CaseRun> make_damage_run(CaseFile file, const CommonOptions& common,
                                                       const SamplingOptions& options);
[[nodiscard]] std::unique_ptr<CaseRun> make_update_run(CaseFile file, const CommonOptions& common,
                                                       const SamplingOptions& options);

/// Checks the options and returns the case that the command line names. Throws Failure.
[[nodiscard]] CaseFile case_to_sample(const CommonOptions& common, const SamplingOptions& options);

/// Runs the case, writes summary.json, posterior.nc and the report into the output folder, and
/// prints the findings. With --dry-run, the function only estimates the cost. With --resume, if the
/// folder has a finished run of the same case and options, the function only prints the stored
/// text. Throws Failure, io::FileError.
void run_case(CaseRun& run);

}  // namespace wheeltap::apps
