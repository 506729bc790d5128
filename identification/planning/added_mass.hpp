// A structure with an added mass.
#pragma once

#include "identification/structural/structure_model.hpp"

namespace wheeltap::identification::planning {

/// With `mass` [kg] at a node (members), or on a mass (chain), from 0. Throws std::invalid_argument
/// for a structure of matrices, or a number that is not in the structure.
[[nodiscard]] AnyStructure with_mass_at_node(const AnyStructure& structure, int node, double mass);

/// The structure of a beam (fem::as_structure) with `mass` [kg] at the boundary of elements closest
/// to x [m]. The member there is divided; places along the beam stay the same. Throws
/// std::invalid_argument for x outside the beam.
[[nodiscard]] AnyStructure with_mass_on_beam(const fem::Structure& beam, double x, double mass);

}  // namespace wheeltap::identification::planning
