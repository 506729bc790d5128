// What a structure's symmetry means for where defects may be.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "fem/structures/self_maps.hpp"
#include "identification/structural/defects/placed_defect.hpp"
#include "identification/structural/structure_model.hpp"
#include "inference/moves/image.hpp"

namespace wheeltap::identification {

/// Maps of the structure onto itself under which all of its frequencies stay, whatever the defects:
/// what frequencies cannot tell apart.
struct SiteSymmetries {
  std::vector<inference::Symmetry> maps;  ///< of the kinds' lines, parameter 0; with their inverses
  /// Sites that are each other's images: of members, nodes, links, in the case's order.
  std::vector<std::vector<std::string>> alike;
  /// Members on which s is the image of L - s.
  std::vector<std::string> turned;

  [[nodiscard]] bool empty() const { return maps.empty(); }
};

/// Solves the damaged structure: its frequencies [Hz]. Empty where there is no such structure.
using SolveDefects = std::function<std::vector<double>(const std::vector<PlacedDefect>&)>;

/// Looks at every map of the shape (fem::self_maps) that takes every kind's line to itself with its
/// prior weights, and keeps those under which the frequencies agree to 1e-9 relative (1e-6 where
/// mass may be lost): with one defect on each stretch of each line in turn, and with one on all of
/// them at once. The places and severities are drawn from the priors with a fixed seed.
[[nodiscard]] SiteSymmetries find_symmetries(const AnyStructure& structure,
                                             const std::vector<DefectKind>& kinds,
                                             const SolveDefects& solve);

}  // namespace wheeltap::identification
