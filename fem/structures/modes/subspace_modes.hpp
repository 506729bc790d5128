// Computation of the lowest modes of a sequence of similar structures.
#pragma once

#include "base/eigen.hpp"
#include "fem/structures/discretisation.hpp"

namespace wheeltap::fem {

/// Solves K φ = λ M φ by block inverse iteration with a Rayleigh-Ritz step (Bathe & Wilson 1972;
/// Saad 2011, section 5.2):
///
///   X ← (K + σ M)⁻¹ M X.
///
/// The iteration starts from the modes of the structure that the constructor received.
/// The iteration ends when the relative change of all requested eigenvalues is below `tolerance`.
/// Each iteration multiplies the errors of the eigenvalues by the factor (λ_requested/λ_next)²,
/// where λ_next is the lowest eigenvalue outside the block. For n requested modes, the block has
/// max(2 n, n + 8) vectors. The shift σ is 0 unless the structure has rigid-body motions. Up to
/// `kDense` degrees of freedom, a dense solver computes the modes without iteration. Degrees of
/// freedom without mass are allowed.
///
/// This class does not check whether a mode is missing; use `eigenvalues_below` for this check. The
/// object is immutable after construction, and the results depend only on the arguments.
class SubspaceModes {
 public:
  static constexpr int kDense = 40;

  struct Options {
    int modes = 1;            ///< number of lowest elastic modes
    double tolerance = 1e-8;  ///< largest relative change of an eigenvalue in the last iteration
    int most_steps = 60;
  };
  /// Throws the exceptions of `structure_modes`.
  SubspaceModes(const Discretisation& first, const Options& options);

  struct Found {
    Eigen::VectorXd eigenvalues = {};  ///< eigenvalues of the elastic modes [rad²/s²], ascending
    Eigen::MatrixXd shapes = {};       ///< n × modes, mass-normalised
    int steps = 0;                     ///< number of iterations; 0: dense solver
  };
  /// Computes the modes of a structure. If the degrees of freedom differ from those of the first
  /// structure, structure_modes solves the problem. Returns false if the iteration does not
  /// converge, or if K is not positive definite on the complement of the rigid-body motions.
  bool solve(const Discretisation& d, Found& out) const;

 private:
  bool dense(const Discretisation& d, Eigen::Index wanted, Found& out) const;
  bool iterate(const Discretisation& d, Eigen::Index wanted, Found& out) const;
  bool in_full(const Discretisation& d, Eigen::Index wanted, Found& out) const;

  Options options_;
  Eigen::MatrixXd start_;  // n × block
  double sigma_ = 0.0;     // nonzero if the structure has rigid motions
};

}  // namespace wheeltap::fem
