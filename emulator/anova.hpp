// Emulators for many components from tables of one and of two: cost that does not grow with the
// count.
#pragma once

#include <vector>

#include "emulator/holdout.hpp"

namespace wheeltap::emulator {

/// The quantity in which effects of several components are added up, as a function of a response f.
enum class Additive {
  response,       ///< f itself
  logarithm,      ///< ln f, f > 0
  square,         ///< f², f > 0: a frequency's eigenvalue
  inverse_square  ///< -1/f², f > 0: by first-order perturbation of the flexibility, compliances
                  ///< that several damages add sum in it
};

[[nodiscard]] std::string_view name(Additive additive);
/// Inverse of `name`. Throws std::invalid_argument for another text.
[[nodiscard]] Additive additive_named(std::string_view text);

/// A high-dimensional model representation cut at the structure without components (Rabitz & Alış
/// 1999, General foundations of high-dimensional model representations, section 3), to second
/// order. For components c_1 … c_k with m factors each and g the additive quantity of a response,
///   g(c_1…c_k) ≈ g_0 + Σ_i g_i + Σ_{i<j} g_ij,
///   g_i = G_1(c_i) - g_0,  g_ij = G_2(c_i, c_j) - G_1(c_i) - G_1(c_j) + g_0,
/// which with G_1 and G_2 the answers for one and for two components is
///   g ≈ Σ_{i<j} G_2(c_i, c_j) - (k - 2) Σ_i G_1(c_i) + ½ (k - 1)(k - 2) g_0.
/// Exact for no, one and two components (as exact as its parts are), whatever the count; what it
/// leaves out at three and more is the third-order remainder, to be measured by `validate`.
class AnovaEmulator {
 public:
  /// `baseline`: the responses without components. `single` answers for the m factors of one
  /// component, `pair` for the 2 m factors of two, in either order alike. Both must be safe to call
  /// from several threads where this is. Throws std::invalid_argument for an empty baseline or
  /// m < 1, or where `baseline` has no additive quantity.
  AnovaEmulator(std::vector<double> baseline, std::size_t factors_per_component, Predictor single,
                Predictor pair, Additive additive = Additive::response);

  /// `x`: k m values, component after component, k >= 0. A response comes out NaN where the sum is
  /// no square, or inverse square, of anything. Throws std::invalid_argument for a size that is no
  /// multiple of m, and whatever the parts throw.
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
