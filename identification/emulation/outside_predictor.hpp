// An external model and, optionally, its emulator.
#pragma once

#include <algorithm>

#include "identification/emulation/outside_emulator.hpp"

namespace wheeltap::identification {

struct OutsidePredictor {
  std::shared_ptr<OutsideModel> model;
  /// Emulator of the model; if empty, predictions come from the model itself
  std::shared_ptr<const OutsideEmulator> emulator = {};

  /// Computes all responses and their error variances. Inside the emulator's box, the emulator
  /// predicts; outside the box, the model itself predicts, with zero variance. Likelihoods do not
  /// call this function outside the box. Throws OutsideModelError.
  void predict(std::span<const double> x, std::span<double> out, std::span<double> variance) const {
    if (emulator && emulator->contains(x)) return emulator->evaluate(x, out, variance);
    model->evaluate(x, out);
    std::ranges::fill(variance, 0.0);
  }
};

}  // namespace wheeltap::identification
