// Running a model over a design, on several threads, and ranks where there are any
// (base/ranks.hpp).
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>

#include "emulator/design.hpp"

namespace wheeltap::emulator {

/// Computes all responses at one point.
using Model = std::function<void(std::span<const double> point, std::span<double> response)>;
/// Makes a model for one thread at a time, so that each keeps its own workspace: at most as many as
/// there are threads.
using ModelFactory = std::function<Model()>;

struct ExperimentOptions {
  int threads = 1;  ///< >= 1
  /// Where finished runs are remembered (empty: nowhere). When the file exists already, its runs
  /// are taken from it and not repeated; it stays after the last run, for the caller to remove once
  /// the result is safe.
  std::filesystem::path journal = {};
  /// What the journal's runs belong to, beside the design itself, e.g. the case as text.
  std::string identity = {};
  /// Called after each run with (runs done, runs in all), one call at a time, from any thread; of
  /// runs of other ranks once a twentieth of the design is done.
  std::function<void(Eigen::Index done, Eigen::Index total)> progress = {};
};

/// A run that failed: the model threw, or answered with a number that is not finite.
class RunError : public std::runtime_error {
 public:
  RunError(Eigen::Index run, const std::string& what) : std::runtime_error(what), run_(run) {}
  [[nodiscard]] Eigen::Index run() const { return run_; }  ///< 0-based row of the design

 private:
  Eigen::Index run_;
};

/// Responses at every point of the design: runs × responses. The result does not depend on the
/// number of threads or ranks; every rank must ask for the same, and rank 0 keeps the journal.
/// Throws std::invalid_argument for an empty design, no responses or threads < 1; RunError naming
/// the run and its point when runs fail (the first of them in the order of the design, with the
/// model's exception nested in it).
[[nodiscard]] RowMatrix run_experiment(const Design& design, Eigen::Index responses,
                                       const ModelFactory& factory,
                                       const ExperimentOptions& options = {});

/// Part `part` of `parts` (0-based) of a design: its runs part, part + parts, part + 2 parts, …, so
/// that several machines may share the work. Throws std::invalid_argument unless 0 <= part < parts
/// and the part has a run.
[[nodiscard]] Design shard(const Design& design, Eigen::Index part, Eigen::Index parts);

}  // namespace wheeltap::emulator
