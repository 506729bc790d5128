// ANOVA emulator: computes responses for many components from tables for one and two components.
// The number of table runs does not depend on the number of components.
#pragma once

#include <vector>

#include "emulator/holdout.hpp"

namespace wheeltap::emulator {

/// The quantity in which the effects of several components are added, as a function of a response
/// f.
enum class Additive {
  response,   ///< f itself
  logarithm,  ///< ln f, f > 0
  square,     ///< f², f > 0: a frequency's eigenvalue
  /// -1/f², f > 0: by first-order perturbation of the flexibility, it is additive in the
  /// compliances of several damages.
  inverse_square
};

[[nodiscard]] std::string_view name(Additive additive);
/// Inverse of `name`. Throws std::invalid_argument for an unknown text.
[[nodiscard]] Additive additive_named(std::string_view text);

/// A cut high-dimensional model representation about the structure without components (Rabitz &
/// Alış 1999, General foundations of high-dimensional model representations, section 3), to second
/// order. For components c_1 … c_k with m factors each and g the additive quantity of a response,
///   g(c_1…c_k) ≈ g_0 + Σ_i g_i + Σ_{i<j} g_ij,
///   g_i = G_1(c_i) - g_0,  g_ij = G_2(c_i, c_j) - G_1(c_i) - G_1(c_j) + g_0,
/// which, with G_1 and G_2 the values for one and for two components, is
///   g ≈ Σ_{i<j} G_2(c_i, c_j) - (k - 2) Σ_i G_1(c_i) + ½ (k - 1)(k - 2) g_0.
/// For up to two components, the result is as accurate as G_1 and G_2. For three and more, the
/// terms of third and higher order are neglected; `validate` measures the error.
class AnovaEmulator {
 public:
  /// `baseline`: the responses without components. `single` predicts for the m factors of one
  /// component, `pair` for the 2 m factors of two, in any order. Both must be thread-safe if this
  /// object is shared between threads. Throws std::invalid_argument for an empty baseline, m < 1,
  /// or a `baseline` without an additive quantity.
  AnovaEmulator(std::vector<double> baseline, std::size_t factors_per_component, Predictor single,
                Predictor pair, Additive additive = Additive::response);

  /// `x`: k m values, component after component, k >= 0. A response is NaN if the sum has no
  /// inverse (e.g. a negative square). Throws std::invalid_argument if the size is not a multiple
  /// of m, and the exceptions of `single` and `pair`.
  void evaluate(std::span<const double> x, std::span<double> out) const;

  [[nodiscard]] std::size_t responses() const { return baseline_.size(); }
  [[nodiscard]] std::size_t factors_per_component() const { return factors_; }

 private:
  std::vector<double> baseline_;  // additive quantity
  std::size_t factors_;
  Predictor single_, pair_;
  Additive additive_;
};

}  // namespace wheeltap::emulator
