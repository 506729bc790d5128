#include "dynamics/laws.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <stdexcept>
#include <string>

#include "dynamics/simulate.hpp"

namespace {

using namespace wheeltap::dynamics;

/// The tension in the integrator: from the acceleration of a unit mass at its first sample.
double tension(const Law& law, double e, double rate) {
  const Chain chain{.masses = {1.0}, .links = {{.laws = {law}}}};
  const Excitation still{.sample_rate_hz = 1.0, .forces = {{.mass = 1, .signal = {{0.0}}}}};
  const Simulator simulator(chain, still, {{.mass = 1, .quantity = Quantity::acceleration}},
                            {.displacement = {e}, .velocity = {rate}}, {.substeps = 1});
  return -simulator.simulate({}).values(0, 0);
}

TEST(Laws, MatchTheirFormulas) {
  for (double e : {-0.7, -0.2, 0.0, 0.1, 0.9})
    for (double rate : {-1.3, 0.0, 0.4}) {
      EXPECT_DOUBLE_EQ(tension(make_law<laws::Quadratic>({3.0}), e, rate), 3.0 * e * e);
      EXPECT_DOUBLE_EQ(tension(make_law<laws::Cubic>({-3.0}), e, rate), -3.0 * e * (e * e));
      EXPECT_DOUBLE_EQ(tension(make_law<laws::Quintic>({3.0}), e, rate), 3.0 * e * (e * e * e * e));
      EXPECT_DOUBLE_EQ(tension(make_law<laws::Bilinear>({3.0}), e, rate), 3.0 * std::max(0.0, e));
      EXPECT_DOUBLE_EQ(tension(make_law<laws::Bilinear>({3.0}, Side::closing), e, rate),
                       3.0 * std::min(0.0, e));
      EXPECT_DOUBLE_EQ(tension(make_law<laws::Contact>({3.0, 0.3}), e, rate),
                       3.0 * std::max(0.0, e - 0.3));
      EXPECT_DOUBLE_EQ(tension(make_law<laws::Contact>({3.0, 0.3}, Side::closing), e, rate),
                       3.0 * std::min(0.0, e + 0.3));
      EXPECT_DOUBLE_EQ(tension(make_law<laws::QuadraticDamping>({3.0}), e, rate),
                       3.0 * rate * std::abs(rate));
      EXPECT_NEAR(tension(make_law<laws::Coulomb>({3.0, 0.5}), e, rate),
                  3.0 * std::tanh(rate / 0.5), 3e-15);
      EXPECT_DOUBLE_EQ(tension(make_law<laws::Coulomb>({3.0}), e, rate), rate > 0.0   ? 3.0
                                                                         : rate < 0.0 ? -3.0
                                                                                      : 0.0);
      EXPECT_EQ(tension(make_law<laws::BoucWen>({3.0, 0.1}), e, rate), 0.0);  // ζ(0) = 0
    }
}

TEST(Laws, ForceIsContinuousAtTheStop) {
  for (Side side : {Side::opening, Side::closing}) {
    const Law stop = make_law<laws::Contact>({830e3, 1e-4}, side);
    const double sign = side == Side::opening ? 1.0 : -1.0;
    EXPECT_EQ(tension(stop, sign * 1e-4, 0.0), 0.0);
    EXPECT_EQ(tension(stop, sign * (1e-4 - 1e-12), 0.0), 0.0);
    EXPECT_NEAR(tension(stop, sign * (1e-4 + 1e-12), 0.0), sign * 830e3 * 1e-12, 1e-13);
  }
}

// Small loops are elastic with stiffness k; large ones saturate at ±k e_y (β + γ = 1).
TEST(Laws, BoucWenStartsElasticAndYields) {
  const double k = 100.0, yield = 0.01, rate = 1000.0;
  // A link extended at constant speed by a heavy mass.
  const auto pulled = [&](double speed, double exponent) {
    const double mass = 1e9;
    const Chain chain{.masses = {mass},
                      .links = {{.laws = {make_law<laws::BoucWen>({k, yield, exponent})}}}};
    const Excitation still{.sample_rate_hz = rate,
                           .forces = {{.mass = 1, .signal = {std::vector<double>(1000, 0.0)}}}};
    const Simulator simulator(chain, still, {{.mass = 1, .quantity = Quantity::acceleration}},
                              {.displacement = {0.0}, .velocity = {speed}});
    return Eigen::VectorXd(-mass * simulator.simulate({}).values.col(0));
  };
  for (double exponent : {1.0, 2.0, 3.7}) {
    const Eigen::VectorXd slow = pulled(1e-7, exponent);
    EXPECT_NEAR(slow(999) / (k * 1e-7 * 0.999), 1.0, 2e-5);
    const Eigen::VectorXd fast = pulled(-1.0, exponent);
    EXPECT_NEAR(fast(999), -k * yield, 1e-9);
  }
  // n = 1 has the closed form ζ = 1 - exp(-e/e_y).
  const Eigen::VectorXd pull = pulled(0.02, 1.0);
  for (int n : {100, 500, 999})
    EXPECT_NEAR(pull(n), k * yield * (1.0 - std::exp(-0.02 * n / rate / yield)), 1e-8);
}

// The integrator locates its corners, where the motion reverses and where ζ changes sign; steps
// across them would reduce the order to two.
TEST(Laws, BoucWenIsIntegratedToFourthOrder) {
  std::vector<double> force;
  for (int n = 0; n < 300; ++n)
    force.push_back(20.0 * std::sin(0.21 * n) + 11.0 * std::sin(0.53 * n + 1.0));
  const Chain chain{
      .masses = {1.0},
      .links = {
          {.stiffness = 600.0, .damping = 1.5, .laws = {make_law<laws::BoucWen>({480.0, 0.02})}}}};
  const auto run = [&](double limit) {
    return Simulator(chain, {.sample_rate_hz = 60.0, .forces = {{.mass = 1, .signal = {force}}}},
                     {{.mass = 1}}, {}, {.step_limit = limit, .extension = {0.1}})
        .simulate({})
        .values;
  };
  const Eigen::MatrixXd reference = run(0.004);
  const auto error = [&](double limit) {
    return (run(limit) - reference).norm() / reference.norm();
  };
  const double coarse = error(0.1), fine = error(0.025);
  EXPECT_LT(coarse, 1e-4);
  EXPECT_GT(std::log2(coarse / fine) / 2.0, 3.0) << coarse << ' ' << fine;
}

TEST(Laws, HaveUniqueNamesAndDefaults) {
  std::set<std::string_view> names;
  for (const LawInfo& info : law_infos()) {
    EXPECT_TRUE(names.insert(info.name).second) << info.name;
    EXPECT_GE(info.size(), 1);
    EXPECT_FALSE(info.formula.empty()) << info.name;
    EXPECT_FALSE(info.description.empty()) << info.name;
    for (int i = 0; i < info.size(); ++i) {
      const LawCoefficient& c = info.coefficients[static_cast<std::size_t>(i)];
      EXPECT_FALSE(c.words.empty()) << info.name << ' ' << c.name;
      EXPECT_TRUE(c.allows(c.example)) << info.name << ' ' << c.name;
      ASSERT_FALSE(c.symbol.empty()) << info.name << ' ' << c.name;
      EXPECT_NE(info.formula.find(c.symbol), std::string_view::npos) << info.name << ' ' << c.name;
    }
  }
  EXPECT_EQ(make_law("coulomb", std::vector<Coefficient>{2.0}).coefficients[1].value, 0.0);
  EXPECT_THROW((void)make_law("coulomb", {}), std::invalid_argument);
  EXPECT_THROW((void)make_law("cubic", std::vector<Coefficient>{1.0, 2.0}), std::invalid_argument);
  EXPECT_THROW((void)make_law("friction", std::vector<Coefficient>{1.0}), std::invalid_argument);
}

// Every coefficient has a unit and bounds. A constant outside them is rejected, also beside unknown
// ones, and an unknown coefficient is impossible there.
TEST(Laws, EnforceTheBoundsOfCoefficients) {
  for (const LawInfo& info : law_infos())
    for (int i = 0; i < info.size(); ++i) {
      const LawCoefficient& c = info.coefficients[static_cast<std::size_t>(i)];
      EXPECT_FALSE(c.unit.empty()) << info.name << ' ' << c.name;
      EXPECT_LT(c.lower, c.upper);
      EXPECT_FALSE(c.allows(std::nan("")));
      EXPECT_FALSE(c.allows(HUGE_VAL));
      EXPECT_EQ(c.allows(c.lower), std::isfinite(c.lower) && !c.above_lower);
      EXPECT_TRUE(c.required() || c.allows(c.otherwise));
    }
  const auto chain = [](const Law& law) {
    return Chain{.masses = {1.0}, .links = {{.laws = {law}}}};
  };
  const Coefficient unknown = Coefficient::of_parameter(0);
  EXPECT_NO_THROW(validate(chain(make_law<laws::Contact>({unknown, 0.0}))));
  EXPECT_THROW(validate(chain(make_law<laws::Contact>({unknown, -0.1}))), std::invalid_argument);
  EXPECT_THROW(validate(chain(make_law<laws::BoucWen>({unknown, 0.0}))), std::invalid_argument);
  EXPECT_THROW(validate(chain(make_law<laws::BoucWen>({unknown, 1.0, 0.9}))),
               std::invalid_argument);
  EXPECT_THROW(validate(chain(make_law<laws::BoucWen>({1.0, 1.0, 1.0, 0.5, -0.5}))),
               std::invalid_argument);
  EXPECT_THROW(validate(chain(make_law<laws::Coulomb>({unknown, -0.1}))), std::invalid_argument);
  EXPECT_THROW(validate(chain(make_law<laws::Coulomb>({-1.0}))), std::invalid_argument);
}

TEST(Laws, NameAnInfeasibleCoefficient) {
  const auto named = [](const Law& law, double mass, double x) {
    const Chain chain{.masses = {mass}, .links = {{.laws = {law}}}};
    const std::string why = impossibility(chain, {&x, 1});
    const Excitation still{.sample_rate_hz = 1.0, .forces = {{.mass = 1, .signal = {{0.0, 0.0}}}}};
    if (mass > 0.0) {  // otherwise the constructor throws
      const Simulator simulator(chain, still, {{.mass = 1}});
      EXPECT_EQ(simulator.simulate({&x, 1}).outcome == Outcome::impossible, !why.empty()) << why;
    }
    return why;
  };
  const Coefficient unknown = Coefficient::of_parameter(0);
  const double endless = HUGE_VAL;
  EXPECT_EQ(impossibility({.masses = {1.0}, .links = {{.damping = unknown}}}, {&endless, 1}),
            "damping of the link between 0 and 1 = inf, must be finite");
  const Law stop = make_law<laws::Contact>({1.0, unknown});
  EXPECT_EQ(named(stop, 1.0, 0.1), "");
  EXPECT_EQ(named(stop, 0.0, 0.1), "mass 1 = 0, must be > 0");
  EXPECT_EQ(named(stop, 1.0, -0.1),
            "contact of the link between 0 and 1: gap = -0.1, must be >= 0");
  EXPECT_EQ(named(make_law<laws::BoucWen>({1.0, unknown}), 1.0, 0.0),
            "bouc_wen of the link between 0 and 1: yield = 0, must be > 0");
  EXPECT_EQ(named(make_law<laws::Cubic>({unknown}), 1.0, HUGE_VAL),
            "cubic of the link between 0 and 1: stiffness = inf, must be finite");
  EXPECT_EQ(named(make_law<laws::BoucWen>({1.0, 1.0, 1.0, 0.5, unknown}), 1.0, -0.5),
            "bouc_wen of the link between 0 and 1: its coefficients are not feasible together");
  EXPECT_NE(named(make_law<laws::Coulomb>({1.0, unknown}), 1.0, 0.0).find("velocity = 0"),
            std::string::npos);
}

// The step choice uses these bounds: |∂T/∂e|, |∂T/∂ė| and |∂ζ̇/∂ζ| by differences do not exceed
// them.
TEST(Laws, SlopesBoundTheDerivatives) {
  const auto check = []<class L>(L, std::initializer_list<double> coefficients) {
    double c[kMaxLawCoefficients] = {};
    std::copy(coefficients.begin(), coefficients.end(), c);
    const double e_max = 0.8, h = 1e-6;
    const Slopes slopes = L::slopes(c, e_max);
    for (double e = -e_max; e <= e_max; e += 0.05)
      for (double v : {-2.03, -0.5, -0.011, 0.013, 0.7, 1.9}) {
        const double speed = std::abs(v) + h;
        if constexpr (L::kInfo.memory) {
          const double z = std::pow(c[3] + c[4], -1.0 / c[2]);
          for (double zeta = -0.99 * z; zeta < z; zeta += 0.0987 * z) {
            const double rate = L::memory_rate(c, e, v, zeta);
            const double slope = (L::memory_rate(c, e, v, zeta + h) - rate) / h;
            EXPECT_LE(std::abs(slope), slopes.memory_per_speed * speed * (1.0 + 1e-3));
            EXPECT_LE(std::abs(L::tension(c, e, v, rate) / v), slopes.stiffness * (1.0 + 1e-9));
          }
        } else {
          const double stiffness = (L::tension(c, e + h, v) - L::tension(c, e, v)) / h;
          const double damping = (L::tension(c, e, v + h) - L::tension(c, e, v)) / h;
          if (e + h <= e_max) {
            EXPECT_LE(std::abs(stiffness), slopes.stiffness * (1.0 + 1e-4) + 1e-6);
          }
          EXPECT_LE(std::abs(damping),
                    (slopes.damping + slopes.damping_per_speed * speed) * (1.0 + 1e-4) + 1e-6);
        }
      }
  };
  check(laws::Quadratic{}, {-3.0});
  check(laws::Cubic{}, {7.0});
  check(laws::Quintic{}, {7.0});
  check(laws::Bilinear{}, {5.0});
  check(laws::Contact{}, {5.0, 0.2});
  check(laws::QuadraticDamping{}, {4.0});
  check(laws::Coulomb{}, {4.0, 0.1});
  check(laws::BoucWen{}, {50.0, 0.02, 1.0, 0.5, 0.5});
  check(laws::BoucWen{}, {50.0, 0.02, 3.0, 0.9, 0.1});
  check(laws::BoucWen{}, {50.0, 0.02, 10.0, 0.4, -0.1});
}

}  // namespace
