// Mechanisms: motions without resistance that are not rigid-body motions of the structure.
//
// Mechanisms and rigid-body motions together span the null space of K. Subspace iteration with
//
// (K + ε D) v ← D v, D = diag K (1 for zero entries), ε = 1e-11,
//
// finds motions with a stiffness below about ε. A Rayleigh-Ritz step then separates motions of zero
// stiffness from those of small stiffness. This step uses the strain energies, which are sums of
// squares without cancellation.
#pragma once

#include <string>
#include <vector>

#include "fem/structures/discretisation.hpp"

namespace wheeltap::fem {

/// Computes a basis of the motions of the mechanisms. The largest entry of each motion is 1. Each
/// motion also has an entry of 1 at a degree of freedom at which all other motions of the basis are
/// 0. The list is empty if K resists all motions except rigid-body motions.
[[nodiscard]] std::vector<Eigen::VectorXd> mechanisms(const Discretisation& d);

/// Returns the limit for strain-free motions: a motion is strain-free if the ratio of `energy` to
/// `uncancelled_energy` is at most this limit. The limit is larger if K is given as a matrix,
/// because the entries of this matrix have rounding errors.
[[nodiscard]] double no_strain(const Discretisation& d);

/// Names the degrees of freedom with the largest displacement: "n2, y", "B, x and C, x".
/// Translations precede rotations, and nodes precede locations within members.
[[nodiscard]] std::string motion_in_words(const Discretisation& d, const Eigen::VectorXd& motion);

/// Throws InvalidStructure if the structure has mechanisms; the message states where their motions
/// are largest, and a remedy.
void refuse_mechanisms(const Discretisation& d);

}  // namespace wheeltap::fem
