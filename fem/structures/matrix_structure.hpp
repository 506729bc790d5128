// A structure as another program's matrices.
#pragma once

#include <string>
#include <vector>

#include "fem/structures/discretisation.hpp"

namespace wheeltap::fem {

/// M and K = Σ (1 + α_j) K_j, all symmetric and of one size; M is positive semidefinite, and
/// degrees of freedom without mass follow the others statically.
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

/// Throws InvalidStructure (`masses` for M, `members` for K_j) where a matrix is not square, of
/// another size, not symmetric (to 1e-8 of its largest entry) or not finite, or α <= -1.
void validate(const MatrixStructure& structure);

/// K_rest is the whole of K, told apart into its parts. Rigid motions are not looked for: a
/// structure that moves without resistance is refused as a mechanism by `structure_modes`. Throws
/// as `validate`.
[[nodiscard]] Discretisation discretise(const MatrixStructure& structure);

}  // namespace wheeltap::fem
