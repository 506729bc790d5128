// An emulator of an external model in a training domain: a box in the space of the unknowns.
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

/// The emulator section of a case with an external model.
struct OutsideEmulatorSpec {
  int runs = 0;        ///< training runs; 0: 20 per unknown, at least 40
  int holdout = 0;     ///< holdout runs that measure the error; 0: a quarter of `runs`, at least 10
  bool sobol = false;  ///< true: Sobol points; false: Latin hypercube
  bool emulator_error = true;  ///< add the measured emulator error to the noise
  std::uint64_t seed = 1;      ///< seed of the training design and of the holdout design

  [[nodiscard]] int runs_for(int unknowns) const;
  [[nodiscard]] int holdout_for(int unknowns) const;
};

/// One Gaussian process per response. The training domain is a box between the bounds of each prior
/// (for infinite bounds: the prior quantiles at z = ±4). A positive unknown with a range of more
/// than a decade is replaced by its logarithm. The error variance is the variance that the Gaussian
/// process predicts, times a factor >= 1. This factor is calibrated on the holdout runs
/// (emulator_error.hpp).
class OutsideEmulator {
 public:
  /// Runs the model on `threads` threads at the points of the training design and the holdout
  /// design. Throws OutsideModelError; throws std::invalid_argument if a prior has zero width.
  OutsideEmulator(OutsideModel& model, const std::vector<inference::Parameter>& unknowns,
                  const OutsideEmulatorSpec& spec, int threads,
                  const std::function<void(double)>& progress = {});

  [[nodiscard]] bool contains(std::span<const double> x) const { return process_->contains(x); }
  /// Computes all responses at x, a point in the box, and their error variances (0 if the case
  /// disables them).
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
