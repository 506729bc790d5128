#include "dynamics/simulate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/dynamics/chains.hpp"

namespace {

using namespace wheeltap::dynamics;

TEST(Simulator, StrideOnAnInterpolatedForceIsASubstep) {
  const std::vector<double> force = noise(200, 5, 20.0);
  std::vector<double> fine;
  for (std::size_t n = 0; n < force.size(); ++n) {
    fine.push_back(force[n]);
    if (n + 1 < force.size()) fine.push_back(0.5 * (force[n] + force[n + 1]));
  }
  Chain chain = uniform_chain(2);
  for (bool cubic : {false, true}) {
    if (cubic) chain.links[1].laws = {make_law<laws::Cubic>({100.0})};
    const Integrator integrator = cubic ? Integrator::runge_kutta : Integrator::exact;
    const Response coarse =
        Simulator(chain, {.sample_rate_hz = 20.0, .forces = {{.mass = 1, .signal = {force}}}},
                  displacements(2), {}, {.integrator = integrator, .substeps = cubic ? 2 : 0})
            .simulate({});
    const Response strided =
        Simulator(chain, {.sample_rate_hz = 40.0, .forces = {{.mass = 1, .signal = {fine}}}},
                  displacements(2), {},
                  {.integrator = integrator, .substeps = cubic ? 1 : 0, .stride = 2})
            .simulate({});
    ASSERT_EQ(coarse.values.rows(), strided.values.rows());
    EXPECT_LT((coarse.values - strided.values).cwiseAbs().maxCoeff(),
              1e-12 * coarse.values.cwiseAbs().maxCoeff());
  }
}

// A base acceleration ÿ_b is equivalent to a force -m ÿ_b on every mass, relative to the base.
TEST(Simulator, BaseAccelerationIsAnInertiaForce) {
  Chain chain = uniform_chain(3);
  chain.masses = {5.0, 3.0, 4.0};
  const std::vector<double> base = noise(400, 11, 2.0);
  Excitation pushed{.sample_rate_hz = 20.0};
  for (int i = 1; i <= 3; ++i)
    pushed.forces.push_back(
        {.mass = i, .signal = {base, -chain.masses[static_cast<std::size_t>(i - 1)].value, 0.0}});
  const Excitation moved{.sample_rate_hz = 20.0, .base = BaseMotion{.acceleration = {base}}};
  for (bool nonlinear : {false, true}) {
    if (nonlinear) chain.links[1].laws = {make_law<laws::Contact>({200.0, 0.05}, Side::closing)};
    std::vector<Sensor> sensors{
        {.mass = 2, .frame = Frame::relative},
        {.mass = 3, .quantity = Quantity::acceleration, .frame = Frame::relative}};
    const Response by_force = Simulator(chain, pushed, sensors).simulate({});
    sensors.push_back({.mass = 3, .quantity = Quantity::acceleration});
    const Response by_base = Simulator(chain, moved, sensors).simulate({});
    EXPECT_LT((by_base.values.leftCols(2) - by_force.values).cwiseAbs().maxCoeff(), 1e-11);
    const Eigen::Map<const Eigen::VectorXd> ground(base.data(), 400);
    EXPECT_LT((by_base.values.col(2) - by_base.values.col(1) - ground).cwiseAbs().maxCoeff(),
              1e-14);
  }
}

// A base moved by X sin Ωt: the steady amplitude of a damped mass is |H| X with H = (k + iΩc) / (k
// - mΩ² + iΩc), for displacement and acceleration as excitation.
TEST(Simulator, BaseDisplacementGivesTheTransmissibility) {
  const double rate = 64.0, omega = 3.0, amplitude = 0.02, m = 5.0, k = 50.0, c = 4.0;
  const std::size_t samples = 64 * 120;
  std::vector<double> displacement(samples), acceleration(samples);
  for (std::size_t n = 0; n < samples; ++n) {
    const double phase = omega * static_cast<double>(n) / rate;
    displacement[n] = amplitude * std::sin(phase);
    acceleration[n] = -omega * omega * displacement[n];
  }
  const std::complex<double> h =
      std::complex(k, omega * c) / std::complex(k - m * omega * omega, omega * c);
  const Chain chain{.masses = {m}, .links = {{.stiffness = k, .damping = c}}};
  const std::vector<Sensor> sensors{{.mass = 1},
                                    {.mass = 1, .quantity = Quantity::velocity},
                                    {.mass = 1, .quantity = Quantity::acceleration}};
  const BaseMotion both{.acceleration = {acceleration}, .displacement = {displacement}};
  const BaseMotion one{.displacement = {displacement}};
  for (const BaseMotion& base : {both, one}) {
    const Response response =
        Simulator(chain, {.sample_rate_hz = rate, .base = base}, sensors).simulate({});
    double worst[3] = {0.0, 0.0, 0.0};
    for (std::size_t n = samples - 640; n < samples - 64; ++n) {
      const std::complex<double> rotor =
          h * amplitude * std::polar(1.0, omega * static_cast<double>(n) / rate);
      const auto row = static_cast<Eigen::Index>(n);
      worst[0] = std::max(worst[0], std::abs(response.values(row, 0) - rotor.imag()));
      worst[1] = std::max(worst[1], std::abs(response.values(row, 1) - omega * rotor.real()));
      worst[2] =
          std::max(worst[2], std::abs(response.values(row, 2) + omega * omega * rotor.imag()));
    }
    // θ = Ω/rate = 0.047: the error of the acceleration's hold is θ²/12 = 1.8e-4, that of the
    // spline θ⁴/720 except for its second derivative at the samples.
    const double scale = amplitude * std::abs(h),
                 tolerance = base.acceleration.samples.empty() ? 4e-7 : 3e-4;
    EXPECT_LT(worst[0], tolerance * scale);
    EXPECT_LT(worst[1], tolerance * scale * omega);
    EXPECT_LT(worst[2], 3e-4 * scale * omega * omega);
  }
}

/// A chain with every law and every coefficient a parameter.
struct Everything {
  Chain chain;
  std::vector<double> theta;

  Coefficient parameter(double value) {
    theta.push_back(value);
    return Coefficient::of_parameter(static_cast<int>(theta.size()) - 1);
  }

  explicit Everything(bool serial) {
    chain.masses = {parameter(2.0), parameter(3.0), parameter(1.5)};
    for (int i = 0; i < 3; ++i)
      chain.links.push_back(
          {.a = i, .b = i + 1, .stiffness = parameter(90.0 + i), .damping = parameter(0.2)});
    if (!serial)
      chain.links.push_back(
          {.a = 3, .b = 1, .stiffness = parameter(5.0), .damping = parameter(0.1)});
    chain.links[0].laws = {make_law<laws::Quadratic>({parameter(30.0)}),
                           make_law<laws::Cubic>({parameter(200.0)}),
                           make_law<laws::Quintic>({parameter(900.0)}),
                           make_law<laws::BoucWen>({parameter(40.0), parameter(0.05),
                                                    parameter(1.5), parameter(0.6), 0.3})};
    chain.links[1].laws = {
        make_law<laws::Bilinear>({parameter(60.0)}, Side::closing),
        make_law<laws::Contact>({parameter(400.0), parameter(0.02)}, Side::opening)};
    chain.links[2].laws = {make_law<laws::Coulomb>({parameter(0.5), parameter(0.01)}),
                           make_law<laws::QuadraticDamping>({parameter(0.3)})};
  }
};

TEST(Lanes, EveryWidthAndGroupingGivesTheSameBits) {
  enum class Kind { everything, cubic, stops, springs, linear, dry, dry_everything };
  for (Kind kind : {Kind::everything, Kind::cubic, Kind::stops, Kind::springs, Kind::linear,
                    Kind::dry, Kind::dry_everything})
    for (bool serial : {true, false}) {
      SCOPED_TRACE(testing::Message() << "kind " << static_cast<int>(kind) << " serial " << serial);
      Everything everything(serial);
      for (Link& link : everything.chain.links) {
        const std::vector<Law> all = std::move(link.laws);
        link.laws.clear();
        for (const Law& law : all) {
          const std::string_view name = law_infos()[static_cast<std::size_t>(law.kind)].name;
          const bool stop = name == "bilinear" || name == "contact";
          if (kind == Kind::everything || kind == Kind::dry_everything ||
              (kind == Kind::cubic && name == "cubic") || (kind == Kind::stops && stop) ||
              ((kind == Kind::springs || kind == Kind::dry) &&
               (stop || name == "cubic" || name == "quadratic")))
            link.laws.push_back(law);
        }
        if (kind == Kind::dry || kind == Kind::dry_everything)
          link.laws.push_back(make_law<laws::Coulomb>({everything.parameter(6.0)}));
      }
      const int sets = 11;
      std::vector<double> thetas;
      const std::vector<double> factors = noise(sets * everything.theta.size(), 17, 0.3);
      for (std::size_t i = 0; i < factors.size(); ++i)
        thetas.push_back(everything.theta[i % everything.theta.size()] * (1.0 + factors[i]));
      const std::size_t dimension = everything.theta.size();
      const Excitation drive{.sample_rate_hz = 50.0,
                             .forces = {{.mass = 3, .signal = {noise(300, 23, 30.0)}}},
                             .base = BaseMotion{.acceleration = {noise(300, 29, 3.0)}}};
      const std::vector<Sensor> sensors{{.mass = 1, .frame = Frame::relative},
                                        {.mass = 2, .quantity = Quantity::acceleration}};
      const std::vector<Signal> observed{{noise(300, 31)}, {noise(300, 37)}};
      std::vector<double> reference;
      for (Instructions instructions : {Instructions::baseline, Instructions::avx2,
                                        Instructions::avx512, Instructions::automatic}) {
        try {
          const Misfit misfit(
              Simulator(everything.chain, drive, sensors, {}, {.instructions = instructions}),
              observed, 20);
          std::vector<double> together(sets * 2), alone(sets * 2);
          misfit.sums_of_squares(thetas, sets, together);
          for (std::size_t i = 0; i < sets; ++i)
            misfit.sums_of_squares(std::span(thetas).subspan(i * dimension, dimension), 1,
                                   std::span(alone).subspan(2 * i, 2));
          EXPECT_EQ(together, alone);
          if (reference.empty()) reference = together;
          EXPECT_EQ(together, reference) << static_cast<int>(instructions);
          for (double sum : together) EXPECT_TRUE(std::isfinite(sum));
        } catch (const std::invalid_argument&) {
          // This processor lacks the instructions.
          EXPECT_NE(instructions, Instructions::automatic);
        }
      }
    }
}

TEST(Misfit, IsTheSumOfSquaredResidualsOfTheStoredResponse) {
  Everything everything(false);
  const int scale = static_cast<int>(everything.theta.size());
  everything.theta.insert(everything.theta.end(), {1.1, 0.05});
  const std::vector<double> force = noise(200, 41, 20.0);
  std::vector<double> shifted = force;
  for (double& f : shifted) f = 1.1 * f + 0.05;
  const std::vector<Sensor> sensors = displacements(2);
  const std::vector<Signal> observed{
      {noise(200, 43), Coefficient::of_parameter(scale), Coefficient::of_parameter(scale + 1)},
      {noise(200, 47)}};
  // The same scale and offset as parameters of the force, and applied to its samples.
  const Misfit misfit(Simulator(everything.chain,
                                {.sample_rate_hz = 50.0,
                                 .forces = {{.mass = 1,
                                             .signal = {force, Coefficient::of_parameter(scale),
                                                        Coefficient::of_parameter(scale + 1)}}}},
                                sensors),
                      observed, 50);
  const Simulator plain(everything.chain,
                        {.sample_rate_hz = 50.0, .forces = {{.mass = 1, .signal = {shifted}}}},
                        sensors);
  ASSERT_EQ(misfit.samples(), 150);
  std::vector<double> sums(2), residuals(300);
  misfit.sums_of_squares(everything.theta, 1, sums);
  ASSERT_TRUE(misfit.residuals(everything.theta, residuals));
  const Response response = plain.simulate(everything.theta);
  for (std::size_t c = 0; c < 2; ++c) {
    double sum = 0.0;
    for (std::size_t n = 0; n < 150; ++n) {
      const double seen =
          observed[c].samples[n + 50] * (c == 0 ? 1.1 : 1.0) + (c == 0 ? 0.05 : 0.0);
      const double r =
          seen - response.values(static_cast<Eigen::Index>(n + 50), static_cast<Eigen::Index>(c));
      EXPECT_NEAR(residuals[c * 150 + n], r, 1e-12);
      sum += r * r;
    }
    EXPECT_NEAR(sums[c], sum, 1e-10 * sum);
  }
}

TEST(Misfit, StopsIfTheSumsExceedTheLimit) {
  const std::vector<double> force = noise(5000, 41, 20.0);
  const Excitation drive{.sample_rate_hz = 50.0, .forces = {{.mass = 1, .signal = {force}}}};
  const std::vector<std::vector<Law>> kinds{
      {}, {make_law<laws::Bilinear>({30.0}, Side::opening)}, {make_law<laws::Cubic>({10.0})}};
  for (const std::vector<Law>& laws : kinds) {
    const Chain chain{.masses = {2.0},
                      .links = {{.stiffness = 50.0, .damping = 1.0, .laws = laws}}};
    const Misfit misfit(Simulator(chain, drive, {{.mass = 1}}), {{noise(5000, 43)}});
    std::vector<double> sums(1), within(1);
    const std::vector<double> none, weight{0.5};
    misfit.sums_of_squares(none, 1, sums);
    ASSERT_TRUE(misfit.sums_of_squares_within(none, weight, 0.5 * sums[0] * (1 + 1e-14), within));
    EXPECT_EQ(within[0], sums[0]);
    EXPECT_FALSE(misfit.sums_of_squares_within(none, weight, 0.5 * sums[0] * (1 - 1e-14), within));
    EXPECT_FALSE(misfit.sums_of_squares_within(none, weight, 0.01 * sums[0], within));
  }
}

// Each of several vectors by its own limit, independent of the others: with fixed and with adaptive
// steps.
TEST(Misfit, StopsEachVectorAtItsOwnLimit) {
  const std::vector<double> force = noise(3000, 41, 20.0);
  const Excitation drive{.sample_rate_hz = 50.0, .forces = {{.mass = 1, .signal = {force}}}};
  const Coefficient unknown = Coefficient::of_parameter(0);
  for (const Law& law :
       {make_law<laws::Cubic>({unknown}), make_law<laws::QuadraticDamping>({unknown}),
        make_law<laws::Contact>({20.0, unknown})}) {
    const Chain chain{.masses = {2.0},
                      .links = {{.stiffness = 50.0, .damping = 1.0, .laws = {law}}}};
    const Misfit misfit(Simulator(chain, drive, {{.mass = 1}}), {{noise(3000, 43)}});
    std::vector<double> x(11), sums(11), within(11), limits(11);
    const std::vector<double> weights(11, 0.5);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = 0.05 * static_cast<double>(i + 1);
    misfit.sums_of_squares(x, 11, sums);
    for (std::size_t i = 0; i < x.size(); ++i)
      limits[i] = 0.5 * sums[i] * (i % 3 == 0 ? 1e-3 : i % 3 == 1 ? 1.0 - 1e-14 : 1.0 + 1e-14);
    misfit.sums_of_squares_within(x, 11, weights, limits, within);
    for (std::size_t i = 0; i < x.size(); ++i)
      EXPECT_EQ(within[i], i % 3 == 2 ? sums[i] : HUGE_VAL) << i;
  }
}

TEST(Simulator, FailsIfTheTrajectoryDiverges) {
  const Coefficient k3 = Coefficient::of_parameter(0);
  const Chain chain{.masses = {1.0},
                    .links = {{.stiffness = 1.0, .laws = {make_law<laws::Cubic>({k3})}}}};
  const Misfit misfit(Simulator(chain,
                                {.sample_rate_hz = 100.0,
                                 .forces = {{.mass = 1, .signal = {noise(5000, 1, 50.0)}}}},
                                displacements(1)),
                      {{noise(5000, 2)}});
  const std::vector<double> thetas{1.0, -5.0, 2.0, -1.0};
  std::vector<double> sums(4);
  misfit.sums_of_squares(thetas, 4, sums);
  EXPECT_TRUE(std::isfinite(sums[0]));
  EXPECT_EQ(sums[1], std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isfinite(sums[2]));
  EXPECT_EQ(sums[3], std::numeric_limits<double>::infinity());
  const Response response = misfit.simulator().simulate(std::span(thetas).subspan(1, 1));
  EXPECT_TRUE(response.failed);
  EXPECT_EQ(response.values.size(), 0);

  Chain unstable = uniform_chain(2);  // e^{13 t}: beyond the bound, and finite
  unstable.links[1].stiffness = -1000.0;
  const Simulator linear(
      unstable, {.sample_rate_hz = 100.0, .forces = {{.mass = 1, .signal = {noise(500, 3)}}}},
      displacements(2));
  EXPECT_TRUE(linear.simulate({}).failed);
  Chain weightless = uniform_chain(1);
  weightless.masses[0] = Coefficient::of_parameter(0);
  const Simulator impossible(
      weightless, {.sample_rate_hz = 100.0, .forces = {{.mass = 1, .signal = {noise(500, 3)}}}},
      displacements(1));
  const double mass = -1.0;
  EXPECT_TRUE(impossible.simulate({&mass, 1}).failed);
  EXPECT_EQ(impossible.substeps({&mass, 1}), -1);
}

// Energy of an undamped chain in free vibration, with springs of every kind.
TEST(Simulator, ConservesTheEnergyOfAConservativeChain) {
  const double k = 40.0, k2 = 20.0, k3 = 300.0, kb = 60.0, kl = 500.0, gap = 0.03;
  Chain chain{.masses = {1.0, 2.0, 1.5}};
  for (int i = 0; i < 3; ++i) chain.links.push_back({.a = i, .b = i + 1, .stiffness = k});
  std::vector<Sensor> sensors = displacements(3);
  for (int i = 1; i <= 3; ++i) sensors.push_back({.mass = i, .quantity = Quantity::velocity});
  const auto drift = [&](bool springs, bool stops, int substeps) {
    chain.links[0].laws.clear();
    if (springs)
      chain.links[0].laws = {make_law<laws::Quadratic>({k2}), make_law<laws::Cubic>({k3})};
    chain.links[1].laws = {make_law<laws::Contact>({stops ? kl : 0.0, gap}, Side::closing)};
    chain.links[2].laws = {make_law<laws::Bilinear>({stops ? kb : 0.0}, Side::opening)};
    const Response r =
        Simulator(chain,
                  {.sample_rate_hz = 100.0,
                   .forces = {{.mass = 1, .signal = {std::vector<double>(2000)}}}},
                  sensors, {.displacement = {0.1, -0.2, 0.15}, .velocity = {0.5, 0.0, -0.5}},
                  {.substeps = substeps})
            .simulate({});
    const auto energy = [&](Eigen::Index n) {
      const Eigen::VectorXd x = r.values.row(n);
      const double e1 = x(0), e2 = x(1) - x(0), e3 = x(2) - x(1);
      const double pressed = std::min(0.0, e2 + gap), opened = std::max(0.0, e3);
      return 0.5 * (1.0 * x(3) * x(3) + 2.0 * x(4) * x(4) + 1.5 * x(5) * x(5)) +
             0.5 * k * (e1 * e1 + e2 * e2 + e3 * e3) +
             (springs ? k2 * e1 * e1 * e1 / 3.0 + k3 * std::pow(e1, 4) / 4.0 : 0.0) +
             (stops ? 0.5 * kl * pressed * pressed + 0.5 * kb * opened * opened : 0.0);
    };
    double worst = 0.0;
    for (Eigen::Index n = 0; n < r.values.rows(); ++n)
      worst = std::max(worst, std::abs(energy(n) / energy(0) - 1.0));
    return worst;
  };
  EXPECT_LT(drift(true, false, 8), 1e-7);
  EXPECT_GT(drift(true, false, 2) / drift(true, false, 8),
            0.5 * std::pow(4.0, 5));       // numerical dissipation of fifth order
  EXPECT_LT(drift(false, true, 0), 1e-8);  // in pieces between switches
  EXPECT_LT(drift(true, true, 0), 1e-7);   // also with smooth springs
  EXPECT_LT(drift(true, true, 32),
            1e-4);  // a step across a stop has an error of third order
}

// Free decay: mechanical energy, including that stored by hysteresis (k e_y² ζ²/2), never grows.
TEST(Simulator, DampingLawsDissipate) {
  const double k = 50.0, kh = 80.0, yield = 0.02;
  const std::vector<std::vector<Law>> cases{{make_law<laws::QuadraticDamping>({0.8})},
                                            {make_law<laws::Coulomb>({1.0, 0.02})},
                                            {make_law<laws::BoucWen>({kh, yield, 2.0, 0.7, 0.3})},
                                            {make_law<laws::BoucWen>({kh, yield})}};
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const bool hysteretic = i >= 2;
    Chain chain{.masses = {1.0}, .links = {{.stiffness = k, .laws = cases[i]}}};
    const Response r = Simulator(chain,
                                 {.sample_rate_hz = 200.0,
                                  .forces = {{.mass = 1, .signal = {std::vector<double>(1000)}}}},
                                 {{.mass = 1},
                                  {.mass = 1, .quantity = Quantity::velocity},
                                  {.mass = 1, .quantity = Quantity::acceleration}},
                                 {.displacement = {0.3}, .velocity = {0.0}}, {.substeps = 8})
                           .simulate({});
    double last = std::numeric_limits<double>::infinity(), first = 0.0;
    for (Eigen::Index n = 0; n < r.values.rows(); ++n) {
      const double y = r.values(n, 0), v = r.values(n, 1);
      const double zeta = hysteretic ? (-r.values(n, 2) - k * y) / (kh * yield) : 0.0;
      EXPECT_LE(std::abs(zeta), 1.0 + 1e-9);
      const double energy = 0.5 * v * v + 0.5 * k * y * y + 0.5 * kh * yield * yield * zeta * zeta;
      EXPECT_LE(energy, last * (1.0 + 1e-7)) << "law " << i << ", sample " << n;
      last = energy;
      if (n == 0) first = energy;
    }
    EXPECT_LT(last, 0.5 * first);
  }
}

TEST(Simulator, ChoosesStepsFromTheStiffestBranch) {
  const Coefficient kl = Coefficient::of_parameter(0);
  Chain chain{.masses = {2.0},
              .links = {{.stiffness = 8.0, .laws = {make_law<laws::Contact>({kl, 0.1})}}}};
  const Excitation drive{.sample_rate_hz = 10.0,
                         .forces = {{.mass = 1, .signal = {std::vector<double>(10)}}}};
  const auto steps = [&](double value, SimulatorOptions options) {
    return Simulator(chain, drive, displacements(1), {}, std::move(options)).substeps({&value, 1});
  };
  const Integrator runge_kutta = Integrator::runge_kutta;
  EXPECT_EQ(steps(-1.0, {.integrator = runge_kutta}), 2);   // ω h = 0.2
  EXPECT_EQ(steps(60.0, {.integrator = runge_kutta}), 3);   // 0.6
  EXPECT_EQ(steps(192.0, {.integrator = runge_kutta}), 6);  // ω h = 1.0 needs 5
  EXPECT_EQ(steps(192.0, {.integrator = runge_kutta, .step_limit = 0.5}), 2);
  EXPECT_EQ(steps(192.0, {.substeps = 7}), 7);
  EXPECT_EQ(steps(1e12, {.integrator = runge_kutta}), -1);
  EXPECT_EQ(steps(60.0, {}), 1);  // pieces, 0.7 / ω long at most
  EXPECT_EQ(steps(192.0, {}), 2);
  chain.links[0].laws = {make_law<laws::Cubic>({kl})};
  EXPECT_EQ(steps(20.0, {.extension = {1.0}}), 3);
  EXPECT_EQ(steps(20.0, {}), 1);
  chain.links[0].laws = {make_law<laws::Coulomb>({kl, 0.01})};
  EXPECT_EQ(steps(0.6, {}), 3);  // creep rate F/(v m) = 30 /s
}

TEST(Simulator, RejectsInvalidInput) {
  const Chain chain = uniform_chain(2);
  const Excitation drive{.sample_rate_hz = 10.0,
                         .forces = {{.mass = 1, .signal = {std::vector<double>(10)}}}};
  const auto refuses = [](const Chain& c, const Excitation& e, const std::vector<Sensor>& s,
                          const InitialState& i = {}, const SimulatorOptions& o = {}) {
    EXPECT_THROW(Simulator(c, e, s, i, o), std::invalid_argument);
  };
  const std::vector<Sensor> sensor{{.mass = 1}};
  EXPECT_NO_THROW(Simulator(chain, drive, sensor));
  refuses({}, drive, sensor);
  refuses(chain, drive, {});
  refuses(chain, drive, {{.mass = 3}});
  refuses(chain, {.sample_rate_hz = 10.0}, sensor);
  refuses(chain, {.sample_rate_hz = 0.0, .forces = drive.forces}, sensor);
  refuses(chain,
          {.sample_rate_hz = 10.0, .forces = {{.mass = 0, .signal = {std::vector<double>(10)}}}},
          sensor);
  refuses(chain,
          {.sample_rate_hz = 10.0,
           .forces = {{.mass = 1, .signal = {std::vector<double>(10)}},
                      {.mass = 2, .signal = {std::vector<double>(9)}}}},
          sensor);
  refuses(chain, {.sample_rate_hz = 10.0, .forces = {{.mass = 1, .signal = {{0.0, std::nan("")}}}}},
          sensor);
  refuses(chain, {.sample_rate_hz = 10.0, .base = BaseMotion{}}, sensor);
  refuses(chain,
          {.sample_rate_hz = 10.0, .base = BaseMotion{.acceleration = {std::vector<double>(10)}}},
          sensor);
  refuses(chain, drive, sensor, {.displacement = {1.0}});
  refuses(chain, drive, sensor, {}, {.extension = {1.0}});
  refuses(chain, drive, sensor, {}, {.stride = 0});
  Chain cubic = chain;
  cubic.links[0].laws = {make_law<laws::Cubic>({1.0})};
  refuses(cubic, drive, sensor, {}, {.integrator = Integrator::exact});
  refuses(cubic, drive, sensor, {}, {.integrator = Integrator::piecewise});
  refuses(chain, drive, sensor, {}, {.integrator = Integrator::piecewise});
  Chain rubbing = chain;
  rubbing.links.front().laws = {make_law<laws::Coulomb>({1.0, 0.01})};
  refuses(rubbing, drive, sensor, {}, {.integrator = Integrator::series});
  Chain wrong = chain;
  wrong.links[0].b = 3;
  refuses(wrong, drive, sensor);
  wrong = chain;
  wrong.masses[1] = 0.0;
  refuses(wrong, drive, sensor);
  wrong = chain;
  wrong.links[0].laws = {make_law<laws::Contact>({1.0, -0.1})};
  refuses(wrong, drive, sensor);

  const Simulator simulator(chain, drive, sensor);
  EXPECT_THROW(Misfit(simulator, {}), std::invalid_argument);
  EXPECT_THROW(Misfit(simulator, {{std::vector<double>(9)}}), std::invalid_argument);
  EXPECT_THROW(Misfit(simulator, {{std::vector<double>(10)}}, 10), std::invalid_argument);
  EXPECT_THROW(Misfit(simulator, {{std::vector<double>(10, std::nan(""))}}), std::invalid_argument);
}

}  // namespace
