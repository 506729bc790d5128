// Splits one component into two neighbours, or merges two neighbours into one.
#pragma once

#include "inference/moves/move.hpp"

namespace wheeltap::inference {

/// A component with first parameter x and further parameters a_i splits into two
/// components that are neighbours in the order,
///
///   x₁ = x - w, x₂ = x + w,   w ~ half-normal(width);
///   a_i₁ = s_i a_i, a_i₂ = (1 - s_i) a_i,   s_i ~ U(0, 1),
///
/// and two neighbours merge by x = (x₁ + x₂)/2, a_i = a_i₁ + a_i₂, so that sums are conserved. If
/// the effects of components multiply, -ln(1 - a) replaces a, where 1 - a is the fraction that
/// remains after a component. A split chooses one of k components, and a merge one of the k
/// neighbouring pairs of k + 1 components, so these probabilities cancel:
///
///   ln ratio(split) = - ln g(w) + ln |J| + Σ ln |dz'/dx'| - Σ ln |dz/dx|,     |J| = 2 ∏ |a_i|.
class SplitMerge : public Move {
 public:
  enum class Keeps { sum, product_of_complements };
  /// `width` is the scale of the half-normal g, in the unit of the first parameter.
  SplitMerge(int kind, double width, Keeps keeps = Keeps::sum)
      : kind_(kind), width_(width), compounds_(keeps == Keeps::product_of_complements) {}
  std::optional<double> propose(const State& from, const Step& step, State& to) override;

 private:
  int kind_;
  double width_;
  bool compounds_;
};

}  // namespace wheeltap::inference
