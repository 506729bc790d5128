// The lowest mode shapes of a structure as displacements of its points and lines.
#pragma once

#include <optional>
#include <vector>

#include "identification/structural/structure_model.hpp"

namespace wheeltap::identification {

struct DrawnModes {
  fem::StructureDrawing drawing;
  std::vector<double> frequencies_hz;              ///< frequencies of the elastic modes
  std::vector<std::vector<fem::Vector3>> motions;  ///< per mode and point; largest displacement: 1
};

/// Computes `modes` modes, but at most 12. The result is empty for a structure without coordinates
/// or with more than 3000 points. Throws fem::InvalidStructure.
[[nodiscard]] std::optional<DrawnModes> drawn_modes(const AnyStructure& structure, int modes);

}  // namespace wheeltap::identification
