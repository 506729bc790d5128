// Geometric symmetries of a structure: candidates for symmetries of its dynamics.
#pragma once

#include <vector>

#include "fem/structures/lumped_chain.hpp"
#include "fem/structures/structure.hpp"

namespace wheeltap::fem {

/// An isometry (in two or three dimensions) that maps nodes to nodes and members to members: a
/// symmetry of the geometry. Natural frequencies show whether stiffness and mass are symmetric.
struct SelfMap {
  std::vector<int> node;       ///< image of node i
  std::vector<int> member;     ///< image of member i; for a chain, of link i
  std::vector<bool> reversed;  ///< true if the map exchanges the ends of member i
};

/// Finds all self-maps of a structure except the identity; the list contains the inverse of each
/// map. The search compares distances from the centroid of the nodes and from one to three
/// reference nodes, within a tolerance of 1e-6 times the structure's size. The list is empty if the
/// structure has more than `kMostMappedNodes` nodes (no search) or more than `kMostSelfMaps` maps.
[[nodiscard]] std::vector<SelfMap> self_maps(const Structure& structure);
/// Returns the reversal of the order of the masses of a chain, if the reversal maps links to
/// links.
[[nodiscard]] std::vector<SelfMap> self_maps(const LumpedChain& chain);

inline constexpr int kMostMappedNodes = 500;
inline constexpr int kMostSelfMaps = 48;

}  // namespace wheeltap::fem
