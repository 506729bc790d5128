// The lowest mode shapes of a structure as motions of its points and lines.
#pragma once

#include <optional>
#include <vector>

#include "identification/structural/structure_model.hpp"

namespace wheeltap::identification {

struct DrawnModes {
  fem::StructureDrawing drawing;
  std::vector<double> frequencies_hz;              ///< without rigid-body modes
  std::vector<std::vector<fem::Vector3>> motions;  ///< of each mode and point, the largest is 1
};

/// At most `modes` modes, and 12 of them. Nothing for a structure without places or with more than
/// 3000 points. Throws fem::InvalidStructure.
[[nodiscard]] std::optional<DrawnModes> drawn_modes(const AnyStructure& structure, int modes);

}  // namespace wheeltap::identification
