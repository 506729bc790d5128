// Evaluation of a model over a design, on several threads and ranks (base/ranks.hpp).
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
/// Creates the model of one thread, so that each thread has its own workspace. Called at most once
/// per thread.
using ModelFactory = std::function<Model()>;

struct ExperimentOptions {
  int threads = 1;  ///< >= 1
  /// File of finished runs (empty: none). If the file exists, its runs are reused. The file remains
  /// after the last run; the caller removes it after it has stored the result.
  std::filesystem::path journal = {};
  /// Identity of the journal in addition to the design, e.g. the case as text.
  std::string identity = {};
  /// Called after each run with the numbers of finished runs and of all runs, by one thread at a
  /// time. Runs of other ranks are counted after each twentieth of the design.
  std::function<void(Eigen::Index done, Eigen::Index total)> progress = {};
};

/// A failed run: the model threw an exception, or returned a number that is not finite.
class RunError : public std::runtime_error {
 public:
  RunError(Eigen::Index run, const std::string& what) : std::runtime_error(what), run_(run) {}
  [[nodiscard]] Eigen::Index run() const { return run_; }  ///< 0-based row of the design

 private:
  Eigen::Index run_;
};

/// Responses at every point of the design: runs × responses. The result does not depend on the
/// number of threads or ranks. Every rank must call this with the same arguments; rank 0 keeps the
/// journal. Throws std::invalid_argument for an empty design, no responses or threads < 1;
/// RunError, naming the first failed run in the order of the design and its point, with the model's
/// exception nested in it.
[[nodiscard]] RowMatrix run_experiment(const Design& design, Eigen::Index responses,
                                       const ModelFactory& factory,
                                       const ExperimentOptions& options = {});

/// A part of a design, to divide the work between machines: the runs part, part + parts, part + 2
/// parts, … of part number `part` (from 0) out of `parts`. Throws std::invalid_argument unless 0 <=
/// part < parts and the part has a run.
[[nodiscard]] Design shard(const Design& design, Eigen::Index part, Eigen::Index parts);

}  // namespace wheeltap::emulator
