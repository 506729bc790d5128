// Each integrator against closed-form solutions and the other integrators.
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "dynamics/simulate.hpp"
#include "tests/dynamics/chains.hpp"

namespace integrators_test {
namespace {

using namespace wheeltap::dynamics;

/// Circular frequency from the first and last upward zero crossings of the displacement, each found
/// as the root of the quintic Hermite interpolant of displacement, velocity and acceleration.
double frequency(const Response& response, double rate) {
  const auto crossing = [&](Eigen::Index n) {
    const double h = 1.0 / rate;
    const double y0 = response.values(n, 0), y1 = response.values(n + 1, 0);
    const double v0 = h * response.values(n, 1), v1 = h * response.values(n + 1, 1);
    const double a0 = h * h * response.values(n, 2), a1 = h * h * response.values(n + 1, 2);
    double lo = 0.0, hi = 1.0;
    for (int i = 0; i < 60; ++i) {
      const double s = 0.5 * (lo + hi);
      const double c3 = 10 * (y1 - y0) - 6 * v0 - 4 * v1 - 1.5 * a0 + 0.5 * a1;
      const double c4 = -15 * (y1 - y0) + 8 * v0 + 7 * v1 + 1.5 * a0 - a1;
      const double c5 = 6 * (y1 - y0) - 3 * v0 - 3 * v1 - 0.5 * a0 + 0.5 * a1;
      const double y = y0 + s * (v0 + s * (0.5 * a0 + s * (c3 + s * (c4 + s * c5))));
      (y < 0.0 ? lo : hi) = s;
    }
    return (static_cast<double>(n) + lo) * h;
  };
  std::vector<double> crossings;
  for (Eigen::Index n = 0; n + 1 < response.values.rows(); ++n)
    if (response.values(n, 0) < 0.0 && response.values(n + 1, 0) >= 0.0)
      crossings.push_back(crossing(n));
  return 2.0 * wheeltap::kPi * static_cast<double>(crossings.size() - 1) /
         (crossings.back() - crossings.front());
}

// ẍ + x + x³ = 0 released at A: its frequencies by elliptic integrals, to 1e-8.
TEST(RungeKutta, DuffingFreeVibration) {
  struct Case {
    double amplitude, omega;
  };
  for (const Case& c : {Case{0.1, 1.00374184}, Case{0.5, 1.08915818}, Case{1.0, 1.31777606},
                        Case{2.0, 1.97601636}}) {
    Link spring{.stiffness = 1.0, .laws = {make_law<laws::Cubic>({1.0})}};
    const auto simulator = released(spring, c.amplitude, 100.0, 4000, {.substeps = 4});
    EXPECT_NEAR(frequency(simulator.simulate({}), 100.0), c.omega, 1e-8) << c.amplitude;
  }
}

TEST(RungeKutta, ConvergesAtFourthOrderOnDuffing) {
  Link spring{.stiffness = 1.0, .laws = {make_law<laws::Cubic>({1.0})}};
  // ω(A = 2) from the complete elliptic integral by the arithmetic-geometric mean:
  // ω = π √(1 + A²) / (2 K(m)), m = A² / (2 (1 + A²)).
  double a = 1.0, b = std::sqrt(1.0 - 4.0 / 10.0);
  for (int i = 0; i < 20; ++i) {
    const double mean = 0.5 * (a + b);
    b = std::sqrt(a * b);
    a = mean;
  }
  const double omega = std::sqrt(5.0) * a;
  EXPECT_NEAR(omega, 1.97601636, 5e-9);
  const auto error = [&](int substeps) {
    const Response response = released(spring, 2.0, 25.0, 500, {.substeps = substeps}).simulate({});
    return std::abs(frequency(response, 25.0) - omega);
  };
  // Over 20 s, the amplitude error of fifth order does not yet change the frequency.
  const double e1 = error(2), e2 = error(4), e4 = error(8);
  EXPECT_NEAR(std::log2(e1 / e2), 4.0, 0.3);
  EXPECT_NEAR(std::log2(e2 / e4), 4.0, 0.2);
}

// The textbook scheme for scalars.
TEST(RungeKutta, MatchesTheTextbookScheme) {
  const double m = 5.0, k = 50.0, c = 0.1, k3 = 1000.0, h = 0.01;
  const std::vector<double> force = noise(400, 61, 20.0);
  using State = Eigen::Matrix<double, 6, 1>;
  const auto derivative = [&](const State& x, double f) {
    const auto tension = [&](int link) {
      const double e = x(link) - (link > 0 ? x(link - 1) : 0.0);
      const double rate = x(3 + link) - (link > 0 ? x(2 + link) : 0.0);
      return k * e + c * rate + (link == 1 ? k3 * e * e * e : 0.0);
    };
    State d;
    d << x.tail<3>(), (f - tension(0) + tension(1)) / m, (tension(2) - tension(1)) / m,
        -tension(2) / m;
    return d;
  };
  State x = State::Zero();
  Eigen::MatrixXd expected(400, 3);
  for (std::size_t n = 0; n < 400; ++n) {
    expected.row(static_cast<Eigen::Index>(n)) = x.head<3>().transpose();
    if (n == 399) break;
    const double middle = 0.5 * (force[n] + force[n + 1]);
    const State k1 = derivative(x, force[n]), k2 = derivative(x + 0.5 * h * k1, middle);
    const State k3rd = derivative(x + 0.5 * h * k2, middle);
    const State k4 = derivative(x + h * k3rd, force[n + 1]);
    x += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3rd + k4);
  }
  Chain chain = uniform_chain(3);
  chain.links[1].laws = {make_law<laws::Cubic>({k3})};
  const Simulator simulator(chain,
                            {.sample_rate_hz = 100.0, .forces = {{.mass = 1, .signal = {force}}}},
                            displacements(3), {}, {.substeps = 1});
  for (const Response& response : simulator.simulate_batch({}, 5))  // the same in every lane
    EXPECT_LT((response.values - expected).cwiseAbs().maxCoeff(),
              1e-12 * expected.cwiseAbs().maxCoeff());
}

// Zero gap: half periods of the two branches, ω = 2 ω₁ ω₂ / (ω₁ + ω₂).
TEST(RungeKutta, BilinearFrequency) {
  for (Side side : {Side::opening, Side::closing}) {
    Link link{.stiffness = 1.0, .laws = {make_law<laws::Bilinear>({3.0}, side)}};
    const auto simulator = released(link, 1.0, 100.0, 6000, {.substeps = 8});
    EXPECT_NEAR(frequency(simulator.simulate({}), 100.0), 2.0 * 1.0 * 2.0 / (1.0 + 2.0), 1e-6);
  }
}

// Released at 1 against a stop at -gap, sampled finely and coarsely (ω h = 0.1 to 4): the closed
// solution, arcs of cosines of frequency 1 and ω_c = √(1 + k). At a gap of 0 this is the bilinear
// oscillator; near 1 it only grazes the stop, between two samples.
TEST(Piecewise, FreeVibrationAgainstAStop) {
  const double k = 3.0, wc = 2.0;
  for (const double gap : {0.0, 0.5, 0.9, 0.99, 0.999, 0.99999, 1.0, 1.5})
    for (const double step : {0.05, 0.3, 0.7, 2.0}) {
      const bool touches = gap < 1.0;
      const double speed = touches ? std::sqrt(1.0 - gap * gap) : 0.0;
      const double enters = touches ? std::acos(-gap) : wheeltap::kPi;  // after release
      const double inside = touches ? 2.0 / wc * std::atan2(speed * wc, gap) : 0.0;
      const double period = 2.0 * enters + inside;
      const double centre = -k * gap / (1.0 + k);
      const auto closed = [&](double t) {
        t = std::fmod(t, period);
        if (t <= enters) return std::cos(t);
        if (t >= enters + inside) return std::cos(period - t);
        const double s = wc * (t - enters);
        return centre + (-gap - centre) * std::cos(s) - speed / wc * std::sin(s);
      };
      const Law law = gap > 0.0 ? make_law<laws::Contact>({k, gap}, Side::closing)
                                : make_law<laws::Bilinear>({k}, Side::closing);
      const Response response =
          released({.stiffness = 1.0, .laws = {law}}, 1.0, 1.0 / step, 400, {}).simulate({});
      double worst = 0.0;
      for (Eigen::Index n = 0; n < 400; ++n)
        worst = std::max(worst,
                         std::abs(response.values(n, 0) - closed(step * static_cast<double>(n))));
      EXPECT_LT(worst, 1e-7) << "gap " << gap << ", step " << step;
    }
}

TEST(Piecewise, BilinearFrequency) {
  for (Side side : {Side::opening, Side::closing}) {
    Link link{.stiffness = 1.0, .laws = {make_law<laws::Bilinear>({3.0}, side)}};
    const auto simulator = released(link, 1.0, 100.0, 6000, {});
    EXPECT_NEAR(frequency(simulator.simulate({}), 100.0), 4.0 / 3.0, 1e-9);
  }
}

// The rig of Tiboaca 2016, section 6.3, at a high amplitude: Runge-Kutta converges to the piecewise
// solution with decreasing steps, at every sample.
TEST(Piecewise, AgreesWithRungeKutta) {
  Chain chain{.masses = {6.6450, 6.7713},
              .links = {{.a = 0, .b = 1, .stiffness = 465e3, .damping = 61.1},
                        {.a = 1,
                         .b = 2,
                         .stiffness = 510e3,
                         .damping = 12.5,
                         .laws = {make_law<laws::Contact>({830e3, 1e-4}, Side::closing)}}}};
  const Excitation drive{.sample_rate_hz = 1024.0,
                         .base = BaseMotion{.acceleration = {noise(3000, 53, 60.0)}}};
  const std::vector<Sensor> sensors{
      {.mass = 1, .quantity = Quantity::acceleration},
      {.mass = 2, .frame = Frame::relative},
      {.mass = 2, .quantity = Quantity::velocity, .frame = Frame::relative}};
  const auto run = [&](Integrator integrator, int substeps) {
    return Simulator(chain, drive, sensors, {}, {.integrator = integrator, .substeps = substeps})
        .simulate({})
        .values;
  };
  const Eigen::MatrixXd reference = run(Integrator::automatic, 0);
  const auto error = [&](const Eigen::MatrixXd& values) {
    return ((values - reference).colwise().norm().array() / reference.colwise().norm().array())
        .maxCoeff();
  };
  EXPECT_LT(error(run(Integrator::piecewise, 8)), 1e-8);
  const double coarse = error(run(Integrator::runge_kutta, 32));
  const double fine = error(run(Integrator::runge_kutta, 512));
  EXPECT_LT(fine, 1e-6);
  EXPECT_GT(coarse / fine, 0.25 * 16.0 * 16.0);  // second order, since steps cross the stop
  // The mass must touch the stop, otherwise the test proves nothing.
  chain.links[1].laws.clear();
  EXPECT_GT(error(run(Integrator::exact, 0)), 0.05);
}

// A likelihood is as smooth as the response: second differences in the gap decrease with the square
// of their step. Steps across the stop make the response rugged.
TEST(Piecewise, IsSmoothInTheGap) {
  const Coefficient gap = Coefficient::of_parameter(0);
  const Chain chain{.masses = {1.0},
                    .links = {{.stiffness = 400.0,
                               .damping = 0.4,
                               .laws = {make_law<laws::Contact>({2000.0, gap}, Side::closing)}}}};
  const Excitation drive{.sample_rate_hz = 100.0,
                         .forces = {{.mass = 1, .signal = {noise(300, 7, 40.0)}}}};
  const auto second_difference = [&](Integrator integrator, double step) {
    const Simulator simulator(chain, drive, displacements(1), {}, {.integrator = integrator});
    const auto at = [&](double value) -> Eigen::MatrixXd {
      return simulator.simulate({&value, 1}).values;
    };
    return (at(0.02 + step) - 2.0 * at(0.02) + at(0.02 - step)).norm();
  };
  const auto ratio = [&](Integrator integrator) {
    return second_difference(integrator, 4e-6) / second_difference(integrator, 1e-6);
  };
  EXPECT_NEAR(ratio(Integrator::piecewise), 16.0, 1.0);
  EXPECT_GT(std::abs(ratio(Integrator::runge_kutta) - 16.0), 3.0);
}

// Twenty periods of the Duffing oscillator against its period by the arithmetic-geometric mean;
// Runge-Kutta with automatic steps is a hundred times less accurate.
TEST(Series, DuffingFreeVibration) {
  const double amplitude = 2.0;
  double a = 1.0,
         b = std::sqrt(1.0 - amplitude * amplitude / (2.0 * (1.0 + amplitude * amplitude)));
  for (int i = 0; i < 20; ++i) std::tie(a, b) = std::pair(0.5 * (a + b), std::sqrt(a * b));
  const double period = 2.0 * wheeltap::kPi / (std::sqrt(1.0 + amplitude * amplitude) * a);
  const Link spring{.stiffness = 1.0, .laws = {make_law<laws::Cubic>({1.0})}};
  const auto error = [&](SimulatorOptions options) {
    options.extension = {amplitude};
    const Eigen::MatrixXd y =
        released(spring, amplitude, 64.0 / period, 1281, options).simulate({}).values;
    // A quarter period before: 0.
    return std::abs(y(1280, 0) - amplitude) + std::abs(y(1280 - 16, 0));
  };
  EXPECT_LT(error({.prefer_series = true}), 1e-8);
  EXPECT_GT(error({}), 1e-6);
}

// Quadratic, cubic, bilinear and contact springs on one chain: against Runge-Kutta with steps so
// fine that those across a stop are accurate.
TEST(Series, AgreesWithRungeKutta) {
  Chain chain{.masses = {1.0, 2.0, 1.5}};
  for (int i = 0; i < 3; ++i)
    chain.links.push_back({.a = i, .b = i + 1, .stiffness = 40.0, .damping = 0.2});
  chain.links.push_back({.a = 0, .b = 3, .stiffness = 10.0});
  chain.links[0].laws = {make_law<laws::Quadratic>({20.0}), make_law<laws::Cubic>({300.0}),
                         make_law<laws::Bilinear>({15.0}, Side::closing)};
  chain.links[1].laws = {make_law<laws::Contact>({500.0, 0.03}, Side::closing)};
  chain.links[3].laws = {make_law<laws::Cubic>({200.0})};
  const Excitation drive{.sample_rate_hz = 25.0,
                         .forces = {{.mass = 2, .signal = {noise(400, 3, 60.0)}}}};
  const auto run = [&](SimulatorOptions options) {
    return Simulator(chain, drive, displacements(3), {}, std::move(options)).simulate({}).values;
  };
  const Eigen::MatrixXd series = run({});
  const auto error = [&](const Eigen::MatrixXd& values) {
    return (values - series).norm() / series.norm();
  };
  const double coarse = error(run({.substeps = 64})), fine = error(run({.substeps = 1024}));
  EXPECT_LT(fine, 1e-5);
  EXPECT_GT(coarse / fine, 64.0);
  EXPECT_LT(error(run({.step_limit = 0.05})), 1e-7);
  chain.links[1].laws.clear();
  EXPECT_GT(error(run({})), 0.05);  // the gap closes
}

/// Mode by mode, each with the closed solution of q̈ + 2ζω q̇ + ω² q = p₀ + p′ t over a step.
Eigen::MatrixXd modal_superposition(const Chain& chain, const Eigen::MatrixXd& force, double h,
                                    const Eigen::VectorXd& y0, const Eigen::VectorXd& v0) {
  const LinearMatrices m = linear_matrices(chain, {});
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> modes(m.stiffness, m.mass);
  const Eigen::MatrixXd& shapes = modes.eigenvectors();  // mass-normalised
  const Eigen::MatrixXd damping = shapes.transpose() * m.damping * shapes;
  const Eigen::MatrixXd p = force * shapes;
  Eigen::VectorXd q = shapes.transpose() * m.mass * y0, dq = shapes.transpose() * m.mass * v0;
  Eigen::MatrixXd y(force.rows(), force.cols());
  for (Eigen::Index n = 0;; ++n) {
    y.row(n) = (shapes * q).transpose();
    if (n + 1 == force.rows()) return y;
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const double w2 = modes.eigenvalues()(i), a = 0.5 * damping(i, i), wd = std::sqrt(w2 - a * a);
      const double rate = (p(n + 1, i) - p(n, i)) / h;
      const double beta = rate / w2, alpha = (p(n, i) - 2.0 * a * beta) / w2;
      const double c = q(i) - alpha, s = (dq(i) - beta + a * c) / wd;
      const double decay = std::exp(-a * h), cosine = std::cos(wd * h), sine = std::sin(wd * h);
      q(i) = decay * (c * cosine + s * sine) + alpha + beta * h;
      dq(i) = decay * ((s * wd - a * c) * cosine - (c * wd + a * s) * sine) + beta;
    }
  }
}

TEST(Exact, AgreesWithModalSuperposition) {
  for (int masses : {1, 3, 7}) {
    const Chain chain = uniform_chain(masses);
    const std::vector<double> force = noise(2000, 7, 10.0);
    for (double rate : {100.0, 1.0}) {  // ω h up to 0.06 and 6
      const std::size_t samples = rate > 50.0 ? 2000 : 300;
      const std::vector<double> f(force.begin(),
                                  force.begin() + static_cast<std::ptrdiff_t>(samples));
      InitialState initial;
      Eigen::MatrixXd forces = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(samples), masses);
      forces.col(0) = Eigen::Map<const Eigen::VectorXd>(f.data(), forces.rows());
      Eigen::VectorXd y0(masses), v0(masses);
      for (int i = 0; i < masses; ++i) {
        y0(i) = 0.1 * i - 0.2;
        v0(i) = 0.3 - 0.1 * i;
        initial.displacement.emplace_back(y0(i));
        initial.velocity.emplace_back(v0(i));
      }
      const Simulator simulator(chain,
                                {.sample_rate_hz = rate, .forces = {{.mass = 1, .signal = {f}}}},
                                displacements(masses), initial);
      const Response response = simulator.simulate({});
      ASSERT_FALSE(response.failed);
      EXPECT_EQ(response.substeps, 0);
      const Eigen::MatrixXd reference = modal_superposition(chain, forces, 1.0 / rate, y0, v0);
      EXPECT_LT((response.values - reference).cwiseAbs().maxCoeff(),
                1e-10 * reference.cwiseAbs().maxCoeff())
          << masses << " masses at " << rate << " Hz";
    }
  }
}

TEST(Exact, IsTheLimitOfRungeKutta) {
  const Chain chain = uniform_chain(3);
  const Excitation drive{.sample_rate_hz = 10.0,
                         .forces = {{.mass = 2, .signal = {noise(500, 3, 10.0)}}}};
  std::vector<Sensor> sensors;
  for (Quantity q : {Quantity::displacement, Quantity::velocity, Quantity::acceleration})
    for (int mass : {1, 3}) sensors.push_back({.mass = mass, .quantity = q});
  const Response exact = Simulator(chain, drive, sensors).simulate({});
  const auto error = [&](int substeps) {
    const Response response =
        Simulator(chain, drive, sensors, {}, {.substeps = substeps}).simulate({});
    EXPECT_EQ(response.substeps, substeps);
    return ((response.values - exact.values).cwiseAbs().colwise().maxCoeff().array() /
            exact.values.cwiseAbs().colwise().maxCoeff().array())
        .maxCoeff();
  };
  const double e4 = error(4), e8 = error(8);
  EXPECT_NEAR(std::log2(e4 / e8), 4.0, 0.1);
  EXPECT_LT(error(256), 1e-10);
}

// Between samples the force is linear, so interpolation to twice the rate changes nothing.

}  // namespace

}  // namespace integrators_test
