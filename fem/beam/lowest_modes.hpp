// The lowest modes of K φ = λ M φ, finished and confirmed in 106 bits.
#pragma once

#include <optional>
#include <vector>

#include "fem/beam/wide_pencil.hpp"

namespace wheeltap::fem {

/// What is proven of an eigenvalue, relative, by counts on both sides (`WidePencil::holds`).
inline constexpr double kProven = 1e-12;

/// Mass-normalised modes in the free degrees of freedom, rigid-body ones first, then ascending.
struct LowestModes {
  std::vector<DoubleDouble> eigenvalues;  ///< exactly 0 for rigid-body modes
  std::vector<WidePencil::Vector> modes;
  bool proven = false;  ///< Sturm counts put each eigenvalue number i at `eigenvalues[i]` ± kProven
};

/// Rayleigh quotient iteration in 106 bits from approximate modes in the free degrees of freedom,
/// in any order, as many as wanted; rigid-body modes need not be good. Nothing where an iteration
/// does not end or two end at the same mode.
[[nodiscard]] std::optional<LowestModes> finish(WidePencil& pencil,
                                                std::vector<WidePencil::Vector> starts);

/// Without a start: Sturm counts isolate each eigenvalue, in long double and where that does not do
/// in 106 bits (Parlett 1998, The Symmetric Eigenvalue Problem, ch. 3, 4). Throws
/// std::runtime_error should an iteration not end.
[[nodiscard]] LowestModes lowest_modes(const Beam& beam, const Defects& defects, int count,
                                       WidePencil& pencil);

}  // namespace wheeltap::fem
