// Reflections: the move that structures need which are their own mirror images.
#pragma once

#include "inference/moves/image.hpp"

namespace wheeltap::inference {

/// The image under one symmetry, which reflects a parameter of some kinds' components in a centre:
/// x → 2 c - x, its own inverse.
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
