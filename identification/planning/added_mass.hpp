// A structure with an added mass.
#pragma once

#include "identification/structural/structure_model.hpp"

namespace wheeltap::identification::planning {

/// Returns the structure with `mass` [kg] added at a node (members) or to a mass (chain of masses).
/// The index `node` begins at 0. Throws std::invalid_argument for a structure given by matrices,
/// and for a node that does not exist.
[[nodiscard]] AnyStructure with_mass_at_node(const AnyStructure& structure, int node, double mass);

/// Returns a beam's structure (fem::as_structure) with `mass` [kg] added at the element boundary
/// closest to x [m]. The member is divided at this boundary; locations along the beam do not
/// change. Throws std::invalid_argument for x outside the beam.
[[nodiscard]] AnyStructure with_mass_on_beam(const fem::Structure& beam, double x, double mass);

}  // namespace wheeltap::identification::planning
