// A random structure, its possible defects, and a truth drawn from their prior: posteriors over
// such cases are calibrated exactly (Talts et al. 2018, equation 1).
#pragma once

#include <cstdint>
#include <string>

#include "identification/structural/damage/damage_case.hpp"

namespace wheeltap::coverage {

struct RandomCase {
  std::uint64_t seed = 0;
  int number = 0;
  std::string family = {};  ///< "cantilever", "frame 2x3"
  double cv = 0.0;          ///< sd of a frequency over that of the intact structure
  identification::DamageCase damage_case = {};
};

/// Case `number` of the study `seed`. A simply supported, clamped-free or two-span beam, a plane
/// frame of 1 to 3 bays and storeys with rigid or semi-rigid joints, a space portal, or a building
/// of 3 to 8 storeys that shear. At most 1, 2 or 3 defects of as many kinds or fewer: element
/// reductions, cracks, loose joints, added masses, soft storeys. The counts are drawn from their
/// prior, places from the line and severities from their priors, and
///
///   f_obs,i = f_i + cv f_intact,i ε_i,   ε_i ~ N(0, 1),   cv ~ log U(0.0005, 0.01),
///
/// 8 to 15 of them (of a building as many as it has). The noise is a share of the intact
/// frequencies, not of the true ones, whose knowledge would be knowledge of the truth.
[[nodiscard]] RandomCase random_case(std::uint64_t seed, int number);

}  // namespace wheeltap::coverage
