// Every law against an adaptive reference, with automatic steps.
#include "dynamics/step_check.hpp"

#include <gtest/gtest.h>

#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "tests/dynamics/chains.hpp"

namespace step_check_test {
namespace {

using namespace wheeltap::dynamics;

constexpr double kRate = 20.0;
constexpr int kSamples = 120;

struct Case {
  std::string name;
  Law law;
  double tolerance;
};

/// Two masses in series, the law on the upper link.
Chain two_masses(const Law& law) {
  Chain chain{.masses = {1.0, 0.7}};
  chain.links.push_back({.a = 0, .b = 1, .stiffness = 60.0, .damping = 0.3});
  chain.links.push_back({.a = 1, .b = 2, .stiffness = 40.0, .damping = 0.2, .laws = {law}});
  return chain;
}

/// An independent implementation of the definitions in dynamics/laws/, for scalars.
double tension(const Law& law, double e, double v, double zeta, double& zeta_rate) {
  const std::string name(law_infos()[static_cast<std::size_t>(law.kind)].name);
  const auto c = [&](std::size_t i) { return law.coefficients[i].value; };
  const double side = law.side == Side::opening ? 1.0 : -1.0;
  zeta_rate = 0.0;
  if (name == "quadratic") return c(0) * e * e;
  if (name == "cubic") return c(0) * e * e * e;
  if (name == "quintic") return c(0) * std::pow(e, 5.0);
  if (name == "bilinear") return side * c(0) * std::max(0.0, side * e);
  if (name == "contact") return side * c(0) * std::max(0.0, side * e - c(1));
  if (name == "quadratic_damping") return c(0) * v * std::abs(v);
  if (name == "coulomb")
    return  // see friction_test.cpp for exact friction
        c(0) * std::tanh(v / c(1));
  if (name == "bouc_wen") {
    const double sign = v * zeta > 0.0 ? 1.0 : -1.0;
    zeta_rate = v / c(1) * (1.0 - std::pow(std::abs(zeta), c(2)) * (c(3) * sign + c(4)));
    return c(0) * c(1) * zeta;
  }
  ADD_FAILURE() << name << " has no reference";
  return 0.0;
}

/// Dormand and Prince's pair of orders 5 and 4 with error control at 1e-12, from sample to sample.
/// At a switch, its steps decrease until the error is within that.
Eigen::MatrixXd reference(const Chain& chain, const std::vector<double>& force) {
  namespace odeint = boost::numeric::odeint;
  using State = std::array<double, 5>;
  auto stepper = odeint::make_controlled<odeint::runge_kutta_dopri5<State>>(1e-12, 1e-12);
  const Law& law = chain.links[1].laws[0];
  const double m1 = chain.masses[0].value, m2 = chain.masses[1].value;
  State x{};
  Eigen::MatrixXd out(kSamples, 2);
  double step = 1e-4;
  for (int n = 0;; ++n) {
    out.row(n) << x[0], x[1];
    if (n + 1 == kSamples) return out;
    const double f0 = force[static_cast<std::size_t>(n)],
                 f1 = force[static_cast<std::size_t>(n + 1)];
    const auto rates = [&](const State& s, State& d, double t) {
      double zeta_rate = 0.0;
      const double lower = 60.0 * s[0] + 0.3 * s[2];
      const double e = s[1] - s[0], v = s[3] - s[2];
      const double upper = 40.0 * e + 0.2 * v + tension(law, e, v, s[4], zeta_rate);
      d = {s[2], s[3], (upper - lower) / m1, (f0 + (f1 - f0) * t * kRate - upper) / m2, zeta_rate};
    };
    double t = 0.0;
    const double end = 1.0 / kRate;
    while (t < end) {
      double trial = std::min(step, end - t);
      const bool last = trial == end - t;
      if (stepper.try_step(rates, x, t, trial) == odeint::success && last) break;
      step = trial;
    }
  }
}

class AgainstAnAdaptiveReference : public testing::TestWithParam<Case> {};

// Issue 13, point 6: 1e-6 of the RMS of every sensor, friction 1e-3.
TEST_P(AgainstAnAdaptiveReference, StepsChosenByTheProgramSuffice) {
  const Case& c = GetParam();
  const Chain chain = two_masses(c.law);
  std::vector<double> force(kSamples);
  for (int n = 0; n < kSamples; ++n)
    force[static_cast<std::size_t>(n)] = 8.0 * std::sin(0.35 * n) + 4.0 * std::sin(0.11 * n + 1.0);
  const Simulator simulator(chain,
                            {.sample_rate_hz = kRate, .forces = {{.mass = 2, .signal = {force}}}},
                            displacements(2));
  const CheckedResponse checked = checked_response(simulator, {});
  ASSERT_EQ(checked.response.outcome, Outcome::complete);
  const Eigen::MatrixXd truth = reference(chain, force);
  for (Eigen::Index s = 0; s < 2; ++s)
    EXPECT_LT((checked.response.values.col(s) - truth.col(s)).norm(),
              c.tolerance * truth.col(s).norm())
        << "sensor " << s << ", change " << checked.change;
  // The law must have an effect, otherwise the test proves nothing.
  Chain without = chain;
  without.links[1].laws.clear();
  const auto idle =
      Simulator(without, {.sample_rate_hz = kRate, .forces = {{.mass = 2, .signal = {force}}}},
                displacements(2))
          .simulate({});
  EXPECT_GT((idle.values - truth).norm(), 0.01 * truth.norm());
}

INSTANTIATE_TEST_SUITE_P(
    Laws, AgainstAnAdaptiveReference,
    testing::Values(Case{"Quadratic", make_law<laws::Quadratic>({15.0}), 1e-6},
                    Case{"Cubic", make_law<laws::Cubic>({150.0}), 1e-6},
                    Case{"SofteningCubic", make_law<laws::Cubic>({-10.0}), 1e-6},
                    Case{"Quintic", make_law<laws::Quintic>({1500.0}), 1e-6},
                    Case{"Bilinear", make_law<laws::Bilinear>({60.0}), 1e-6},
                    Case{"Contact", make_law<laws::Contact>({400.0, 0.05}, Side::closing), 1e-6},
                    Case{"QuadraticDamping", make_law<laws::QuadraticDamping>({1.5}), 1e-6},
                    Case{"StrongDrag", make_law<laws::QuadraticDamping>({300.0}), 1e-6},
                    Case{"RegularisedCoulomb", make_law<laws::Coulomb>({2.0, 1e-3}), 1e-3},
                    Case{"BoucWen", make_law<laws::BoucWen>({80.0, 0.05}), 1e-6},
                    Case{"SharpBoucWen", make_law<laws::BoucWen>({80.0, 0.02, 10.0}), 1e-6},
                    Case{"SmallYield", make_law<laws::BoucWen>({800.0, 1e-3, 2.0}), 1e-6}),
    [](const auto& test) { return test.param.name; });

// Every law of the list has a case above.
TEST(StepCheck, CoversEveryLaw) {
  EXPECT_EQ(LawList::kSize, 8);
}

Simulator driven(const Law& law, double amplitude, SimulatorOptions options = {}) {
  Chain chain{.masses = {1.0}, .links = {{.stiffness = 100.0, .damping = 0.2, .laws = {law}}}};
  std::vector<double> force(100);
  for (std::size_t n = 0; n < 100; ++n)
    force[n] = amplitude * std::sin(0.6 * static_cast<double>(n));
  return Simulator(chain, {.sample_rate_hz = 20.0, .forces = {{.mass = 1, .signal = {force}}}},
                   {{.mass = 1}}, {}, std::move(options));
}

TEST(StepCheck, DistinguishesTooLongStepsFromDivergence) {
  const auto outcome = [](const Simulator& simulator) {
    return checked_response(simulator, {}).response.outcome;
  };
  EXPECT_EQ(outcome(driven(make_law<laws::Cubic>({-500.0}), 100.0)), Outcome::diverged);
  EXPECT_EQ(outcome(driven(make_law<laws::BoucWen>({500.0, 1e-8}), 10.0)), Outcome::steps_too_long);
  EXPECT_EQ(outcome(driven(make_law<laws::Contact>({1.0, Coefficient(0.1)}), 1.0)),
            Outcome::complete);
  // A hardening spring diverges with one step per sample, but not with more: the steps are too
  // long.
  const Law hard = make_law<laws::Cubic>({1e5});
  EXPECT_TRUE(driven(hard, 500.0, {.substeps = 1}).simulate({}).failed);
  EXPECT_EQ(outcome(driven(hard, 500.0, {.substeps = 1})), Outcome::steps_too_long);
  EXPECT_EQ(outcome(driven(hard, 500.0)), Outcome::complete);
}

TEST(StepCheck, KeepsGivenStepsAndReportsTheirError) {
  const CheckedResponse given =
      checked_response(driven(make_law<laws::Cubic>({500.0}), 20.0, {.substeps = 4}), {});
  ASSERT_FALSE(given.response.failed);
  EXPECT_EQ(given.response.substeps, 4);
  EXPECT_GT(given.change, 1e-6);
  const CheckedResponse chosen = checked_response(driven(make_law<laws::Cubic>({500.0}), 20.0), {});
  EXPECT_LE(chosen.change, 1e-6);
}

}  // namespace

}  // namespace step_check_test
