// Images under the symmetries of a structure: the moves that symmetric structures need.
#pragma once

#include <functional>

#include "inference/moves/move.hpp"

namespace wheeltap::inference {

/// A map of parameters under which the likelihood is (nearly) unchanged: of one parameter each of
/// some kinds' components, x → image(x) with |d image/dx| = 1. NaN where x has no image.
struct Symmetry {
  struct Part {
    int kind = 0;       ///< index into ModelSpace::kinds()
    int parameter = 0;  ///< index into ComponentKind::parameters
    std::function<double(double)> image;
  };
  std::vector<Part> parts;
};

/// Chooses one of the symmetries uniformly and applies it to every component that has a part in it
/// (`whole`: the image of the state), or to one component chosen uniformly. With each symmetry its
/// inverse must be among them, so that there is a way back of the same probability; with respect to
/// dz then
///
///   ln ratio = Σ ln |dz'/dz| = Σ [ ln p(x') - ln φ(z') - ln p(x) + ln φ(z) ]
///
/// over the moved coordinates, from |dz/dx| = p(x) / φ(z). An image outside the prior's support is
/// no proposal.
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
