#include "dynamics/link_tension.hpp"

#include <gtest/gtest.h>

#include "dynamics/simulate.hpp"

namespace {

using namespace wheeltap::dynamics;

/// The tension as the integrator has it: from the acceleration of a unit mass let go at e.
double integrated(const Link& link, std::span<const double> theta, double e) {
  const Excitation still{.sample_rate_hz = 1.0, .forces = {{.mass = 1, .signal = {{0.0}}}}};
  const Simulator simulator({.masses = {1.0}, .links = {link}}, still,
                            {{.mass = 1, .quantity = Quantity::acceleration}},
                            {.displacement = {e}, .velocity = {0.0}},
                            {.integrator = Integrator::runge_kutta, .substeps = 1});
  return -simulator.simulate(theta).values(0, 0);
}

// Friction regularised over a creep speed counts nothing at rest; exact friction holds, and is left
// out as documented.
TEST(LinkTension, IsTheIntegratorsForALinkAtRest) {
  const std::vector<double> theta = {40.0, 900.0, 0.2};
  const Coefficient k = Coefficient::of_parameter(0), k3 = Coefficient::of_parameter(1),
                    gap = Coefficient::of_parameter(2);
  const std::vector<Link> links = {
      {.stiffness = k, .damping = 3.0},
      {.stiffness = k, .laws = {make_law<laws::Cubic>({k3}), make_law<laws::Quadratic>({-7.0})}},
      {.laws = {make_law<laws::Bilinear>({k3}), make_law<laws::Bilinear>({k}, Side::closing)}},
      {.laws = {make_law<laws::Contact>({k3, gap}, Side::closing)}},
      {.stiffness = k,
       .laws = {make_law<laws::Coulomb>({2.0, 1e-3}), make_law<laws::QuadraticDamping>({2.0})}}};
  for (const Link& link : links) {
    for (const double e : {-0.7, -0.1, 0.0, 0.1, 0.9}) {
      const double want = integrated(link, theta, e);
      EXPECT_NEAR(resting_tension(link, theta, e), want, 1e-14 * (1.0 + std::abs(want)));
    }
  }
}

}  // namespace
