// Beams for several tests.
#pragma once

#include <initializer_list>
#include <string_view>

#include "fem/beam/beam.hpp"
#include "fem/sections/section.hpp"

namespace wheeltap::fem {

inline constexpr std::string_view kNamedSupports[] = {
    "simply-supported", "cantilever", "clamped-clamped", "clamped-pinned", "free-free"};

/// The source's aluminium beam, 1 m × 25 mm × 6 mm.
inline Beam slender_beam(std::string_view supports = "simply-supported", int elements = 100) {
  return {.length = 1.0,
          .elements = elements,
          .supports = named_supports(supports, 1.0),
          .material = {.young = 70e9, .poisson = 0.3, .density = 2700.0},
          .section = section(Rectangle{.width = 0.025, .height = 0.006}, 0.3)};
}

/// A rectangle of height h on length 1 with κ = 5/6, as in published tables of thick beams.
inline Beam thick_beam(std::string_view supports, double height, int elements) {
  Beam beam = slender_beam(supports, elements);
  beam.section = {.area = 0.1 * height,
                  .second_moment = 0.1 * height * height * height / 12.0,
                  .shear_coefficient = 5.0 / 6.0};
  return beam;
}

}  // namespace wheeltap::fem
