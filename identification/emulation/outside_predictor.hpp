// A model of someone else's, with what stands in front of it.
#pragma once

#include <algorithm>

#include "identification/emulation/outside_emulator.hpp"

namespace wheeltap::identification {

struct OutsidePredictor {
  std::shared_ptr<OutsideModel> model;
  std::shared_ptr<const OutsideEmulator> emulator = {};  ///< none: the model itself predicts

  /// All responses and the variances of their errors: by the emulator, or, where there is none and
  /// beyond its box (where likelihoods do not ask), by the model itself, exact. Throws
  /// OutsideModelError.
  void predict(std::span<const double> x, std::span<double> out, std::span<double> variance) const {
    if (emulator && emulator->contains(x)) return emulator->evaluate(x, out, variance);
    model->evaluate(x, out);
    std::ranges::fill(variance, 0.0);
  }
};

}  // namespace wheeltap::identification
