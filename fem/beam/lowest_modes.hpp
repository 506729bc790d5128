// The lowest modes of K φ = λ M φ, refined and verified in 106 bits.
#pragma once

#include <optional>
#include <vector>

#include "fem/beam/wide_pencil.hpp"

namespace wheeltap::fem {

/// Proven relative error of an eigenvalue, from counts on both sides (`WidePencil::holds`).
inline constexpr double kProven = 1e-12;

/// Mass-normalised modes in the free degrees of freedom, rigid-body ones first, then ascending.
struct LowestModes {
  std::vector<DoubleDouble> eigenvalues;  ///< exactly 0 for rigid-body modes
  std::vector<WidePencil::Vector> modes;
  bool proven =
      false;  ///< true if Sturm counts place every eigenvalue i at `eigenvalues[i]` ± kProven
};

/// Refines approximate modes by Rayleigh quotient iteration in 106 bits. `start` holds as many
/// modes as wanted, in the free degrees of freedom and in any order; rigid-body modes need not be
/// accurate. Returns std::nullopt if an iteration does not converge, or if two iterations converge
/// to the same mode.
[[nodiscard]] std::optional<LowestModes> finish(WidePencil& pencil,
                                                std::vector<WidePencil::Vector> starts);

/// Finds the modes without initial approximations. Sturm counts isolate each eigenvalue in long
/// double, or in 106 bits if long double is not accurate enough (Parlett 1998, The Symmetric
/// Eigenvalue Problem, ch. 3, 4). Throws std::runtime_error if an iteration does not converge.
[[nodiscard]] LowestModes lowest_modes(const Beam& beam, const Defects& defects, int count,
                                       WidePencil& pencil);

}  // namespace wheeltap::fem
