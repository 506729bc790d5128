#include "identification/structural/drawn_modes.hpp"

#include <algorithm>

#include "fem/structures/modes/structure_modes.hpp"

namespace wheeltap::identification {

std::optional<DrawnModes> drawn_modes(const AnyStructure& structure, int modes) {
  constexpr std::size_t kMostPoints = 3000;
  constexpr int kMostModes = 12;
  fem::DrawnStructure whole = drawn(structure);
  if (whole.drawing.points.empty() || whole.drawing.points.size() > kMostPoints) return {};
  const auto rigid = static_cast<int>(whole.discretisation.rigid_motions.cols());
  const int there = static_cast<int>(fem::mode_count(whole.discretisation));
  const fem::StructureModes found = fem::structure_modes(
      whole.discretisation, std::min(there, rigid + std::min(kMostModes, modes)));
  DrawnModes out{.drawing = std::move(whole.drawing), .frequencies_hz = {}, .motions = {}};
  for (Eigen::Index j = rigid; j < found.shapes.cols(); ++j) {
    out.frequencies_hz.push_back(found.frequencies_hz[j]);
    out.motions.push_back(fem::point_motions(out.drawing, found.shapes.col(j)));
  }
  return out;
}

}  // namespace wheeltap::identification
