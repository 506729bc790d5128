// Fractions (shares) that sum to one, expressed by parameters that are independent a priori.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "inference/model/model_space.hpp"

namespace wheeltap::inference {

/// n shares (fractions of a total), w_i >= 0, Σ w_i = 1, with the Dirichlet density
/// p(w) ∝ ∏ w_i^(α_i - 1). Stick breaking (Sethuraman 1994, section 2) gives the shares:
///
///   w_i = v_i ∏_{j<i} (1 - v_j),   v_i ~ Beta(α_i, Σ_{j>i} α_j) independent,   i < n.
///
/// The last share is the remainder. A model has the n - 1 sticks v_i as parameters. The likelihood
/// of the model calls shares() to compute the shares.
class Simplex {
 public:
  /// The names of the sticks are "`name`[1]" to "`name`[n-1]". Throws std::invalid_argument if an α
  /// is not positive and finite, or if there are fewer than two values of α.
  Simplex(std::string name, std::vector<double> alpha);

  /// Parameters for ModelSpace::of_models.
  [[nodiscard]] const std::vector<Parameter>& sticks() const { return sticks_; }
  [[nodiscard]] std::vector<std::string> names() const;
  [[nodiscard]] int size() const { return static_cast<int>(sticks_.size()) + 1; }

  /// Computes the n shares from the n - 1 sticks. Each stick is a number between 0 and 1.
  /// Throws std::invalid_argument if the number of sticks differs from n - 1.
  [[nodiscard]] std::vector<double> shares(std::span<const double> sticks) const;

 private:
  std::vector<Parameter> sticks_;
};

}  // namespace wheeltap::inference
