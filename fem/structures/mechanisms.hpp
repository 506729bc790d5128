// Mechanisms: motions that nothing resists and that are no rigid-body motions of the structure.
//
// They are the null space of K beyond the rigid motions. Subspace iteration on
//
//   (K + ε D) v ← D v,   D = diag K (1 where that is 0),   ε = 1e-11,
//
// brings what K resists by less than about ε to the front. A Rayleigh-Ritz step on the energies of
// the strains, which are sums of squares and do not cancel, then tells no stiffness from little.
#pragma once

#include <string>
#include <vector>

#include "fem/structures/discretisation.hpp"

namespace wheeltap::fem {

/// A basis of the mechanisms' motions, each scaled to a largest entry of 1: of k motions each has
/// an entry of 1 where the others are 0. Empty: every motion but the rigid ones is resisted.
[[nodiscard]] std::vector<Eigen::VectorXd> mechanisms(const Discretisation& d);

/// Energy of a motion over what it would be had no strain cancelled: at most this, of a motion that
/// strains nothing. Of a K that is given as a matrix the energy itself is rounded.
[[nodiscard]] double no_strain(const Discretisation& d);

/// Where a motion is largest: "n2, y", "B, x and C, x". Translations go before rotations, nodes
/// before places within members.
[[nodiscard]] std::string motion_in_words(const Discretisation& d, const Eigen::VectorXd& motion);

/// Throws InvalidStructure, naming the motions and what to do, where there are mechanisms.
void refuse_mechanisms(const Discretisation& d);

}  // namespace wheeltap::fem
