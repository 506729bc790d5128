// A chain of lumped masses connected by links.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/eigen.hpp"
#include "dynamics/law.hpp"
#include "dynamics/laws.hpp"

namespace wheeltap::dynamics {

/// A link between the masses a and b. Mass 0 is the ground or the moving base; mass 1 is the first
/// moving mass. The extension of the link is e = y_b - y_a (opening: e > 0). The tension of the
/// link is
///
///   T(e, ė) = stiffness · e + damping · ė + Σ laws
///
/// A positive tension pulls a towards b: the force is +T on a and -T on b.
struct Link {
  int a = 0;
  int b = 1;
  Coefficient stiffness = 0.0;  ///< [N/m]
  Coefficient damping = 0.0;    ///< [N s/m]
  std::vector<Law> laws = {};
};

/// A chain with the equation of motion M z̈ = -M 1 ÿ_base + F(t) + Σ ±T, where z is the
/// displacement relative to the base. If the base does not move, z is the absolute displacement.
struct Chain {
  std::vector<Coefficient> masses = {};  ///< masses 1, 2, … [kg]
  std::vector<Link> links = {};

  [[nodiscard]] int size() const { return static_cast<int>(masses.size()); }
  /// True if no link has a force law in addition to stiffness and damping.
  [[nodiscard]] bool is_linear() const;
  /// Returns the number of parameters: the largest parameter index of any coefficient, plus one.
  [[nodiscard]] int parameters() const;
};

/// Checks a chain. Throws std::invalid_argument for a chain without masses or links, a link that
/// does not join two different existing masses, a constant mass that is not positive, and constant
/// coefficients that are infeasible for their force law.
void validate(const Chain& chain);

/// Returns the reason why the chain is infeasible at these parameters ("mass 1 = 0, must be > 0"),
/// or an empty string for a feasible chain. Simulator::simulate returns Outcome::impossible for an
/// infeasible chain, and also if natural frequencies overflow.
[[nodiscard]] std::string impossibility(const Chain& chain, std::span<const double> theta);

/// The matrices of the linear part of a chain, n × n each.
struct LinearMatrices {
  Eigen::MatrixXd mass, damping, stiffness;
};
[[nodiscard]] LinearMatrices linear_matrices(const Chain& chain, std::span<const double> theta);

/// Upper bounds of the rates that limit the time step.
struct Rates {
  double frequency = 0.0;  ///< upper bound of all natural frequencies ω [rad/s]
  /// Upper bound of the decay rates, that is of the largest eigenvalue of M⁻¹ C [1/s].
  double damping = 0.0;
};

/// Computes Gershgorin's bounds of the rates from the rows of M⁻¹ K and M⁻¹ C. Each force law
/// contributes its largest slope at extensions up to `extension[link]` [m]. If `extension` is
/// empty, the extensions are 0, and a cubic spring does not contribute. The bounds are exact for a
/// chain of one mass. For rates that grow with the speed |ė|, see `paces`.
[[nodiscard]] Rates stiffest_rates(const Chain& chain, std::span<const double> theta,
                                   std::span<const double> extension = {});

/// True if the chain has a force law whose rates grow with the velocity |ė| (LawInfo::paced).
[[nodiscard]] bool is_paced(const Chain& chain);

/// Computes, for each link, by how much the rates increase per unit of the velocity |ė| of the link
/// [1/m]. A rate is a damping rate (an eigenvalue of M⁻¹ C) or the rate of the internal state of a
/// law. At the speeds ė, the largest rate of the paced force laws is at most Σ pace[link] |ė_link|
/// [1/s], with pace = Σ laws (∂²T/∂ė² (1/m_a + 1/m_b) + memory_per_speed).
void paces(const Chain& chain, std::span<const double> theta, std::span<double> pace);

}  // namespace wheeltap::dynamics
