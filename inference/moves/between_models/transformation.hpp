// Jumps between two models by any diffeomorphism (Green 1995).
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "inference/moves/move.hpp"

namespace wheeltap::inference {

/// (x, u) in model `lower` ↔ (x', u') in model `upper`, in physical units, dimensions matching on
/// both sides. u and u' are auxiliary variables with independent densities g_i and g'_i (either may
/// be empty):
///
///   ln ratio(lower → upper) = Σ ln g'(u') - Σ ln g(u) + ln |∂(x', u')/∂(x, u)|
///                             + Σ ln |dz'/dx'| - Σ ln |dz/dx|.
///
/// The same map serves both directions, so that they cannot drift apart.
class Transformation : public Move {
 public:
  /// Reads the concatenated (x, u), writes the concatenated (x', u') and returns ln |J|.
  using Map = std::function<double(std::span<const double> from, std::span<double> to)>;

  struct Definition {
    int lower = 0;
    int upper = 1;
    std::vector<Prior> lower_auxiliaries;  ///< g
    std::vector<Prior> upper_auxiliaries;  ///< g'
    Map forward;                           ///< lower → upper
    Map inverse;  ///< upper → lower; returns its own ln |J|, minus the forward one's
  };

  /// Throws std::invalid_argument where the dimensions do not match.
  Transformation(const ModelSpace& space, Definition definition);

  /// Throws std::logic_error where inverse(forward(·)) misses its start by more than 10⁻⁸ of its
  /// size, or the two log-Jacobians do not cancel: the map is not what it claims to be.
  std::optional<double> propose(const State& from, const Step& step, State& to) override;

  /// The source's nested map (thesis, section 4.2): shared parameters are kept, and the one
  /// parameter that only the larger model has is μ + λ with λ ~ N(0, σ²); |J| = 1. Its width has to
  /// be chosen by hand, which is why the engine does not use it by itself.
  [[nodiscard]] static Definition nested(const ModelSpace& space, int lower, int upper, double mean,
                                         double sd);

 private:
  Definition definition_;
  std::vector<double> in_, out_, back_;
};

}  // namespace wheeltap::inference
