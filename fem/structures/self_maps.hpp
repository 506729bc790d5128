// Maps of a structure's shape onto itself: candidates for its symmetries.
#pragma once

#include <vector>

#include "fem/structures/lumped_chain.hpp"
#include "fem/structures/structure.hpp"

namespace wheeltap::fem {

/// An isometry of the plane or of space that takes every node to a node and every member to a
/// member. It knows shapes only: whether stiffness and mass follow, its frequencies tell.
struct SelfMap {
  std::vector<int> node;       ///< where node i goes
  std::vector<int> member;     ///< where member i goes; of a chain, link i
  std::vector<bool> reversed;  ///< whether member i arrives with its ends exchanged
};

/// Every such map but the one that moves nothing; with each its inverse. Images are found by their
/// distances from the centroid of the nodes and from one to three reference nodes, equal to 1e-6 of
/// the structure's size. None beyond `kMostMappedNodes` nodes, where nobody has looked, and beyond
/// `kMostSelfMaps` maps.
[[nodiscard]] std::vector<SelfMap> self_maps(const Structure& structure);
/// The reversal of a chain's order, of masses and of links, where its links allow it.
[[nodiscard]] std::vector<SelfMap> self_maps(const LumpedChain& chain);

inline constexpr int kMostMappedNodes = 500;
inline constexpr int kMostSelfMaps = 48;

}  // namespace wheeltap::fem
