// Computation of the lowest modes of K φ = λ M φ, refined and verified in 106-bit arithmetic.
#pragma once

#include <optional>
#include <vector>

#include "fem/beam/wide_pencil.hpp"

namespace wheeltap::fem {

/// Proven bound of the relative error of an eigenvalue, from eigenvalue counts below and above it
/// (`WidePencil::holds`).
inline constexpr double kProven = 1e-12;

/// Mass-normalised modes in the free degrees of freedom: first the rigid-body modes, then elastic
/// modes by ascending eigenvalue.
struct LowestModes {
  std::vector<DoubleDouble> eigenvalues;  ///< exactly 0 for rigid-body modes
  std::vector<WidePencil::Vector> modes;
  bool proven = false;  ///< true if Sturm counts prove that eigenvalue i is `eigenvalues[i]` (1 ±
                        ///< kProven), for every i
};

/// Refines approximate modes by Rayleigh quotient iteration in 106-bit arithmetic. `starts` holds
/// one approximate mode for each requested mode, in the free degrees of freedom and in any order.
/// Rigid-body modes in `starts` need not be accurate. Returns std::nullopt if an iteration does not
/// converge, or if two iterations converge to the same mode.
[[nodiscard]] std::optional<LowestModes> finish(WidePencil& pencil,
                                                std::vector<WidePencil::Vector> starts);

/// Finds the modes without initial approximations. Sturm counts isolate each eigenvalue. The counts
/// use long double, or 106-bit arithmetic if long double is not accurate enough (Parlett 1998, The
/// Symmetric Eigenvalue Problem, ch. 3, 4). Throws std::runtime_error if an iteration does not
/// converge.
[[nodiscard]] LowestModes lowest_modes(const Beam& beam, const Defects& defects, int count,
                                       WidePencil& pencil);

}  // namespace wheeltap::fem
