#include "dynamics/link_tension.hpp"

#include <gtest/gtest.h>

#include "dynamics/simulate.hpp"

namespace {

using namespace wheeltap::dynamics;

/// The tension in the integrator: from the acceleration of a unit mass released at e.
double integrated(const Link& link, std::span<const double> theta, double e, double rate = 0.0) {
  const Excitation still{.sample_rate_hz = 1.0, .forces = {{.mass = 1, .signal = {{0.0}}}}};
  const Simulator simulator({.masses = {1.0}, .links = {link}}, still,
                            {{.mass = 1, .quantity = Quantity::acceleration}},
                            {.displacement = {e}, .velocity = {rate}},
                            {.integrator = Integrator::runge_kutta, .substeps = 1});
  return -simulator.simulate(theta).values(0, 0);
}

const std::vector<double> theta = {40.0, 900.0, 0.2};

std::vector<Link> links_with_laws() {
  const Coefficient k = Coefficient::of_parameter(0), k3 = Coefficient::of_parameter(1),
                    gap = Coefficient::of_parameter(2);
  return {
      {.stiffness = k, .damping = 3.0},
      {.stiffness = k, .laws = {make_law<laws::Cubic>({k3}), make_law<laws::Quadratic>({-7.0})}},
      {.laws = {make_law<laws::Bilinear>({k3}), make_law<laws::Bilinear>({k}, Side::closing)}},
      {.laws = {make_law<laws::Contact>({k3, gap}, Side::closing)}},
      {.stiffness = k,
       .laws = {make_law<laws::Coulomb>({2.0, 1e-3}), make_law<laws::QuadraticDamping>({2.0})}}};
}

// Regularised friction is zero at rest; exact friction is omitted, as documented.
TEST(LinkTension, MatchesTheIntegratorForALinkAtRest) {
  for (const Link& link : links_with_laws()) {
    for (const double e : {-0.7, -0.1, 0.0, 0.1, 0.9}) {
      const double want = integrated(link, theta, e);
      EXPECT_NEAR(resting_tension(link, theta, e), want, 1e-14 * (1.0 + std::abs(want)));
    }
  }
}

TEST(LinkTension, MatchesTheIntegratorForAMovingLink) {
  for (const Link& link : links_with_laws()) {
    for (const double e : {-0.7, 0.0, 0.9}) {
      for (const double rate : {-0.4, 1.3}) {
        const double want = integrated(link, theta, e, rate);
        EXPECT_NEAR(tension(link, theta, e, rate), want, 1e-14 * (1.0 + std::abs(want)));
      }
    }
  }
}

}  // namespace
