// Plausibility checks of a structure without its data. The checks find, for example, a modulus in
// GPa, unconnected nodes, or members that cross without a joint.
#pragma once

#include <optional>
#include <vector>

#include "fem/beam/beam.hpp"
#include "identification/findings/remarks.hpp"
#include "identification/structural/modal_data.hpp"
#include "identification/structural/structure_model.hpp"

namespace wheeltap::identification {

/// Reports a Young's modulus outside 5e8 to 1.3e12 Pa, a density outside 20 to 25 000 kg/m³ (0 is
/// massless), or a speed of sound √(E/ρ) above 20 000 m/s, which no material reaches. A massless
/// material with a Young's modulus above this range counts as a rigid link.
[[nodiscard]] std::optional<remark::ImplausibleMaterial> implausible_material(
    const std::string& of, std::optional<double> young, std::optional<double> density);

/// Checks the material of a beam, and compares the section depth with the length.
[[nodiscard]] std::vector<Remark> implausible(const fem::Beam& beam);

/// Checks a structure of members: materials, section depths above three times the member's length,
/// duplicate members, unconnected nodes, and members that cross or touch other members between
/// their nodes. Chains and matrices are not checked.
[[nodiscard]] std::vector<Remark> implausible(const AnyStructure& structure);

/// Reports sensors with the same location and direction, whose shape entries are
/// redundant.
[[nodiscard]] std::vector<Remark> implausible(const std::vector<Sensor>& sensors);

}  // namespace wheeltap::identification
