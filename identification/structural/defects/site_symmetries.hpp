// Symmetries of a structure, applied to the locations of defects.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "fem/structures/self_maps.hpp"
#include "identification/structural/defects/placed_defect.hpp"
#include "identification/structural/structure_model.hpp"
#include "inference/moves/image.hpp"

namespace wheeltap::identification {

/// Symmetries: maps of the structure onto itself. If a map is applied to the locations of any set
/// of defects, all frequencies remain the same. Frequencies therefore cannot distinguish a location
/// from its image under these maps.
struct SiteSymmetries {
  /// Maps of the location (parameter 0) along the line of each kind of defect, and the inverse maps
  std::vector<inference::Symmetry> maps;
  /// Groups of sites (members, nodes, links) that are each other's images, in the case's order.
  std::vector<std::vector<std::string>> alike;
  /// Members whose ends a symmetry exchanges: location s is the image of L - s (L: length).
  std::vector<std::string> turned;

  [[nodiscard]] bool empty() const { return maps.empty(); }
};

/// Computes the frequencies [Hz] of the damaged structure; empty if the structure is impossible.
using SolveDefects = std::function<std::vector<double>(const std::vector<PlacedDefect>&)>;

/// Tests all geometric self-maps (fem::self_maps) that leave the possible locations of every kind
/// of defect, and their prior weights, unchanged. Keeps the maps that preserve the frequencies
/// within a relative error of 1e-9 (1e-6 if a kind of defect removes mass). Tests one defect at
/// each site of each line in turn, then defects at all sites together. Locations and severities are
/// drawn from the priors with a fixed seed.
[[nodiscard]] SiteSymmetries find_symmetries(const AnyStructure& structure,
                                             const std::vector<DefectKind>& kinds,
                                             const SolveDefects& solve);

}  // namespace wheeltap::identification
