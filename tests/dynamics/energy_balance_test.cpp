// Energy balance for every law: the work of the excitation equals the change of kinetic and elastic
// energy plus dissipation, W = ΔE + D at every sample.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "dynamics/step_check.hpp"
#include "tests/dynamics/chains.hpp"

namespace {

using namespace wheeltap::dynamics;

/// Energy stored in a law, dissipated power and its rate of change, implemented independently from
/// the definitions in dynamics/laws/.
struct Account {
  double stored = 0.0, heat = 0.0, heat_rate = 0.0;
};

struct BalanceCase {
  std::string name;
  Law law;
};

constexpr double kMass = 1.0, kStiffness = 60.0, kDamping = 0.3;

/// `tension` is the law's tension by the equation of motion, which gives the state of hysteresis.
Account account(const Law& law, double e, double v, double a, double tension) {
  const std::string name(law_infos()[static_cast<std::size_t>(law.kind)].name);
  const auto c = [&](std::size_t i) { return law.coefficients[i].value; };
  const double side = law.side == Side::opening ? 1.0 : -1.0, sign = v > 0.0 ? 1.0 : -1.0;
  const auto pressed = [&](double gap) { return std::max(0.0, side * e - gap); };
  if (name == "quadratic") return {.stored = c(0) * e * e * e / 3.0};
  if (name == "cubic") return {.stored = c(0) * e * e * e * e / 4.0};
  if (name == "quintic") return {.stored = c(0) * std::pow(e, 6) / 6.0};
  if (name == "bilinear") return {.stored = 0.5 * c(0) * pressed(0.0) * pressed(0.0)};
  if (name == "contact") return {.stored = 0.5 * c(0) * pressed(c(1)) * pressed(c(1))};
  if (name == "quadratic_damping")
    return {.heat = c(0) * v * v * std::abs(v), .heat_rate = 3.0 * c(0) * v * std::abs(v) * a};
  if (name == "coulomb" && c(1) > 0.0) {
    const double t = std::tanh(v / c(1));
    return {.heat = c(0) * t * v, .heat_rate = c(0) * a * (t + v / c(1) * (1.0 - t * t))};
  }
  if (name == "coulomb") return {.heat = c(0) * std::abs(v), .heat_rate = c(0) * sign * a};
  if (name == "bouc_wen") {
    // T ė = k e_y² ζ ζ̇ + k e_y ė ζ |ζ|ⁿ (β sgn(ė ζ) + γ)
    const double zeta = tension / (c(0) * c(1)), direction = v * zeta > 0.0 ? 1.0 : -1.0;
    const double lost = std::pow(std::abs(zeta), c(2)) * (c(3) * direction + c(4));
    const double zeta_rate = v / c(1) * (1.0 - lost);
    return {.stored = 0.5 * c(0) * c(1) * c(1) * zeta * zeta,
            .heat = c(0) * c(1) * v * zeta * lost,
            .heat_rate = c(0) * c(1) * lost * (a * zeta + (c(2) + 1.0) * v * zeta_rate)};
  }
  ADD_FAILURE() << name << " has no account";
  return {};
}

/// ∫ over a step from the values and slopes at its ends: h/2 (f₀ + f₁) + h²/12 (f₀' - f₁').
double step_integral(double h, double f0, double f1, double slope0, double slope1) {
  return 0.5 * h * (f0 + f1) + h * h / 12.0 * (slope0 - slope1);
}

class EnergyOf : public testing::TestWithParam<BalanceCase> {};

// The integrals of power use samples h apart, with error h⁴ for smooth powers. Where the power has
// a kink (friction at ė = 0, hysteresis at reversals), the error of a step is up to h²/12 times the
// jump of its slope, 2 F |ë|: with F = 2 N, |ë| < 40 m/s² and h = 1/2560 s that is 2e-6 J, of
// either sign, for fewer than 40 reversals. The work done is at least 5 J.
TEST_P(EnergyOf, WorkEqualsEnergyPlusDissipation) {
  const Law& law = GetParam().law;
  const int refined = 128, coarse = 120;
  const double rate = 20.0 * refined;
  std::vector<double> force;
  const auto at = [](int n) { return 8.0 * std::sin(0.35 * n) + 4.0 * std::sin(0.11 * n + 1.0); };
  for (int n = 0; n < coarse; ++n)
    for (int i = 0; i < refined; ++i) force.push_back(at(n) + (at(n + 1) - at(n)) * i / refined);
  const Chain chain{.masses = {kMass},
                    .links = {{.stiffness = kStiffness, .damping = kDamping, .laws = {law}}}};
  const CheckedResponse checked = checked_response(
      Simulator(chain, {.sample_rate_hz = rate, .forces = {{.mass = 1, .signal = {force}}}},
                {{.mass = 1},
                 {.mass = 1, .quantity = Quantity::velocity},
                 {.mass = 1, .quantity = Quantity::acceleration}}),
      {});
  ASSERT_EQ(checked.response.outcome, Outcome::complete);
  const Eigen::MatrixXd& r = checked.response.values;
  const double h = 1.0 / rate;
  double work = 0.0, heat = 0.0, put_in = 0.0, lost_by_law = 0.0, stored = 0.0;
  for (Eigen::Index n = 0; n < r.rows(); ++n) {
    const auto own = [&](Eigen::Index i) {
      const double f = force[static_cast<std::size_t>(i)];
      return account(law, r(i, 0), r(i, 1), r(i, 2),
                     f - kMass * r(i, 2) - kStiffness * r(i, 0) - kDamping * r(i, 1));
    };
    const Account now = own(n);
    const double v = r(n, 1), a = r(n, 2);
    if (n > 0) {
      const double v0 = r(n - 1, 1), a0 = r(n - 1, 2);
      const double f0 = force[static_cast<std::size_t>(n - 1)],
                   f1 = force[static_cast<std::size_t>(n)], slope = (f1 - f0) / h;
      const double step =
          step_integral(h, f0 * v0, f1 * v, slope * v0 + f0 * a0, slope * v + f1 * a);
      work += step;
      put_in += std::abs(step);
      heat += kDamping * step_integral(h, v0 * v0, v * v, 2.0 * v0 * a0, 2.0 * v * a);
      const Account before = own(n - 1);
      const double rubbed =
          step_integral(h, before.heat, now.heat, before.heat_rate, now.heat_rate);
      heat += rubbed;
      lost_by_law += rubbed;
    }
    const double energy = 0.5 * kMass * v * v + 0.5 * kStiffness * r(n, 0) * r(n, 0) + now.stored;
    stored = std::max(stored, now.stored);
    ASSERT_NEAR(work, energy + heat, 1e-4) << "sample " << n;
    EXPECT_GE(now.heat, -1e-12);
  }
  EXPECT_GT(put_in, 5.0);
  EXPECT_GT(lost_by_law + stored, 0.02 * put_in);  // the law has a significant share
}

const std::vector<BalanceCase>& cases() {
  static const std::vector<BalanceCase> all{
      {"Quadratic", make_law<laws::Quadratic>({15.0})},
      {"Cubic", make_law<laws::Cubic>({300.0})},
      {"Quintic", make_law<laws::Quintic>({4000.0})},
      {"Bilinear", make_law<laws::Bilinear>({60.0})},
      {"Contact", make_law<laws::Contact>({400.0, 0.05}, Side::closing)},
      {"QuadraticDamping", make_law<laws::QuadraticDamping>({1.5})},
      {"RegularisedCoulomb", make_law<laws::Coulomb>({2.0, 0.05})},
      {"Coulomb", make_law<laws::Coulomb>({2.0})},
      {"BoucWen", make_law<laws::BoucWen>({80.0, 0.05})},
      {"SharpBoucWen", make_law<laws::BoucWen>({80.0, 0.02, 3.0, 0.6, 0.4})}};
  return all;
}

INSTANTIATE_TEST_SUITE_P(Laws, EnergyOf, testing::ValuesIn(cases()),
                         [](const auto& test) { return test.param.name; });

TEST(EnergyBalance, CoversEveryLaw) {
  for (int kind = 0; kind < LawList::kSize; ++kind)
    EXPECT_TRUE(std::ranges::any_of(cases(), [&](const BalanceCase& c) {
      return c.law.kind == kind;
    })) << law_infos()[static_cast<std::size_t>(kind)].name;
}

}  // namespace
