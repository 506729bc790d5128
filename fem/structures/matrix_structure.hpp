// A structure given by the matrices of another program.
#pragma once

#include <string>
#include <vector>

#include "fem/structures/discretisation.hpp"

namespace wheeltap::fem {

/// M and K = Σ (1 + α_j) K_j, all symmetric and of the same size. M is positive semidefinite;
/// degrees of freedom without mass follow from the others by statics.
struct MatrixStructure {
  using Sparse = Discretisation::Sparse;
  struct Part {
    std::string name;
    Sparse stiffness;
    double change = 0.0;  ///< α
  };
  Sparse mass;
  std::vector<Part> parts;
  std::vector<DofName> names = {};  ///< empty: "degree of freedom 1" …
};

/// Throws InvalidStructure (`masses` for M, `members` for K_j) if a matrix is not square, differs
/// in size, is not symmetric (to 1e-8 of its largest entry) or not finite, or if α <= -1.
void validate(const MatrixStructure& structure);

/// Discretises the structure: K_rest is K, and its parts are the summands of K. Does not search for
/// rigid-body motions; `structure_modes` reports a structure that can move without resistance as a
/// mechanism. Throws the exceptions of `validate`.
[[nodiscard]] Discretisation discretise(const MatrixStructure& structure);

}  // namespace wheeltap::fem
