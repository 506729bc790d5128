// What a case says of its structure that can hardly be meant: a Young's modulus in GPa, nodes that
// nothing joins, members that cross without a joint. Needs no data.
#pragma once

#include <optional>
#include <vector>

#include "fem/beam/beam.hpp"
#include "identification/findings/remarks.hpp"
#include "identification/structural/modal_data.hpp"
#include "identification/structural/structure_model.hpp"

namespace wheeltap::identification {

/// Young's modulus outside 5e8 to 1.3e12 Pa, density outside 20 to 25 000 kg/m³ (0 is massless), or
/// a speed of sound √(E/ρ) above 20 000 m/s, which no material has. A massless material of a larger
/// modulus stands for a rigid link.
[[nodiscard]] std::optional<remark::ImplausibleMaterial> implausible_material(
    const std::string& of, std::optional<double> young, std::optional<double> density);

/// The material, and a section higher than the beam is long.
[[nodiscard]] std::vector<Remark> implausible(const fem::Beam& beam);

/// Of members: materials, sections more than three times as high as their member is long, members
/// between the same nodes, nodes that neither a member nor a spring joins, members that cross or
/// touch another between its nodes. Nothing of chains and matrices.
[[nodiscard]] std::vector<Remark> implausible(const AnyStructure& structure);

/// Sensors of one place and direction, whose shapes say the same twice.
[[nodiscard]] std::vector<Remark> implausible(const std::vector<Sensor>& sensors);

}  // namespace wheeltap::identification
