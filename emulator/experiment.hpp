// Running a model over a design, on several threads.
#pragma once

#include <functional>
#include <span>
#include <stdexcept>

#include "emulator/design.hpp"

namespace wheeltap::emulator {

/// Computes all responses at one point.
using Model = std::function<void(std::span<const double> point, std::span<double> response)>;
/// Makes one model a thread, so that each keeps its own workspace. Called from the thread itself.
using ModelFactory = std::function<Model()>;

struct ExperimentOptions {
  int threads = 1;  ///< >= 1
  /// Called after each run with (runs done, runs in all), one call at a time, from any thread.
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
/// number of threads.
/// Throws std::invalid_argument for an empty design, no responses or threads < 1; RunError naming
/// the run and its point when runs fail (the first of them in the order of the design, with the
/// model's exception nested in it).
[[nodiscard]] RowMatrix run_experiment(const Design& design, Eigen::Index responses,
                                       const ModelFactory& factory,
                                       const ExperimentOptions& options = {});

}  // namespace wheeltap::emulator
