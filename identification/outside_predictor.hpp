// A model of someone else's, with what stands in front of it.
#pragma once

#include <algorithm>

#include "identification/outside_emulator.hpp"

namespace wheeltap::identification {

struct OutsidePredictor {
  std::shared_ptr<OutsideModel> model;
  std::shared_ptr<const OutsideEmulator> emulator = {};  ///< none: the model itself predicts

  /// All responses and the variances of their errors. False, and no responses, beyond an emulator's
  /// box, which cuts priors off: searches go there far too often to ask the model itself. Throws
  /// OutsideModelError.
  bool predict(std::span<const double> x, std::span<double> out, std::span<double> variance) const {
    std::ranges::fill(variance, 0.0);
    if (emulator && !emulator->contains(x)) return false;
    if (emulator) {
      emulator->evaluate(x, out, variance);
    } else {
      model->evaluate(x, out);
    }
    return true;
  }
};

}  // namespace wheeltap::identification
