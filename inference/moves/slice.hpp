// Slice sampling along a random direction.
#pragma once

#include "inference/moves/move.hpp"

namespace wheeltap::inference {

/// Method of Neal (2003, Annals of Statistics 31:705, section 4 and figures 3 and 5). y is drawn
/// uniformly below the target density at z. An interval about z along a random direction is
/// extended until both ends lie outside the slice { π > y }. The interval is then shortened towards
/// z until a random point in it lies inside the slice. The direction is independent of the state,
/// so each step is a valid univariate update. The update never rejects a proposal, but needs
/// several likelihood evaluations.
class Slice : public Kernel {
 public:
  /// `width` is the typical length of the first interval in standard normal coordinates. The result
  /// depends little on `width`.
  explicit Slice(double width) : Kernel("slice"), width_(width) {}
  Outcome step(State& state, const Step& step) override;

 private:
  double width_;
  std::vector<double> direction_;
  State trial_;
};

}  // namespace wheeltap::inference
