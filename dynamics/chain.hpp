// A chain of lumped masses connected by links.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/eigen.hpp"
#include "dynamics/law.hpp"
#include "dynamics/laws.hpp"

namespace wheeltap::dynamics {

/// A link between masses a and b; 0 is the ground or the moving base, 1 the first mass. With the
/// extension e = y_b - y_a (opening: e > 0), its tension
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

/// M z̈ = -M 1 ÿ_base + F(t) + Σ ±T, with z the displacement relative to the base. Without base
/// motion, z is the absolute displacement.
struct Chain {
  std::vector<Coefficient> masses = {};  ///< [kg], masses 1, 2, …
  std::vector<Link> links = {};

  [[nodiscard]] int size() const { return static_cast<int>(masses.size()); }
  /// Whether no link has a law besides stiffness and damping.
  [[nodiscard]] bool is_linear() const;
  /// The largest parameter index of any coefficient, plus one.
  [[nodiscard]] int parameters() const;
};

/// Throws std::invalid_argument unless there are masses and links, every link joins two different
/// existing masses, constant masses are positive and constant coefficients are feasible for their
/// law.
void validate(const Chain& chain);

/// Describes why the chain is infeasible at these parameters ("mass 1 = 0, must be > 0"); empty if
/// it is feasible. Simulator::simulate returns Outcome::impossible in this case, and if frequencies
/// overflow.
[[nodiscard]] std::string impossibility(const Chain& chain, std::span<const double> theta);

/// The matrices of the linear part, n × n each.
struct LinearMatrices {
  Eigen::MatrixXd mass, damping, stiffness;
};
[[nodiscard]] LinearMatrices linear_matrices(const Chain& chain, std::span<const double> theta);

/// Rates that limit a time step.
struct Rates {
  double frequency = 0.0;  ///< upper bound of the highest natural frequency ω [rad/s]
  /// Upper bound of the fastest decay, the largest eigenvalue of M⁻¹ C [1/s].
  double damping = 0.0;
};

/// Gershgorin's bounds over the rows of M⁻¹ K and M⁻¹ C, with every law at its stiffest branch for
/// extensions up to `extension[link]` [m] (empty: 0, so that a cubic spring does not count). Exact
/// for one mass. See `paces` for rates that grow with the speed of a link.
[[nodiscard]] Rates stiffest_rates(const Chain& chain, std::span<const double> theta,
                                   std::span<const double> extension = {});

/// Whether the chain has a law whose rates grow with the speed of its link (LawInfo::paced).
[[nodiscard]] bool is_paced(const Chain& chain);

/// This growth as one number per link [1/m]. At the speeds ė, the fastest rate of the paced laws (a
/// damping rate, i.e. an eigenvalue of M⁻¹ C, or the rate of a law's internal state) is at most Σ
/// pace[link] |ė_link| [1/s], with pace = Σ laws (∂²T/∂ė² (1/m_a + 1/m_b) + memory_per_speed).
void paces(const Chain& chain, std::span<const double> theta, std::span<double> pace);

}  // namespace wheeltap::dynamics
