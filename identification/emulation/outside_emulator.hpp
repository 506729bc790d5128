// An emulator of a model of someone else's, over the box of its unknowns.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "emulator/gaussian_process.hpp"
#include "identification/emulation/emulator_error.hpp"
#include "identification/emulation/outside_model.hpp"
#include "inference/model/model_space.hpp"

namespace wheeltap::identification {

/// What a case says of it.
struct OutsideEmulatorSpec {
  int runs = 0;        ///< of the model, to train on; 0: 20 an unknown, 40 at least
  int holdout = 0;     ///< fresh ones that measure the error; 0: a quarter of those, 10 at least
  bool sobol = false;  ///< Sobol's points in place of a Latin hypercube's
  bool emulator_error = true;  ///< add its measured error to the noise
  std::uint64_t seed = 1;      ///< of both designs

  [[nodiscard]] int runs_for(int unknowns) const;
  [[nodiscard]] int holdout_for(int unknowns) const;
};

/// A Gaussian process for each response. The box has the ends of a prior's support or, where it
/// has none, its quantiles at z = ±4; an unknown that is positive over more than a decade is taken
/// by its logarithm. The variance of its error is the process's own times a factor >= 1 that makes
/// it honest on the fresh runs (emulator_error.hpp).
class OutsideEmulator {
 public:
  /// Runs the model at both designs, on `threads` threads. Throws OutsideModelError, and
  /// std::invalid_argument where a prior has no width.
  OutsideEmulator(OutsideModel& model, const std::vector<inference::Parameter>& unknowns,
                  const OutsideEmulatorSpec& spec, int threads,
                  const std::function<void(double)>& progress = {});

  [[nodiscard]] bool contains(std::span<const double> x) const { return process_->contains(x); }
  /// All responses and the variances of their errors (0 where the case switches them off), at an x
  /// in the box.
  void evaluate(std::span<const double> x, std::span<double> out, std::span<double> variance) const;

  [[nodiscard]] const EmulatorError& error() const { return error_; }
  [[nodiscard]] const std::vector<emulator::Factor>& box() const { return process_->factors(); }
  [[nodiscard]] int runs() const { return runs_; }
  [[nodiscard]] int fresh_runs() const { return fresh_; }

 private:
  OutsideEmulatorSpec spec_;
  int runs_ = 0, fresh_ = 0;
  std::unique_ptr<const emulator::GaussianProcess> process_;
  EmulatorError error_;
};

}  // namespace wheeltap::identification
