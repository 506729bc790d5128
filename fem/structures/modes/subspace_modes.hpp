// The lowest modes of structures that differ little from one another, one after the other.
#pragma once

#include "base/eigen.hpp"
#include "fem/structures/discretisation.hpp"

namespace wheeltap::fem {

/// K φ = λ M φ by block inverse iteration with a Rayleigh-Ritz step (Bathe & Wilson 1972; Saad
/// 2011, section 5.2),
///
///   X ← (K + σ M)⁻¹ M X,   begun with the modes of the structure at which this object was made,
///
/// until no eigenvalue wanted moves by more than `tolerance`, relative; errors shrink by
/// (λ_wanted/λ_beyond)² a step, with as many vectors beyond as wanted, 8 at least. σ = 0 unless
/// there are rigid-body motions. Up to `kDense` degrees of freedom K is factored densely and
/// nothing is iterated. Degrees of freedom without mass are welcome.
///
/// That no mode is missing is not counted: see `eigenvalues_below`. Immutable after construction;
/// answers depend on nothing but their arguments.
class SubspaceModes {
 public:
  static constexpr int kDense = 40;

  struct Options {
    int modes = 1;            ///< elastic ones, the lowest
    double tolerance = 1e-8;  ///< of an eigenvalue, relative
    int most_steps = 60;
  };
  /// Throws as `structure_modes`.
  SubspaceModes(const Discretisation& first, const Options& options);

  struct Found {
    Eigen::VectorXd eigenvalues = {};  ///< elastic ones [rad²/s²], ascending
    Eigen::MatrixXd shapes = {};       ///< n × modes, mass-normalised
    int steps = 0;                     ///< 0: dense
  };
  /// Of a structure with the same degrees of freedom, or others: those are solved in full. False
  /// where K is not positive definite beside its rigid motions, or nothing converges.
  bool solve(const Discretisation& d, Found& out) const;

 private:
  bool dense(const Discretisation& d, Eigen::Index wanted, Found& out) const;
  bool iterate(const Discretisation& d, Eigen::Index wanted, Found& out) const;
  bool in_full(const Discretisation& d, Eigen::Index wanted, Found& out) const;

  Options options_;
  Eigen::MatrixXd start_;  // n × block
  double sigma_ = 0.0;     // where there are rigid motions
};

}  // namespace wheeltap::fem
