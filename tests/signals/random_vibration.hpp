// A linear structure under independent random forces, sampled exactly, as a source of records.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <unsupported/Eigen/MatrixFunctions>
#include <vector>

#include "base/eigen.hpp"
#include "base/eigen_solvers.hpp"
#include "base/random.hpp"

namespace wheeltap::signals {

/// M ẍ + C ẋ + K x = f, f held over each sample: poles of the samples are exactly exp(λ Δt).
struct VibratingStructure {
  Eigen::MatrixXd mass, stiffness;
  double damping_ratio = 0.015;  ///< of every mode
  double step = 0.05;            ///< [s]

  struct Modes {
    Eigen::VectorXd frequencies_hz;
    Eigen::MatrixXd shapes;  ///< by column, mass-normalised
  };
  [[nodiscard]] Modes modes() const {
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(stiffness, mass);
    return {eigen.eigenvalues().cwiseSqrt() / (2.0 * std::numbers::pi), eigen.eigenvectors()};
  }

  /// C = M Φ diag(2ζω) Φᵀ M.
  [[nodiscard]] Eigen::MatrixXd damping() const {
    const Modes m = modes();
    const Eigen::VectorXd twice = 4.0 * std::numbers::pi * damping_ratio * m.frequencies_hz;
    return mass * m.shapes * twice.asDiagonal() * m.shapes.transpose() * mass;
  }

  /// Accelerations of all degrees of freedom, one per row, under independent normal forces of unit
  /// variance, with sensor noise of `noise` times each channel's standard deviation. Starts in the
  /// stationary state, up to exp(-ζω T) of a lead-in.
  [[nodiscard]] Eigen::MatrixXd accelerations(long samples, double noise,
                                              std::uint64_t seed) const {
    return driven(samples, noise, seed).accelerations;
  }

  /// With the forces.
  struct Driven {
    Eigen::MatrixXd forces, accelerations;
  };
  [[nodiscard]] Driven driven(long samples, double noise, std::uint64_t seed) const {
    const auto n = mass.rows();
    // exp([A B; 0 0] Δt) = [A_d B_d; 0 I] (Van Loan 1978).
    Eigen::MatrixXd block = Eigen::MatrixXd::Zero(3 * n, 3 * n);
    const Eigen::MatrixXd inverse = mass.inverse(), c = damping();
    block.block(0, n, n, n).setIdentity();
    block.block(n, 0, n, n) = -inverse * stiffness;
    block.block(n, n, n, n) = -inverse * c;
    block.block(n, 2 * n, n, n) = inverse;
    const Eigen::MatrixXd rows = block.middleRows(n, n);
    const Eigen::MatrixXd discrete = (block * step).exp().topRows(2 * n);
    const double slowest = modes().frequencies_hz.minCoeff() * 2.0 * std::numbers::pi;
    const auto lead = static_cast<long>(12.0 / (damping_ratio * slowest * step));
    base::Random random(seed, 0, 0, base::Purpose::test);
    Eigen::VectorXd state = Eigen::VectorXd::Zero(3 * n);
    Eigen::MatrixXd y(n, samples), forces(n, samples);
    for (long k = -lead; k < samples; ++k) {
      for (Eigen::Index i = 0; i < n; ++i) state[2 * n + i] = random.normal();
      if (k >= 0) {
        y.col(k) = rows * state;
        forces.col(k) = state.tail(n);
      }
      state.head(2 * n) = (discrete * state).eval();
    }
    for (Eigen::Index i = 0; i < n; ++i) {
      const double sd = std::sqrt(y.row(i).squaredNorm() / static_cast<double>(samples));
      for (long k = 0; k < samples; ++k) y(i, k) += noise * sd * random.normal();
    }
    return {.forces = forces, .accelerations = y};
  }
};

/// Equal masses in a row; springs connect the first to the ground and each to its neighbour.
inline VibratingStructure chain(int masses, double mass, double stiffness) {
  VibratingStructure out{.mass = mass * Eigen::MatrixXd::Identity(masses, masses),
                         .stiffness = Eigen::MatrixXd::Zero(masses, masses)};
  for (int i = 0; i < masses; ++i) {
    out.stiffness(i, i) += stiffness;
    if (i == 0) continue;
    out.stiffness(i - 1, i - 1) += stiffness;
    out.stiffness(i - 1, i) -= stiffness;
    out.stiffness(i, i - 1) -= stiffness;
  }
  return out;
}

}  // namespace wheeltap::signals
