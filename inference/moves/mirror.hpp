// Reflections, for mirror-symmetric structures.
#pragma once

#include "inference/moves/image.hpp"

namespace wheeltap::inference {

/// The image under a reflection x → 2 c - x about the centre c, of one parameter of some kinds'
/// components. The reflection is its own inverse.
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
