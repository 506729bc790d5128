// Mechanisms: motions without resistance that are not rigid-body motions of the structure.
//
// They are the null space of K beyond the rigid motions. Subspace iteration on
//
//   (K + ε D) v ← D v,   D = diag K (1 where that is 0),   ε = 1e-11,
//
// finds motions whose stiffness is below about ε. A Rayleigh-Ritz step then separates zero
// stiffness from small stiffness. It uses the strain energies, which are sums of squares without
// cancellation.
#pragma once

#include <string>
#include <vector>

#include "fem/structures/discretisation.hpp"

namespace wheeltap::fem {

/// A basis of the mechanisms' motions, each scaled to a largest entry of 1. Each of k motions has
/// an entry of 1 where the others are 0. Empty if K resists all motions except the rigid ones.
[[nodiscard]] std::vector<Eigen::VectorXd> mechanisms(const Discretisation& d);

/// The largest ratio of energy to energy without cancellation (`uncancelled_energy`) at which a
/// motion counts as strain-free. The limit is larger if K is given as a matrix, because its energy
/// has rounding errors of its own.
[[nodiscard]] double no_strain(const Discretisation& d);

/// The degrees of freedom with the largest motion, in words: "n2, y", "B, x and C, x". Translations
/// precede rotations, nodes precede places within members.
[[nodiscard]] std::string motion_in_words(const Discretisation& d, const Eigen::VectorXd& motion);

/// Throws InvalidStructure if there are mechanisms; the message names the motions and a remedy.
void refuse_mechanisms(const Discretisation& d);

}  // namespace wheeltap::fem
