// A chain: lumped masses joined by links.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/eigen.hpp"
#include "dynamics/law.hpp"
#include "dynamics/laws.hpp"

namespace wheeltap::dynamics {

/// A link between masses a and b; 0 is the ground or the moving base, 1 the first mass. With the
/// extension e = y_b - y_a (opening: e > 0) its tension
///
///   T(e, ė) = stiffness · e + damping · ė + Σ laws
///
/// pulls a towards b: +T on a, -T on b.
struct Link {
  int a = 0;
  int b = 1;
  Coefficient stiffness = 0.0;  ///< [N/m]
  Coefficient damping = 0.0;    ///< [N s/m]
  std::vector<Law> laws = {};
};

/// M z̈ = -M 1 ÿ_base + F(t) + Σ ±T, z the displacement relative to the base. Without base motion z
/// is the displacement itself.
struct Chain {
  std::vector<Coefficient> masses = {};  ///< [kg], masses 1, 2, …
  std::vector<Link> links = {};

  [[nodiscard]] int size() const { return static_cast<int>(masses.size()); }
  /// True if no link has a law beside stiffness and damping.
  [[nodiscard]] bool is_linear() const;
  /// One more than the largest parameter index any coefficient uses.
  [[nodiscard]] int parameters() const;
};

/// Throws std::invalid_argument unless there are masses and links, every link joins two different
/// masses that exist, constant masses are positive and constant coefficients make sense for their
/// law.
void validate(const Chain& chain);

/// What of the chain makes no sense at these parameters, in words ("mass 1 = 0, must be > 0");
/// empty where all does. Simulator::simulate ends as Outcome::impossible where this names
/// something, and where frequencies overflow.
[[nodiscard]] std::string impossibility(const Chain& chain, std::span<const double> theta);

/// The matrices of the linear part, n × n each.
struct LinearMatrices {
  Eigen::MatrixXd mass, damping, stiffness;
};
[[nodiscard]] LinearMatrices linear_matrices(const Chain& chain, std::span<const double> theta);

/// What limits a time step.
struct Rates {
  double frequency = 0.0;  ///< bound of the highest natural frequency ω [rad/s]
  double damping = 0.0;    ///< bound of the fastest decay, the largest eigenvalue of M⁻¹ C [1/s]
};

/// Gershgorin's bounds over the rows of M⁻¹ K and M⁻¹ C, every law taken at its stiffest branch for
/// extensions up to `extension[link]` [m] (empty: 0, so that a cubic spring counts nothing). Exact
/// for one mass. What grows with the speed of a link is left to `paces`.
[[nodiscard]] Rates stiffest_rates(const Chain& chain, std::span<const double> theta,
                                   std::span<const double> extension = {});

/// Whether a law is among the chain's whose rates grow with the speed of its link (LawInfo::paced).
[[nodiscard]] bool is_paced(const Chain& chain);

/// The same growth as one number a link [1/m]: at the speeds ė the fastest rate of the paced laws,
/// be it a damping rate, an eigenvalue of M⁻¹ C, or that of a law's own state, is at most
/// Σ pace[link] |ė_link| [1/s], pace = Σ laws (∂²T/∂ė² (1/m_a + 1/m_b) + memory_per_speed).
void paces(const Chain& chain, std::span<const double> theta, std::span<double> pace);

}  // namespace wheeltap::dynamics
