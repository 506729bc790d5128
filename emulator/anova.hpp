// ANOVA emulator: predicts responses for many components from tables for one and for two
// components. The number of model runs for the tables does not depend on the number of components.
#pragma once

#include <vector>

#include "emulator/holdout.hpp"

namespace wheeltap::emulator {

/// The additive quantity: a function of a response f whose changes due to several components add
/// up.
enum class Additive {
  response,   ///< f itself
  logarithm,  ///< ln f, f > 0
  square,     ///< f², f > 0: for a natural frequency f, proportional to the eigenvalue
  /// -1/f², f > 0: by first-order perturbation of the flexibility, this quantity is additive in the
  /// compliances of several damaged elements.
  inverse_square
};

[[nodiscard]] std::string_view name(Additive additive);
/// Returns the additive quantity with this name. Throws std::invalid_argument for an unknown name.
[[nodiscard]] Additive additive_named(std::string_view text);

/// A second-order cut high-dimensional model representation (cut-HDMR; Rabitz & Alış 1999, General
/// foundations of high-dimensional model representations, section 3). The reference is the
/// structure without components. Let g be the additive quantity of a response, and G_1 and G_2 its
/// values for one and for two components. For components c_1 … c_k with m factors each,
///   g(c_1…c_k) ≈ g_0 + Σ_i g_i + Σ_{i<j} g_ij,
///   g_i = G_1(c_i) - g_0,  g_ij = G_2(c_i, c_j) - G_1(c_i) - G_1(c_j) + g_0.
/// The sum is
///   g ≈ Σ_{i<j} G_2(c_i, c_j) - (k - 2) Σ_i G_1(c_i) + ½ (k - 1)(k - 2) g_0.
/// For up to two components, the prediction is as accurate as G_1 and G_2. For three and more
/// components, the terms of third and higher order are neglected; `validate` measures the error.
class AnovaEmulator {
 public:
  /// `baseline` holds the responses without components. `single` predicts the responses from the m
  /// factors of one component, and `pair` from the 2 m factors of two components in any order. Both
  /// predictors must be thread-safe if threads share this object. Throws std::invalid_argument for
  /// an empty baseline, m < 1, or a baseline response for which the additive quantity is undefined.
  AnovaEmulator(std::vector<double> baseline, std::size_t factors_per_component, Predictor single,
                Predictor pair, Additive additive = Additive::response);

  /// Predicts the responses for k >= 0 components. `x` holds the m factors of each component, k m
  /// values in total. A predicted response is NaN if no response has the predicted additive
  /// quantity (for example a negative square). Throws std::invalid_argument if the size is not a
  /// multiple of m, and the exceptions of `single` and `pair`.
  void evaluate(std::span<const double> x, std::span<double> out) const;

  [[nodiscard]] std::size_t responses() const { return baseline_.size(); }
  [[nodiscard]] std::size_t factors_per_component() const { return factors_; }

 private:
  std::vector<double> baseline_;  // additive quantity of the baseline responses
  std::size_t factors_;
  Predictor single_, pair_;
  Additive additive_;
};

}  // namespace wheeltap::emulator
