// MCMC moves to the images of a state under a symmetry, for symmetric structures.
#pragma once

#include <functional>

#include "inference/moves/move.hpp"

namespace wheeltap::inference {

/// A map of parameters under which the likelihood is (nearly) invariant. The map acts on one
/// parameter of each component of some kinds, x → image(x) with |d image/dx| = 1. image(x) is NaN
/// if x has no image.
struct Symmetry {
  struct Part {
    int kind = 0;       ///< index into ModelSpace::kinds()
    int parameter = 0;  ///< index into ComponentKind::parameters
    std::function<double(double)> image;
  };
  std::vector<Part> parts;
};

/// Chooses one symmetry uniformly. If `whole` is true, the symmetry is applied to all components on
/// which it acts (the image of the state). If `whole` is false, the symmetry is applied to one of
/// these components, chosen uniformly. The list must contain the inverse of each symmetry, so that
/// the reverse move has the same probability. In the coordinates z, the ratio is the absolute
/// Jacobian determinant of the map:
///
///   ln ratio = Σ ln |dz'/dz| = Σ [ ln p(x') - ln φ(z') - ln p(x) + ln φ(z) ]
///
/// The sum is over the moved coordinates, and |dz/dx| = p(x) / φ(z). No proposal is made if the
/// image is outside the prior's support.
class Image : public Move {
 public:
  Image(std::vector<Symmetry> symmetries, bool whole)
      : symmetries_(std::move(symmetries)), whole_(whole) {}
  std::optional<double> propose(const State& from, const Step& step, State& to) override;

 private:
  std::vector<Symmetry> symmetries_;
  bool whole_;
};

}  // namespace wheeltap::inference
