// Exact dry friction against closed-form solutions, and against an independent integrator: it tries
// all regimes, and uses matrix exponentials between events and bisection for their times.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "dynamics/simulate.hpp"
#include "tests/dynamics/chains.hpp"

namespace {

using namespace wheeltap::dynamics;

Law dry(Coefficient force) {
  return make_law<laws::Coulomb>({force});
}

std::vector<Sensor> motion_of(int mass) {
  return {{.mass = mass, .frame = Frame::relative},
          {.mass = mass, .quantity = Quantity::velocity, .frame = Frame::relative},
          {.mass = mass, .quantity = Quantity::acceleration, .frame = Frame::relative}};
}

Excitation no_force(double rate, std::size_t samples) {
  return {.sample_rate_hz = rate,
          .forces = {{.mass = 1, .signal = {std::vector<double>(samples)}}}};
}

/// m ÿ + k y ± F = 0 released at x0: half periods of cosines about ±F/k, until |y| <= F/k where
/// they end.
struct FreeDecay {
  double mass, stiffness, force, x0;

  [[nodiscard]] std::tuple<double, double, double> at(double t) const {
    const double omega = std::sqrt(stiffness / mass), shift = force / stiffness;
    double x = x0;
    while (std::abs(x) > shift) {
      const double centre = x > 0.0 ? shift : -shift, amplitude = x - centre;
      if (t <= wheeltap::kPi / omega) {
        return {centre + amplitude * std::cos(omega * t), -omega * amplitude * std::sin(omega * t),
                -omega * omega * amplitude * std::cos(omega * t)};
      }
      t -= wheeltap::kPi / omega;
      x = centre - amplitude;
    }
    return {x, 0.0, 0.0};
  }
};

// Issue 14, "It is done when" 5: extremes decrease by 2F/k per half period, then stick where |kx|
// <= F; to 1e-8, finely and coarsely sampled (ω h from 0.05 to 3.5), by series; by Runge-Kutta
// within its own accuracy.
TEST(Friction, MatchesTheFreeDecayOfAMassOnASpring) {
  const FreeDecay closed{.mass = 2.0, .stiffness = 50.0, .force = 4.0, .x0 = 1.02};
  for (const double rate : {100.0, 31.0, 10.0, 7.3, 1.43})
    for (const auto& [options, tolerance] :
         {std::pair(SimulatorOptions{}, 1e-8),
          std::pair(SimulatorOptions{.integrator = Integrator::runge_kutta, .step_limit = 0.01},
                    1e-7)}) {
      const Chain chain{.masses = {2.0}, .links = {{.stiffness = 50.0, .laws = {dry(4.0)}}}};
      const auto samples = static_cast<std::size_t>(6.0 * rate);
      const Response response = Simulator(chain, no_force(rate, samples), motion_of(1),
                                          {.displacement = {1.02}, .velocity = {0.0}}, options)
                                    .simulate({});
      ASSERT_FALSE(response.failed);
      for (std::size_t n = 0; n < samples; ++n) {
        const auto row = static_cast<Eigen::Index>(n);
        const auto [x, v, a] = closed.at(static_cast<double>(n) / rate);
        EXPECT_NEAR(response.values(row, 0), x, tolerance) << rate << " Hz, sample " << n;
        EXPECT_NEAR(response.values(row, 1), v, 10.0 * tolerance) << rate << " Hz, sample " << n;
        if (n % 7 == 1) {
          EXPECT_NEAR(response.values(row, 2), a, 100.0 * tolerance);
        }
      }
      EXPECT_EQ(response.values(response.values.rows() - 1, 2), 0.0);
    }
}

// Released where the spring force is below the friction force, the mass stays at rest exactly.
TEST(Friction, StartsInStickIfPossible) {
  for (const double x0 : {0.079, -0.0799999}) {
    const Chain chain{.masses = {2.0}, .links = {{.stiffness = 50.0, .laws = {dry(4.0)}}}};
    const Response response = Simulator(chain, no_force(20.0, 50), motion_of(1),
                                        {.displacement = {x0}, .velocity = {0.0}})
                                  .simulate({});
    EXPECT_EQ(response.values.col(0).minCoeff(), x0);
    EXPECT_EQ(response.values.col(0).maxCoeff(), x0);
    EXPECT_EQ(response.values.rightCols(2).cwiseAbs().maxCoeff(), 0.0);
  }
}

// Issue 14, "It is done when" 5: stuck to the belt until kx = F, then amplitude v/ω about F/k. Once
// per period, block and belt have equal speeds, at the limit of sticking.
TEST(Friction, MatchesABlockOnABelt) {
  const double k = 30.0, m = 1.2, force = 6.0, v = 0.4, omega = std::sqrt(k / m);
  const Chain chain{
      .masses = {m, 1e13},
      .links = {{.a = 0, .b = 1, .stiffness = k}, {.a = 1, .b = 2, .laws = {dry(force)}}}};
  for (const double rate : {200.0, 23.0, 3.1}) {
    const auto samples = static_cast<std::size_t>(8.0 * rate);
    const Response response = Simulator(chain, no_force(rate, samples), motion_of(1),
                                        {.displacement = {0.0, 0.0}, .velocity = {v, v}})
                                  .simulate({});
    ASSERT_FALSE(response.failed);
    const double breaks = force / (k * v);
    for (std::size_t n = 0; n < samples; ++n) {
      const double t = static_cast<double>(n) / rate - breaks;
      const double x = t < 0.0 ? force / k + v * t : force / k + v / omega * std::sin(omega * t);
      EXPECT_NEAR(response.values(static_cast<Eigen::Index>(n), 0), x, 1e-8) << rate << ' ' << n;
    }
  }
}

// A block on a moving base: it sticks until m |ÿ_b| reaches F, slips, and sticks again. The base's
// acceleration increases to twice that value and decreases to zero.
TEST(Friction, BreaksAwayUnderBaseMotion) {
  const double m = 3.0, force = 1.5, rate = 40.0;
  const int peak = 40;  // samples
  const double slope = 2.0 * force / m / (peak / rate), d = 0.5 * peak / rate;
  std::vector<double> base;
  for (int n = 0; n < 160; ++n)
    base.push_back(slope * std::max(0.0, n < peak ? n : 2.0 * peak - n) / rate);
  for (const double sign : {1.0, -1.0})
    for (const Integrator integrator : {Integrator::automatic, Integrator::runge_kutta}) {
      const Response response =
          Simulator({.masses = {m}, .links = {{.laws = {dry(force)}}}},
                    {.sample_rate_hz = rate, .base = BaseMotion{.acceleration = {base, sign}}},
                    motion_of(1), {}, {.integrator = integrator})
              .simulate({});
      ASSERT_FALSE(response.failed);
      const double top = peak / rate, begins = top - d;
      for (std::size_t n = 0; n < base.size(); ++n) {
        const double t = static_cast<double>(n) / rate;
        double z = 0.0;
        if (t > begins && t <= top) z = -slope * std::pow(t - begins, 3) / 6.0;
        // From the peak on, ÿ_b - F/m = slope (D - u), until the base is at rest: -F/m.
        const auto falling = [&](double u) {
          return slope * (-d * d * d / 6.0 - d * d * u / 2.0 - d * u * u / 2.0 + u * u * u / 6.0);
        };
        const double rests = 2.0 * d;  // the base's acceleration is 0 again
        if (t > top) z = falling(std::min(t - top, rests));
        if (t > top + rests) {
          const double speed = slope * (-d * d / 2.0 - d * rests + rests * rests / 2.0);
          const double time = std::min(t - top - rests, -speed / (force / m));
          z += speed * time + 0.5 * force / m * time * time;
        }
        EXPECT_NEAR(response.values(static_cast<Eigen::Index>(n), 0), sign * z, 1e-8)
            << n << ' ' << sign;
      }
    }
}

// A direct reversal: the force at the turning point exceeds the friction force.
TEST(Friction, ReversesWithoutSticking) {
  const double m = 1.0, force = 2.0, drive = 5.0, v0 = 3.0, rate = 13.0;
  const Simulator simulator({.masses = {m}, .links = {{.laws = {dry(force)}}}},
                            {.sample_rate_hz = rate,
                             .forces = {{.mass = 1, .signal = {std::vector<double>(40, -drive)}}}},
                            motion_of(1), {.displacement = {0.0}, .velocity = {v0}});
  const Response response = simulator.simulate({});
  const double turns = v0 * m / (drive + force), top = 0.5 * v0 * turns;
  for (Eigen::Index n = 0; n < 40; ++n) {
    const double t = static_cast<double>(n) / rate;
    const double x = t < turns ? v0 * t - 0.5 * (drive + force) / m * t * t
                               : top - 0.5 * (drive - force) / m * (t - turns) * (t - turns);
    EXPECT_NEAR(response.values(n, 0), x, 1e-10);
  }
}

/// Two masses in series with friction F1 in the lower link and F2 in the upper, springs, dampers,
/// and a force on each mass that is linear over a step.
class Reference {
 public:
  using State = Eigen::Vector4d;  // y1, y2, v1, v2

  double m1 = 1.0, m2 = 0.7, k1 = 60.0, k2 = 40.0, c1 = 0.3, c2 = 0.2, force[2] = {6.0, 3.0};

  /// One step of length h in which the forces on the masses change from f0 to f0 + slope h.
  void advance(State& x, Eigen::Vector2d f0, const Eigen::Vector2d& slope, double h) {
    double done = 0.0;
    while (done < h) {
      const Eigen::Vector2d f = f0 + done * slope;
      if (!known_) choose(x, f);
      double part = std::min(h - done, kStep);
      if (!keeps(after(x, f, slope, part), f + part * slope)) {
        double low = 0.0, high = part;
        for (int i = 0; i < 60; ++i) {
          const double middle = 0.5 * (low + high);
          (keeps(after(x, f, slope, middle), f + middle * slope) ? low : high) = middle;
        }
        part = high;
        // Links whose condition is violated are at rest now.
        x = after(x, f, slope, part);
        for (int l = 0; l < 2; ++l)
          if (regime_[l] != 0 && regime_[l] * rate(x, l) <= 0.0) at_rest_[l] = true;
        for (int l = 0; l < 2; ++l)
          if (regime_[l] == 0) at_rest_[l] = true;
        known_ = false;
        ++events;
      } else {
        x = after(x, f, slope, part);
      }
      done += part;
    }
  }
  int events = 0, sticking = 0;

 private:
  static constexpr double kStep = 2e-3;
  int regime_[2] = {0, 0};
  bool known_ = false, at_rest_[2] = {true, true};

  static double rate(const State& x, int l) { return l == 0 ? x(2) : x(3) - x(2); }

  /// Accelerations and tensions of a regime: a linear system in a1, a2, T1, T2.
  [[nodiscard]] Eigen::Vector4d solve(const int* regime, const State& x,
                                      const Eigen::Vector2d& f) const {
    const double lower = k1 * x(0) + c1 * x(2), upper = k2 * (x(1) - x(0)) + c2 * (x(3) - x(2));
    Eigen::Matrix4d a;
    Eigen::Vector4d b;
    a.row(0) << m1, 0.0, 1.0, -1.0;
    a.row(1) << 0.0, m2, 0.0, 1.0;
    b.head<2>() << f(0) - lower + upper, f(1) - upper;
    a.row(2) << 1.0, 0.0, 0.0, 0.0;
    a.row(3) << -1.0, 1.0, 0.0, 0.0;
    b.tail<2>().setZero();
    for (int l = 0; l < 2; ++l) {
      if (regime[l] == 0) continue;
      a.row(2 + l).setZero();
      a(2 + l, 2 + l) = 1.0;
      b(2 + l) = regime[l] * force[l];
    }
    return a.partialPivLu().solve(b);
  }

  /// Tries all nine regimes.
  void choose(const State& x, const Eigen::Vector2d& f) {
    double best = std::numeric_limits<double>::infinity();
    int chosen[2] = {0, 0};
    for (int i = -1; i <= 1; ++i)
      for (int j = -1; j <= 1; ++j) {
        const int trial[2] = {i, j};
        const Eigen::Vector4d s = solve(trial, x, f);
        const double growth[2] = {s(0), s(1) - s(0)};
        double broken = 0.0;
        for (int l = 0; l < 2; ++l) {
          if (!at_rest_[l])
            broken += trial[l] * rate(x, l) > 0.0 ? 0.0 : 1e3;
          else if (trial[l] == 0)
            broken += std::max(0.0, std::abs(s(2 + l)) - force[l]);
          else  // slightly less preferred than sticking if both are possible
            broken += std::max(0.0, -trial[l] * growth[l]) + 1e-13;
        }
        if (broken < best) {
          best = broken;
          chosen[0] = i;
          chosen[1] = j;
        }
      }
    // At the limit, the tension is about to exceed F: the link slips to that side.
    const Eigen::Vector4d s = solve(chosen, x, f);
    for (int l = 0; l < 2; ++l) {
      regime_[l] = chosen[l];
      if (chosen[l] == 0 && std::abs(s(2 + l)) > force[l] * (1.0 - 1e-12))
        regime_[l] = s(2 + l) > 0.0 ? 1 : -1;
      at_rest_[l] = regime_[l] == 0;
      sticking += regime_[l] == 0;
    }
    known_ = true;
  }

  [[nodiscard]] bool keeps(const State& x, const Eigen::Vector2d& f) const {
    const Eigen::Vector4d s = solve(regime_, x, f);
    for (int l = 0; l < 2; ++l)
      if (regime_[l] == 0 ? std::abs(s(2 + l)) > force[l] : regime_[l] * rate(x, l) < -1e-15)
        return false;
    return true;
  }

  /// exp(A t) (x, f, slope, 1) by its series: A from `solve`, which is affine in (x, f).
  [[nodiscard]] State after(const State& x, const Eigen::Vector2d& f, const Eigen::Vector2d& slope,
                            double t) const {
    State sum = x, term = x;
    Eigen::Vector2d load = f;
    // ẋ = L(x) + N f + r; the k-th derivative of a polynomial load vanishes for k > 1.
    const Eigen::Vector4d rest = solve(regime_, State::Zero(), Eigen::Vector2d::Zero());
    const auto apply = [&](const State& y, const Eigen::Vector2d& g, double constant) {
      const Eigen::Vector4d s = solve(regime_, y, g) - (1.0 - constant) * rest;
      return State(y(2), y(3), s(0), s(1));
    };
    for (int k = 1; k <= 12; ++k) {
      term = apply(term, load, k == 1 ? 1.0 : 0.0) * (t / k);
      load = k == 1 ? Eigen::Vector2d(slope * t) : Eigen::Vector2d::Zero();
      sum += term;
    }
    return sum;
  }
};

// Two links that stick and slip, separately and together, against the reference above.
TEST(Friction, TwoLinksMatchAnIndependentReference) {
  Reference reference;
  const double rate = 20.0;
  const int samples = 200;
  std::vector<double> first(samples), second(samples);
  for (std::size_t n = 0; n < samples; ++n) {
    const auto t = static_cast<double>(n);
    first[n] = 3.0 * std::sin(0.13 * t + 0.4);
    second[n] = 8.0 * std::sin(0.31 * t) + 4.0 * std::sin(0.11 * t + 1.0);
  }
  const Chain chain{
      .masses = {1.0, 0.7},
      .links = {{.a = 0, .b = 1, .stiffness = 60.0, .damping = 0.3, .laws = {dry(6.0)}},
                {.a = 1, .b = 2, .stiffness = 40.0, .damping = 0.2, .laws = {dry(2.0), dry(1.0)}}}};
  const auto run = [&](SimulatorOptions options) {
    return Simulator(chain,
                     {.sample_rate_hz = rate,
                      .forces = {{.mass = 1, .signal = {first}}, {.mass = 2, .signal = {second}}}},
                     displacements(2), {}, std::move(options))
        .simulate({})
        .values;
  };
  const Eigen::MatrixXd series = run({});
  const Eigen::MatrixXd fine = run({.integrator = Integrator::runge_kutta, .step_limit = 0.01});
  Reference::State x = Reference::State::Zero();
  for (std::size_t n = 0; n < samples; ++n) {
    const auto row = static_cast<Eigen::Index>(n);
    for (Eigen::Index mass = 0; mass < 2; ++mass) {
      EXPECT_NEAR(series(row, mass), x(mass), 1e-8) << "sample " << n;
      EXPECT_NEAR(fine(row, mass), x(mass), 1e-7) << "sample " << n;
    }
    if (n + 1 == samples) break;
    reference.advance(x, {first[n], second[n]},
                      Eigen::Vector2d(first[n + 1] - first[n], second[n + 1] - second[n]) * rate,
                      1.0 / rate);
  }
  EXPECT_GT(reference.events, 20);
  EXPECT_GT(reference.sticking, 10);
}

// The error of regularised friction is its creep v t in stick and the time v / ë of a reversal:
// first order in v.
TEST(Friction, IsTheLimitOfRegularisedFriction) {
  std::vector<double> force(160);
  for (std::size_t n = 0; n < force.size(); ++n)
    force[n] = 8.0 * std::sin(0.15 * static_cast<double>(n));
  const auto run = [&](const Law& law) {
    const Chain chain{.masses = {1.0},
                      .links = {{.stiffness = 40.0, .damping = 0.5, .laws = {law}}}};
    return Eigen::VectorXd(
        Simulator(chain, {.sample_rate_hz = 20.0, .forces = {{.mass = 1, .signal = {force}}}},
                  displacements(1))
            .simulate({})
            .values.col(0));
  };
  const Eigen::VectorXd exact = run(dry(3.0));
  const auto error = [&](double v) {
    return (run(make_law<laws::Coulomb>({3.0, v})) - exact).norm() / exact.norm();
  };
  const double coarse = error(4e-3), middle = error(1e-3), fine = error(2.5e-4);
  EXPECT_LT(fine, 1e-3);
  EXPECT_NEAR(std::log(coarse / middle) / std::log(4.0), 1.0, 0.15);
  EXPECT_NEAR(std::log(middle / fine) / std::log(4.0), 1.0, 0.1);
}

// In parallel, and from b to a: equivalent to one friction element with the sum of the forces.
TEST(Friction, ParallelLinksActAsOne) {
  const auto run = [](std::vector<Link> links) {
    return Simulator(
               {.masses = {1.0}, .links = std::move(links)},
               {.sample_rate_hz = 20.0, .forces = {{.mass = 1, .signal = {noise(200, 3, 12.0)}}}},
               displacements(1))
        .simulate({})
        .values;
  };
  const Eigen::MatrixXd one = run({{.stiffness = 30.0, .laws = {dry(3.0)}}});
  const Eigen::MatrixXd two =
      run({{.stiffness = 30.0, .laws = {dry(1.0)}}, {.a = 1, .b = 0, .laws = {dry(2.0)}}});
  EXPECT_GT(one.cwiseAbs().maxCoeff(), 0.1);
  EXPECT_LT((one - two).cwiseAbs().maxCoeff(), 1e-12);
}

// Three sticking links in a closed loop: the force in each is not determined, but the motion of the
// masses is.
TEST(Friction, AClosedLoopOfStickingLinksSticks) {
  Chain chain{.masses = {1.0, 2.0}};
  chain.links = {{.a = 0, .b = 1, .laws = {dry(4.0)}},
                 {.a = 1, .b = 2, .laws = {dry(4.0)}},
                 {.a = 0, .b = 2, .stiffness = 20.0, .laws = {dry(4.0)}}};
  const auto run = [&](double amplitude) {
    return Simulator(chain,
                     {.sample_rate_hz = 20.0,
                      .forces = {{.mass = 2, .signal = {noise(200, 5, amplitude)}}}},
                     displacements(2))
        .simulate({});
  };
  EXPECT_LT(run(3.0).values.cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_FALSE(run(60.0).failed);
  EXPECT_GT(run(60.0).values.cwiseAbs().maxCoeff(), 0.01);
}

// Together with every other law, for series and for Runge-Kutta.
TEST(Friction, CombinesWithEveryOtherLaw) {
  const std::vector<double> force = noise(150, 9, 30.0);
  const auto run = [&](const std::vector<Law>& laws, SimulatorOptions options) {
    const Chain chain{.masses = {1.0, 0.7},
                      .links = {{.a = 0, .b = 1, .stiffness = 60.0, .laws = {dry(2.0)}},
                                {.a = 1, .b = 2, .stiffness = 40.0, .damping = 0.2, .laws = laws}}};
    const Simulator simulator(chain,
                              {.sample_rate_hz = 20.0, .forces = {{.mass = 2, .signal = {force}}}},
                              displacements(2), {}, std::move(options));
    const Response response = simulator.simulate({});
    EXPECT_FALSE(response.failed);
    return std::pair(response.values, simulator.integrator());
  };
  const Eigen::MatrixXd alone = run({}, {}).first;
  for (const auto& [law, tolerance] :
       {std::pair(make_law<laws::Quadratic>({15.0}), 1e-6),
        std::pair(make_law<laws::Cubic>({150.0}), 1e-6),
        std::pair(make_law<laws::Bilinear>({60.0}), 1e-5),
        std::pair(make_law<laws::Contact>({400.0, 0.05}, Side::closing), 1e-4),
        std::pair(make_law<laws::QuadraticDamping>({1.5}), 1e-6),
        std::pair(make_law<laws::Coulomb>({2.0, 0.05}), 1e-6),
        std::pair(make_law<laws::BoucWen>({80.0, 0.05}), 1e-5)}) {
    const auto [chosen, integrator] = run({law, dry(1.0)}, {.extension = {1.0, 1.0}});
    const auto fine =
        run({law, dry(1.0)}, {.integrator = Integrator::runge_kutta, .step_limit = 0.01}).first;
    const double error = (chosen - fine).norm() / fine.norm();
    EXPECT_LT(error, integrator == Integrator::series ? tolerance : 1e-3)
        << law_infos()[static_cast<std::size_t>(law.kind)].name;
    EXPECT_GT((chosen - alone).norm(), 0.02 * alone.norm());
  }
}

// Regression: a hysteresis that needs hundreds of steps per sample used up the friction events.
TEST(Friction, KeepsItsEventsBesideALawOfManySteps) {
  constexpr int kCoarse = 60, kFiner = 20;
  const auto run = [](int finer) {
    std::vector<double> force;
    for (int i = 0; i <= (kCoarse - 1) * finer; ++i) {
      const int n = i / finer;
      const auto at = [](int k) { return 40.0 * std::sin(2.0 * M_PI * 1.3 * k / 10.0); };
      force.push_back(at(n) + (at(n + 1) - at(n)) * (i % finer) / finer);
    }
    const Chain chain{.masses = {1.0},
                      .links = {{.a = 0,
                                 .b = 1,
                                 .stiffness = 20.0,
                                 .damping = 0.5,
                                 .laws = {dry(8.0), make_law<laws::BoucWen>({5000.0, 1e-3})}}}};
    const Simulator simulator(
        chain, {.sample_rate_hz = 10.0 * finer, .forces = {{.mass = 1, .signal = {force}}}},
        displacements(1), {}, {});
    const Response response = simulator.simulate({});
    EXPECT_FALSE(response.failed);
    return response.values;
  };
  const Eigen::MatrixXd coarse = run(1), fine = run(kFiner);
  for (int n = 0; n < kCoarse; ++n) EXPECT_NEAR(coarse(n, 0), fine(n * kFiner, 0), 1e-5) << n;
}

// A creep speed that is a parameter gives regularised friction, even if its value is 0.
TEST(Friction, IsExactOnlyForAConstantCreepSpeedOfZero) {
  EXPECT_TRUE(is_dry(make_law<laws::Coulomb>({1.0})));
  EXPECT_TRUE(is_dry(make_law<laws::Coulomb>({Coefficient::of_parameter(0), 0.0})));
  EXPECT_FALSE(is_dry(make_law<laws::Coulomb>({1.0, 1e-3})));
  EXPECT_FALSE(is_dry(make_law<laws::Coulomb>({1.0, Coefficient::of_parameter(0)})));
  EXPECT_FALSE(is_dry(make_law<laws::Cubic>({0.0})));
  const Simulator simulator(
      {.masses = {1.0},
       .links = {{.laws = {make_law<laws::Coulomb>({1.0, Coefficient::of_parameter(0)})}}}},
      no_force(20.0, 10), displacements(1), {.displacement = {0.0}, .velocity = {1.0}});
  const double creeping[] = {0.1}, none[] = {0.0};
  EXPECT_EQ(simulator.simulate(creeping).outcome, Outcome::complete);
  EXPECT_EQ(simulator.simulate(none).outcome, Outcome::impossible);
}

// More links with exact friction than supported: the message says what to do.
TEST(Friction, RejectsTooManyLinks) {
  Chain chain = uniform_chain(9);
  for (Link& link : chain.links) link.laws = {dry(1.0)};
  EXPECT_THROW(Simulator(chain, no_force(20.0, 10), displacements(1)), std::invalid_argument);
  chain.links.back().laws = {make_law<laws::Coulomb>({1.0, 1e-2})};
  EXPECT_NO_THROW(Simulator(chain, no_force(20.0, 10), displacements(1)));
}

}  // namespace
