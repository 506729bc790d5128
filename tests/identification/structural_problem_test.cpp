// User extensions without changes of the library: a forward model, a kind of observation. (For a
// type of defect see defect_kind_test.cpp.)
#include "identification/structural/problem/structural_problem.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "identification/structural/damage/findings/damage_findings.hpp"
#include "identification/structural/updating/update_findings.hpp"
#include "inference/engine/reversible_jump.hpp"
#include "tests/identification/cases.hpp"
#include "tests/identification/modal_cases.hpp"

namespace wheeltap::identification {
namespace {

double log_gaussian(double observed, double mean, double sd) {
  const double r = (observed - mean) / sd;
  return -0.5 * r * r - std::log(sd) - 0.5 * std::log(2.0 * std::numbers::pi);
}

/// The two-storey chain of masses 2 and 1 in closed form: λ² m₁m₂ - λ (m₁k₂ + m₂(k₁ + k₂)) + k₁k₂ =
/// 0, φ ∝ (k₂, k₁ + k₂ - λ m₁), mass-normalised.
class TwoStoreyModel final : public ForwardModel {
 public:
  class ClosedForm final : public Solver {
   public:
    bool predict(std::span<const double> theta, const std::vector<PlacedDefect>& /*defects*/,
                 Quantity quantity, Prediction& out) override {
      constexpr double m1 = 2.0, m2 = 1.0;
      const double k1 = theta[0], k2 = theta[1];
      if (quantity != Quantity::modes || !(k1 > 0.0 && k2 > 0.0)) return false;
      const double b = m1 * k2 + m2 * (k1 + k2), root = std::sqrt(b * b - 4.0 * m1 * m2 * k1 * k2);
      out.modes.resize(1);
      out.modes[0].eigenvalues.resize(2);
      out.modes[0].shapes.resize(2, 2);
      for (Eigen::Index j = 0; j < 2; ++j) {
        const double lambda = (j == 0 ? b - root : b + root) / (2.0 * m1 * m2);
        const Eigen::Vector2d shape(k2, k1 + k2 - lambda * m1);
        const double mass = m1 * shape[0] * shape[0] + m2 * shape[1] * shape[1];
        out.modes[0].eigenvalues[j] = lambda;
        out.modes[0].shapes.col(j) = shape / std::sqrt(mass);
      }
      return true;
    }
  };
  [[nodiscard]] std::unique_ptr<Solver> make_solver() const override {
    return std::make_unique<ClosedForm>();
  }
};

TEST(StructuralProblem, AUserDefinedForwardModelUpdates) {
  const UpdateCase update_case = modal::two_storeys(0.01, 0.05);
  const auto own = make_update_problem(update_case, {.model = std::make_shared<TwoStoreyModel>()});
  const auto ours = make_update_problem(update_case);
  const auto own_likelihood = own->problem.likelihood();
  const auto our_likelihood = ours->problem.likelihood();
  for (const std::vector<double>& x :
       {std::vector{1400.0, 900.0}, std::vector{1200.0, 1100.0}, std::vector{2500.0, 500.0}}) {
    const double expected = our_likelihood->log_likelihood(0, x);
    EXPECT_NEAR(own_likelihood->log_likelihood(0, x), expected, 1e-5 * std::abs(expected));
  }
  EXPECT_EQ(own_likelihood->log_likelihood(0, std::vector{-1.0, 900.0}),
            -std::numeric_limits<double>::infinity());
  const auto posterior =
      inference::reversible_jump(own->problem, {.seed = 1, .warmup = 1000, .draws = 1000});
  const UpdateFindings found = update_findings(*own, posterior, {}, 1);
  EXPECT_TRUE(found.fit.ok());
  EXPECT_EQ(found.modes.size(), 2U);
}

/// A beam whose i-th frequency decreases by half of r sin²(i π x) for each loss r at x, with an
/// error of one hundredth.
class RayleighModel final : public ForwardModel {
 public:
  explicit RayleighModel(std::vector<double> intact_hz) : intact_hz_(std::move(intact_hz)) {}
  [[nodiscard]] double frequency(std::size_t i, std::span<const PlacedDefect> defects) const {
    double f = intact_hz_[i];
    for (const PlacedDefect& d : defects) {
      const double s = std::sin(static_cast<double>(i + 1) * std::numbers::pi * d.location);
      f *= 1.0 - 0.5 * d.severity * s * s;
    }
    return f;
  }
  class RayleighSolver final : public Solver {
   public:
    explicit RayleighSolver(const RayleighModel& of) : of_(of) {}
    bool predict(std::span<const double> /*theta*/, const std::vector<PlacedDefect>& defects,
                 Quantity quantity, Prediction& out) override {
      if (quantity != Quantity::frequencies) return false;
      for (std::size_t i = 0; i < out.frequencies_hz.size(); ++i) {
        out.frequencies_hz[i] = of_.frequency(i, defects);
        out.error_variance.push_back(std::pow(0.01 * of_.intact_hz_[i], 2));
      }
      return true;
    }

   private:
    const RayleighModel& of_;
  };
  [[nodiscard]] std::unique_ptr<Solver> make_solver() const override {
    return std::make_unique<RayleighSolver>(*this);
  }

 private:
  std::vector<double> intact_hz_;
};

TEST(StructuralProblem, AUserDefinedForwardModelFindsDamage) {
  const DamageCase damage_case = small_beam(1);
  const FrequencyData& data = damage_case.data;
  const auto model = std::make_shared<RayleighModel>(data.frequencies_hz);
  const auto problem = make_damage_problem(damage_case, {.model = model});
  const auto likelihood = problem->problem.likelihood();
  const std::vector<double> x = {0.3, 0.2};
  const inference::Evaluation found = likelihood->evaluation(1, x);
  double expected = 0.0;
  const PlacedDefect defect{.kind = 0, .location = x[0], .severity = x[1]};
  for (std::size_t i = 0; i < 4; ++i) {
    const double f = model->frequency(i, {&defect, 1});
    EXPECT_EQ(found.prediction[i], f);
    expected += log_gaussian(data.frequencies_hz[i], f,
                             std::hypot(data.sd_hz[i], 0.01 * data.frequencies_hz[i]));
  }
  EXPECT_NEAR(found.log_likelihood, expected, 1e-9 * std::abs(expected));
  std::vector<double> slope(2);
  EXPECT_FALSE(likelihood->gradient(1, x, slope)) << "the model has no slopes";
}

TEST(StructuralProblem, EvaluationsAreValuesInMemoryThatIsReused) {
  const auto problem = make_damage_problem(small_beam(1), {});
  const auto likelihood = problem->problem.likelihood();
  const std::vector<double> x = {0.3, 0.2}, other = {0.7, 0.5};
  inference::Evaluation out = likelihood->evaluation(1, x);
  const inference::Evaluation before = out;
  const double *prediction = out.prediction.data(), *residuals = out.residuals.data();
  likelihood->evaluate(-std::numeric_limits<double>::infinity(), 1, other, out);
  EXPECT_NE(out.prediction, before.prediction);
  EXPECT_NE(out.log_likelihood, before.log_likelihood);
  likelihood->evaluate(-std::numeric_limits<double>::infinity(), 1, x, out);
  EXPECT_EQ(out.prediction, before.prediction);
  EXPECT_EQ(out.residuals, before.residuals);
  EXPECT_EQ(out.log_likelihood, before.log_likelihood);
  EXPECT_EQ(out.prediction.data(), prediction);
  EXPECT_EQ(out.residuals.data(), residuals);
}

/// A static test: the deflection per load of one sensor, Σ φ² / λ over all modes, mass-normalised.
class Flexibility final : public Observation {
 public:
  Flexibility(double measured, double sd) : measured_(measured), sd_(sd) {}
  double log_density(const Prediction& predicted, std::span<const double> /*noise*/,
                     inference::Evaluation& /*out*/) const override {
    const auto& modes = predicted.modes.front();
    double sum = 0.0;
    for (Eigen::Index j = 0; j < modes.eigenvalues.size(); ++j)
      sum += std::pow(modes.shapes(1, j), 2) / modes.eigenvalues[j];
    return log_gaussian(measured_, sum, sd_);
  }

 private:
  double measured_, sd_;
};

// The flexibility of a chain's upper floor is 1/k₁ + 1/k₂.
TEST(StructuralProblem, AUserDefinedObservationUpdates) {
  const UpdateCase update_case = modal::two_storeys(0.01, 0.05);
  const double measured = 1.0 / 1400.0 + 1.0 / 900.0, sd = 0.001 * measured;
  const auto alone = make_update_problem(update_case);
  const auto both = make_update_problem(
      update_case, {.observations = {std::make_shared<Flexibility>(measured, sd)}});
  const auto modes = alone->problem.likelihood(), all = both->problem.likelihood();
  for (const std::vector<double>& x : {std::vector{1400.0, 900.0}, std::vector{1390.0, 910.0}}) {
    const double expected =
        modes->log_likelihood(0, x) + log_gaussian(measured, 1.0 / x[0] + 1.0 / x[1], sd);
    EXPECT_NEAR(all->log_likelihood(0, x), expected, 1e-4 * std::abs(expected));
  }
  std::vector<double> slope(2);
  EXPECT_FALSE(all->gradient(0, std::vector{1400.0, 900.0}, slope));
  const auto posterior =
      inference::reversible_jump(both->problem, {.seed = 1, .warmup = 2000, .draws = 2000});
  inference::ChainsOf flexibility = posterior.draws_of("k1", 0);
  const inference::ChainsOf k2 = posterior.draws_of("k2", 0);
  for (std::size_t c = 0; c < k2.size(); ++c)
    for (std::size_t i = 0; i < k2[c].size(); ++i)
      flexibility[c][i] = 1.0 / flexibility[c][i] + 1.0 / k2[c][i];
  EXPECT_NEAR(inference::mean(flexibility), measured, 5.0 * sd)
      << "a tenth of the sd from frequencies alone";
  EXPECT_EQ(update_findings(*both, posterior, {}, 1).modes.size(), 2U);
}

/// The ratio of the second to the first frequency, by an instrument of unknown scatter.
class Ratio final : public Observation {
 public:
  explicit Ratio(double measured) : measured_(measured) {}
  [[nodiscard]] std::vector<inference::Parameter> parameters() const override {
    return {{"ratio_sd", inference::LogUniform{1e-3, 1.0}}};
  }
  double log_density(const Prediction& predicted, std::span<const double> noise,
                     inference::Evaluation& out) const override {
    const double ratio = predicted.frequencies_hz[1] / predicted.frequencies_hz[0];
    out.residuals.push_back((measured_ - ratio) / noise[0]);
    return log_gaussian(measured_, ratio, noise[0]);
  }

 private:
  double measured_;
};

TEST(StructuralProblem, AUserDefinedObservationWithNoiseFindsDamage) {
  DamageCase damage_case = small_beam(1, {.damages = {{0.425, 0.5}}});
  damage_case.data.cv_prior = inference::LogUniform{1e-3, 1e-1};
  damage_case.data.sd_hz.clear();
  const auto alone = make_damage_problem(damage_case, {});
  const double measured = damage_case.data.frequencies_hz[1] / damage_case.data.frequencies_hz[0];
  const auto both =
      make_damage_problem(damage_case, {.observations = {std::make_shared<Ratio>(measured)}});
  ASSERT_EQ(both->common, 2);
  EXPECT_EQ(both->problem.space.parameter_name(1, 0), "cov");
  EXPECT_EQ(both->problem.space.parameter_name(1, 1), "ratio_sd");
  const inference::Evaluation frequencies =
      alone->problem.likelihood()->evaluation(1, std::vector{0.02, 0.3, 0.4});
  const inference::Evaluation all =
      both->problem.likelihood()->evaluation(1, std::vector{0.02, 0.05, 0.3, 0.4});
  EXPECT_EQ(all.prediction, frequencies.prediction);
  EXPECT_EQ(all.residuals.size(), 5U);
  EXPECT_NEAR(all.log_likelihood,
              frequencies.log_likelihood +
                  log_gaussian(measured, all.prediction[1] / all.prediction[0], 0.05),
              1e-9);
  const auto posterior =
      inference::reversible_jump(both->problem, {.seed = 1, .warmup = 2000, .draws = 2000});
  const DamageFindings found = damage_findings(*both, posterior, {}, 1);
  EXPECT_GT(found.models[1].probability(), 0.5);
  EXPECT_TRUE(std::ranges::any_of(found.models[1].parameters, [](const ParameterFinding& p) {
    return p.unknown.name == "ratio_sd";
  }));
}

}  // namespace
}  // namespace wheeltap::identification
