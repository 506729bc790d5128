// Jumps between two models by a diffeomorphism (Green 1995).
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "inference/moves/move.hpp"

namespace wheeltap::inference {

/// (x, u) in model `lower` ↔ (x', u') in model `upper`, in physical units, with equal dimensions on
/// both sides. u and u' are auxiliary variables with independent densities g_i and g'_i (either may
/// be empty):
///
///   ln ratio(lower → upper) = Σ ln g'(u') - Σ ln g(u) + ln |∂(x', u')/∂(x, u)|
///                             + Σ ln |dz'/dx'| - Σ ln |dz/dx|.
///
/// The same expression holds for both directions of the jump.
class Transformation : public Move {
 public:
  /// Reads the concatenated (x, u), writes the concatenated (x', u') and returns ln |J|.
  using Map = std::function<double(std::span<const double> from, std::span<double> to)>;

  struct Definition {
    int lower = 0;
    int upper = 1;
    std::vector<Prior> lower_auxiliaries;  ///< g
    std::vector<Prior> upper_auxiliaries;  ///< densities g' of the auxiliary variables u'
    Map forward;                           ///< map from `lower` to `upper`
    /// Map from `upper` to `lower`. The map returns the ln |J| of the inverse map, which is minus
    /// the ln |J| of `forward`.
    Map inverse;
  };

  /// Throws std::invalid_argument if the dimensions do not match.
  Transformation(const ModelSpace& space, Definition definition);

  /// Throws std::logic_error if the user's map is inconsistent: inverse(forward(x)) differs from x
  /// by more than 10⁻⁸ of the size of x, or the two log-Jacobians do not cancel.
  std::optional<double> propose(const State& from, const Step& step, State& to) override;

  /// The nested map (Tiboaca 2016, thesis, section 4.2): shared parameters are kept, and |J| = 1.
  /// The one additional parameter of the larger model is μ + λ with λ ~ N(0, σ²). The user must
  /// choose the width σ, so the engine does not use this move by default.
  [[nodiscard]] static Definition nested(const ModelSpace& space, int lower, int upper, double mean,
                                         double sd);

 private:
  Definition definition_;
  std::vector<double> in_, out_, back_;
};

}  // namespace wheeltap::inference
