// A small beam for several tests.
#pragma once

#include "fem/sections/section.hpp"
#include "identification/structural/damage/damage_problem.hpp"
#include "identification/structural/defects/reduction.hpp"

namespace wheeltap::identification {

/// A cantilever of 20 elements with up to `most` damages, of which `truth` exist: four modes
/// without noise, with a stated noise of 1 %.
inline DamageCase small_beam(int most, const fem::Defects& truth = {}) {
  DamageCase out;
  out.beam = {.length = 1.0,
              .elements = 20,
              .supports = fem::named_supports("cantilever", 1.0),
              .material = {.young = 70e9, .poisson = 0.3, .density = 2700.0},
              .section = fem::section(fem::Rectangle{.width = 0.025, .height = 0.006}, 0.3)};
  out.data.frequencies_hz = elastic_frequencies(out.beam, truth, 4);
  for (const double f : out.data.frequencies_hz) out.data.sd_hz.push_back(0.01 * f);
  out.kinds.push_back({.type = &defects::kReduction,
                       .name = "damage",
                       .plural = "damages",
                       .max_count = most,
                       .weights = {},
                       .location = inference::Uniform{0.0, 1.0},
                       .severity = inference::Prior(inference::Uniform{0.0, 0.9}),
                       .truth = {}});
  return out;
}

}  // namespace wheeltap::identification
