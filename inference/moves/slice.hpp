// Slice sampling along a random direction.
#pragma once

#include "inference/moves/move.hpp"

namespace wheeltap::inference {

/// Neal (2003, Annals of Statistics 31:705, section 4 and figures 3 and 5). With y uniform below
/// the target density at z, steps out from z along a direction of random length until both ends lie
/// outside the slice { ln π > y }, then shrinks towards z until a point lies inside. The direction
/// is independent of the state, so each step is a valid univariate update. It never rejects, at a
/// cost of several likelihood calls.
class Slice : public Kernel {
 public:
  /// `width` [standard normal coordinates] is the typical first interval; the result depends little
  /// on it.
  explicit Slice(double width) : Kernel("slice"), width_(width) {}
  Outcome step(State& state, const Step& step) override;

 private:
  double width_;
  std::vector<double> direction_;
  State trial_;
};

}  // namespace wheeltap::inference
