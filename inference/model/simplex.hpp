// Shares that sum to one, as independent parameters.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "inference/model/model_space.hpp"

namespace wheeltap::inference {

/// n shares of a whole, w_i >= 0, Σ w_i = 1, with Dirichlet's density p(w) ∝ ∏ w_i^(α_i - 1),
/// by the sticks that are broken off what is left (Sethuraman 1994, section 2):
///
///   w_i = v_i ∏_{j<i} (1 - v_j),   v_i ~ Beta(α_i, Σ_{j>i} α_j) independent,   i < n;
///
/// the last share is the rest. A model has the n - 1 sticks as its parameters, and its likelihood
/// asks for the shares.
class Simplex {
 public:
  /// The sticks are named "`name`[1]" to "`name`[n-1]". Throws std::invalid_argument where an α is
  /// not positive and finite, or there are fewer than two.
  Simplex(std::string name, std::vector<double> alpha);

  /// For ModelSpace::of_models.
  [[nodiscard]] const std::vector<Parameter>& sticks() const { return sticks_; }
  [[nodiscard]] std::vector<std::string> names() const;
  [[nodiscard]] int size() const { return static_cast<int>(sticks_.size()) + 1; }

  /// The shares of `sticks`, n - 1 values between 0 and 1. Throws std::invalid_argument where there
  /// are more or fewer.
  [[nodiscard]] std::vector<double> shares(std::span<const double> sticks) const;

 private:
  std::vector<Parameter> sticks_;
};

}  // namespace wheeltap::inference
