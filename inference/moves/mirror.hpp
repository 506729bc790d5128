// Reflections, for mirror-symmetric structures.
#pragma once

#include "inference/moves/image.hpp"

namespace wheeltap::inference {

/// MCMC move to the image of a state under a reflection x → 2 c - x about a centre c. A reflection
/// acts on one parameter of one kind of component, and it is its own inverse.
class Mirror : public Image {
 public:
  Mirror(const std::vector<Reflection>& reflections, bool whole)
      : Image({symmetry(reflections)}, whole) {}

 private:
  static Symmetry symmetry(const std::vector<Reflection>& reflections) {
    Symmetry out;
    for (const Reflection& r : reflections)
      out.parts.push_back(
          {r.kind, r.parameter, [twice = 2.0 * r.center](double x) { return twice - x; }});
    return out;
  }
};

}  // namespace wheeltap::inference
