// Steps towards the local Gauss-Newton approximation of the posterior, for likelihoods with exact
// derivatives.
#pragma once

#include <array>

#include "base/eigen.hpp"
#include "inference/moves/move.hpp"

namespace wheeltap::inference {

/// With gradient g and positive definite information H of ln π at z (Target::gauss_newton),
///
///   z' ~ N(z + (1 - ρ) H⁻¹ g, (1 - ρ²) H⁻¹).
///
/// ln(1 - ρ) is uniform between ln 10⁻³ and 0 and independent of the state. If ln π is quadratic
/// with the Hessian -H, the proposal leaves π invariant for every ρ. For any other ln π, the ratio
/// of the two proposal densities corrects for the change of g and H between z and z' (manifold
/// Metropolis adjusted Langevin algorithm: Girolami & Calderhead 2011, J. Royal Statistical Society
/// B 73:123, section 5, with the information matrix, but not its derivatives). The move is suitable
/// for posteriors close to a curved surface, for example if the data determine only some directions
/// of many parameters. Each proposal requires a call of Target::gauss_newton.
///
/// The move makes no proposal if Target::gauss_newton returns false or the likelihood has no exact
/// derivatives.
class NewtonWalk : public Move {
 public:
  std::optional<double> propose(const State& from, const Step& step, State& to) override;

 private:
  /// The approximation about z. The approximations about the last two points are kept, because one
  /// of these points is the next state of the chain.
  struct Local {
    int model = -1;
    std::vector<double> z;
    Eigen::VectorXd newton;        ///< H⁻¹ g
    Eigen::MatrixXd factor;        ///< lower Cholesky factor L of H
    double log_determinant = 0.0;  ///< ln |L|
  };

  /// Returns the normal approximation about the state, or null if it cannot be computed.
  const Local* about(const State& state, Target& target);

  std::array<Local, 2> known_;
  std::size_t oldest_ = 0;
  State at_;
};

}  // namespace wheeltap::inference
