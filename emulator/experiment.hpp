// Evaluation of a model at all points of a design, on several threads and ranks (base/ranks.hpp).
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>

#include "emulator/design.hpp"

namespace wheeltap::emulator {

/// A model: a function that computes all responses at one point.
using Model = std::function<void(std::span<const double> point, std::span<double> response)>;
/// A function that creates the model of one thread, so that each thread has its own workspace.
/// run_experiment calls this function at most once per thread.
using ModelFactory = std::function<Model()>;

struct ExperimentOptions {
  int threads = 1;  ///< >= 1
  /// Journal: a file of finished model runs (empty: no journal). Runs in an existing file are
  /// reused. After the last run, the file remains; the caller removes it after storing the result.
  std::filesystem::path journal = {};
  /// Text, e.g. the case. In the journal, this text and the design identify the experiment.
  std::string identity = {};
  /// Callback, called after each run with the number of finished runs and the number of all runs.
  /// Calls are serialised. Runs of other ranks are counted after every 5 % of the design.
  std::function<void(Eigen::Index done, Eigen::Index total)> progress = {};
};

/// The error for a failed run: the model threw an exception, or returned a number that is not
/// finite.
class RunError : public std::runtime_error {
 public:
  RunError(Eigen::Index run, const std::string& what) : std::runtime_error(what), run_(run) {}
  [[nodiscard]] Eigen::Index run() const { return run_; }  ///< row of the design, from 0

 private:
  Eigen::Index run_;
};

/// Computes the responses at every point of the design: runs × responses. The result does not
/// depend on the number of threads or ranks. Every rank must call this function with the same
/// arguments; rank 0 writes the journal. Throws std::invalid_argument for an empty design, zero
/// responses or threads < 1. Throws RunError if a run fails; the error names the first failed run
/// of the design and its point, and the exception of the model is nested in the error.
[[nodiscard]] RowMatrix run_experiment(const Design& design, Eigen::Index responses,
                                       const ModelFactory& factory,
                                       const ExperimentOptions& options = {});

/// Returns a part of a design, to divide the work between machines. The part contains every run i
/// with i mod `parts` = `part`. Example: with 3 parts, part 1 contains the runs 1, 4, 7, … (all
/// indices start at 0). Throws std::invalid_argument unless 0 <= part < parts, and for a part
/// without runs.
[[nodiscard]] Design shard(const Design& design, Eigen::Index part, Eigen::Index parts);

}  // namespace wheeltap::emulator
