// A structure that is given by stiffness and mass matrices from another program.
#pragma once

#include <string>
#include <vector>

#include "fem/structures/discretisation.hpp"

namespace wheeltap::fem {

/// The matrices M and K = Σ (1 + α_j) K_j. M and all K_j are symmetric and have the same size. M is
/// positive semidefinite. The displacements of degrees of freedom without mass follow statically
/// from those of the other degrees of freedom.
struct MatrixStructure {
  using Sparse = Discretisation::Sparse;
  struct Part {
    std::string name;
    Sparse stiffness;
    double change = 0.0;  ///< α
  };
  Sparse mass;
  std::vector<Part> parts;
  std::vector<DofName> names = {};  ///< names of the degrees of freedom; empty: "degree of freedom
                                    ///< 1" …
};

/// Checks the matrices. Throws InvalidStructure (part `masses` for M, `members` for K_j) if a
/// matrix is not square, differs in size from the others, is not finite, or is not symmetric within
/// 1e-8 of its largest entry. Also throws InvalidStructure if α <= -1, and if M is not positive
/// semidefinite (rounding of the entries to six digits is tolerated).
void validate(const MatrixStructure& structure);

/// Discretises the structure: K_rest is K, and `parts` holds the summands of K. This function does
/// not search for rigid-body motions; `structure_modes` reports a structure that can move without
/// resistance as a mechanism. Throws the exceptions of `validate`, but checks only the diagonal and
/// the 2 × 2 principal minors of M.
[[nodiscard]] Discretisation discretise(const MatrixStructure& structure);

}  // namespace wheeltap::fem
