#include "identification/structural/likelihood/modal_likelihood.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "tests/identification/modal_cases.hpp"

namespace wheeltap::identification::modal_likelihood_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Modes = fem::ParametricModes::Modes;

Modes modes_of(const std::vector<double>& frequencies_hz, const MatrixXd& shapes) {
  Modes out;
  out.eigenvalues.resize(static_cast<Eigen::Index>(frequencies_hz.size()));
  for (std::size_t i = 0; i < frequencies_hz.size(); ++i)
    out.eigenvalues[static_cast<Eigen::Index>(i)] =
        std::pow(2.0 * std::numbers::pi * frequencies_hz[i], 2);
  out.shapes = shapes;
  return out;
}

MatrixXd three_shapes() {
  MatrixXd s(3, 4);
  s << 0.3, 0.9, 0.8, 0.1, 0.7, 0.4, -0.9, 0.5, 1.0, -0.7, 0.3, -0.8;
  return s;
}

ModalData data_of(const std::vector<double>& frequencies_hz, double cov, const MatrixXd& shapes,
                  double shape_sd) {
  ModalData data;
  data.frequencies_hz = frequencies_hz;
  std::vector<double> sds;
  for (const double f : frequencies_hz) sds.push_back(std::isnan(f) ? 1.0 : cov * f);
  data.covariance = modal::diagonal(sds);
  if (shapes.size() > 0) {
    data.sensors = modal::at_masses({1, 2, 3});
    data.shapes = shapes;
    data.shape_covariances.assign(frequencies_hz.size(),
                                  shape_sd * shape_sd * MatrixXd::Identity(3, 3));
  }
  return data;
}

TEST(ModalLikelihood, EigenvaluesReproduceFrequenciesExactly) {
  double lambda = 1e-3;
  for (int i = 0; i < 20000; ++i, lambda *= 1.0021) {
    const double f = std::sqrt(lambda) / (2.0 * std::numbers::pi);
    EXPECT_EQ(std::sqrt(eigenvalue_of(f)) / (2.0 * std::numbers::pi), f);
  }
}

// The fast density of uncorrelated frequencies equals the score.
TEST(ModalLikelihood, TheDensityOfFrequenciesEqualsTheScore) {
  const double gap = std::numeric_limits<double>::quiet_NaN();
  ModalData data = data_of({1.0, gap, 2.5}, 0.02, {}, 0.0);
  const Modes modes = modes_of({1.03, 1.9, 2.4, 5.0}, MatrixXd(0, 4));
  const auto compare = [&](const ModalNoise& noise) {
    const ModalLikelihood likelihood(data);
    double log_density = 1.0;
    std::vector<double> frequencies;
    ASSERT_TRUE(likelihood.add_density_of_frequencies(modes, noise, log_density, frequencies));
    const auto score = likelihood.score(modes, noise);
    EXPECT_NEAR(log_density - 1.0, score.log_likelihood, 1e-12 * std::abs(score.log_likelihood));
    ASSERT_EQ(frequencies.size(), score.matches.size());
    for (std::size_t i = 0; i < frequencies.size(); ++i)
      EXPECT_EQ(frequencies[i], score.matches[i].frequency_hz);
  };
  compare({});
  compare({.discrepancy = 0.03});
  compare({.emulator_variance = {1e-4, 1.0, 2e-4}});
  data.cov_prior = inference::LogNormal{-4.0, 1.0};
  compare({.cov = 0.01});
  double ignored = 0.0;
  std::vector<double> frequencies;
  data.cov_prior = {};
  data.covariance(0, 2) = data.covariance(2, 0) = 1e-5;
  EXPECT_FALSE(ModalLikelihood(data).add_density_of_frequencies(modes, {}, ignored, frequencies));
}

// A gap keeps the numbers of the following modes; with shapes it is not matched.
TEST(ModalLikelihood, GapsKeepTheNumbersOfOtherModes) {
  const Modes modes = modes_of({1.0, 3.0, 5.0, 7.0}, three_shapes());
  const ModalLikelihood numbered(data_of({1.0, kNaN, 5.0}, 0.01, MatrixXd(), 0.0));
  EXPECT_EQ(numbered.score(modes, {}).matches[2].computed, 2);
  EXPECT_EQ(numbered.score(modes, {}).chi_square, 0.0);

  MatrixXd shapes(5, 3);
  shapes.setConstant(kNaN);
  shapes.row(0) = three_shapes().col(1).transpose();
  shapes.row(4) = three_shapes().col(3).transpose();
  const ModalData data = data_of({3.0, kNaN, kNaN, kNaN, 7.0}, 0.01, shapes, 0.02);
  EXPECT_EQ(data.measured_modes(), 2);
  EXPECT_EQ(data.least_modes(), 2);
  const ModalLikelihood::Score score = ModalLikelihood(data).score(modes, {});
  EXPECT_EQ(score.matches[0].computed, 1);
  EXPECT_EQ(score.matches[4].computed, 3);
  EXPECT_NEAR(score.chi_square, 0.0, 1e-12);
}

TEST(ModalLikelihood, AnEmulatorsErrorAddsToTheNoise) {
  const Modes modes = modes_of({1.02, 2.97, 5.0}, MatrixXd(0, 3));
  const ModalData data = data_of({1.0, kNaN, 5.1}, 0.01, {}, 0.0);
  ModalData wider = data;
  wider.covariance(0, 0) += 4e-4;
  wider.covariance(2, 2) += 9e-4;
  const ModalNoise noise{.emulator_variance = {4e-4, 25.0, 9e-4}};
  EXPECT_DOUBLE_EQ(ModalLikelihood(data).score(modes, noise).log_likelihood,
                   ModalLikelihood(wider).score(modes, {}).log_likelihood);
  EXPECT_NE(ModalLikelihood(data).score(modes, {}).log_likelihood,
            ModalLikelihood(wider).score(modes, {}).log_likelihood);
}

TEST(ModalLikelihood, PullsAreDerivativesByFrequency) {
  ModalData data = data_of({1.0, kNaN, 5.1}, 0.01, {}, 0.0);
  data.covariance(0, 2) = data.covariance(2, 0) = 2e-4;
  const ModalLikelihood likelihood(data);
  const std::vector<double> f = {1.02, 2.97, 5.0};
  const auto pulls = likelihood.pulls(modes_of(f, MatrixXd(0, 3)), {});
  for (std::size_t i = 0; i < f.size(); ++i) {
    const auto at = [&](double step) {
      std::vector<double> moved = f;
      moved[i] += step;
      return likelihood.score(modes_of(moved, MatrixXd(0, 3)), {}).log_likelihood;
    };
    // Quadratic: central differences are exact to rounding.
    EXPECT_NEAR(pulls[i], (at(1e-4) - at(-1e-4)) / 2e-4, 1e-5 * (1.0 + std::abs(pulls[i]))) << i;
  }
}

TEST(ModalLikelihood, FrequenciesWithACovarianceAreNormal) {
  ModalData data = data_of({1.0, 3.0}, 0.01, {}, 0.0);
  data.covariance << 0.0004, 0.0003, 0.0003, 0.0009;
  const ModalLikelihood likelihood(data);
  const Modes modes = modes_of({1.02, 2.97, 5.0}, MatrixXd(0, 3));
  const Eigen::Vector2d r(1.0 - 1.02, 3.0 - 2.97);
  const double expected = -0.5 * r.dot(data.covariance.inverse() * r) -
                          0.5 * std::log(data.covariance.determinant()) -
                          std::log(2.0 * std::numbers::pi);
  EXPECT_NEAR(likelihood.score(modes, {}).log_likelihood, expected, 1e-10);
  EXPECT_EQ(likelihood.measured(), 2);
}

TEST(ModalLikelihood, AnUnknownCovHasItsNormaliser) {
  ModalData data = data_of({1.0, 3.0}, 0.01, {}, 0.0);
  const Modes modes = modes_of({1.01, 2.97}, MatrixXd(0, 2));
  const double stated = ModalLikelihood(data).score(modes, {}).log_likelihood;
  data.covariance.resize(0, 0);
  data.cov_prior = inference::LogUniform{1e-4, 1e-1};
  EXPECT_NEAR(ModalLikelihood(data).score(modes, {.cov = 0.01}).log_likelihood, stated, 1e-10);
  EXPECT_NEAR(
      ModalLikelihood(data).score(modes, {.cov = 0.006, .discrepancy = 0.008}).log_likelihood,
      stated, 1e-10);
}

// Permuting rows, with one missing in the middle, must not change the posterior.
TEST(ModalLikelihood, TheOrderOfMeasuredModesDoesNotMatter) {
  const MatrixXd shapes = three_shapes();
  const Modes modes = modes_of({1.0, 2.0, 3.0, 4.0}, shapes);
  MatrixXd measured = shapes.leftCols(3).transpose();
  const double ordered = ModalLikelihood(data_of({1.01, 1.99, 3.02}, 0.01, measured, 0.02))
                             .score(modes, {})
                             .log_likelihood;
  measured.row(0).swap(measured.row(1));
  measured.row(1) *= -3.0;
  const auto swapped =
      ModalLikelihood(data_of({1.99, 1.01, 3.02}, 0.01, measured, 0.02)).score(modes, {});
  EXPECT_NEAR(swapped.log_likelihood, ordered, 1e-9);
  EXPECT_EQ(swapped.matches[0].computed, 1);
  EXPECT_EQ(swapped.matches[1].computed, 0);
}

TEST(ModalLikelihood, AModeMayBeMissingInTheMiddle) {
  const MatrixXd shapes = three_shapes();
  const Modes modes = modes_of({1.0, 2.0, 3.0, 4.0}, shapes);
  MatrixXd measured(2, 3);
  measured << shapes.col(0).transpose(), shapes.col(2).transpose();
  const auto found = ModalLikelihood(data_of({1.0, 3.0}, 0.01, measured, 0.02)).score(modes, {});
  EXPECT_EQ(found.matches[1].computed, 2);
  EXPECT_NEAR(found.chi_square, 0.0, 1e-9);
}

// Two modes that crossed: their shapes identify them, although the frequencies are equally close to
// both.
TEST(ModalLikelihood, CrossedModesAreMatchedByTheirShapes) {
  const MatrixXd shapes = three_shapes();
  const Modes modes = modes_of({2.0, 2.2, 3.0, 4.0}, shapes);
  MatrixXd measured(2, 3);
  measured << shapes.col(1).transpose(), shapes.col(0).transpose();
  const auto found = ModalLikelihood(data_of({2.1, 2.1}, 0.05, measured, 0.02)).score(modes, {});
  EXPECT_EQ(found.matches[0].computed, 1);
  EXPECT_EQ(found.matches[1].computed, 0);
}

TEST(ModalLikelihood, FrequenciesAloneAreMatchedByOrder) {
  const Modes modes = modes_of({1.0, 2.0, 3.0}, MatrixXd(0, 3));
  const auto found = ModalLikelihood(data_of({kNaN, 3.0}, 0.01, {}, 0.0)).score(modes, {});
  EXPECT_EQ(found.matches[1].computed, 1) << "not the nearest, but the second";
}

// Shapes of two approaching modes may rotate: the likelihood is continuous.
TEST(ModalLikelihood, IsContinuousForApproachingModes) {
  const MatrixXd shapes = three_shapes();
  MatrixXd measured(1, 3);
  measured << (shapes.col(0) + 0.03 * shapes.col(1)).transpose();
  const ModalLikelihood likelihood(data_of({2.0}, 0.02, measured, 0.02));
  double before = kNaN;
  for (double gap = 0.06; gap > 1e-5; gap *= 0.998) {
    const Modes modes = modes_of({2.0, 2.0 * (1.0 + 0.5 * gap), 6.0, 9.0}, shapes);
    const double now = likelihood.score(modes, {}).log_likelihood;
    if (!std::isnan(before)) {
      EXPECT_LT(std::abs(now - before), 0.012) << "gap " << gap;
    }
    before = now;
  }
}

TEST(ModalLikelihood, RejectsShapesOfWrongSizeNamingTheMode) {
  ModalData data = data_of({1.0, 3.0}, 0.01, MatrixXd::Ones(2, 3), 0.02);
  data.shapes(1, 0) = data.shapes(1, 1) = kNaN;
  try {
    const ModalLikelihood likelihood(data);
    FAIL() << "one entry is not a shape";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("mode 2"), std::string::npos) << error.what();
  }
}

/// ln (e^a + e^b).
double log_sum(double a, double b) {
  return std::max(a, b) + std::log1p(std::exp(-std::abs(a - b)));
}

// Closed form: 1/(1.5 f) for the frequency, and for the shape 1/2π on the half sphere.
TEST(ModalLikelihood, APossiblySpuriousModeIsAMixture) {
  const Modes modes = modes_of({1.0, 2.0, 3.0, 4.0}, three_shapes());
  constexpr double kDoubt = 0.1;
  int doubted = 0;
  for (const double turn : {0.0, 0.08, 0.12, 0.5}) {
    const VectorXd shape = three_shapes().col(1) + turn * VectorXd::Unit(3, 2);
    ModalData data = data_of({2.03}, 0.01, shape.transpose(), 0.02);
    const double real = ModalLikelihood(data).score(modes, {}).log_likelihood;
    data.doubt = kDoubt;
    const auto found = ModalLikelihood(data).score(modes, {});
    const double size = shape.norm() / shape.cwiseAbs().maxCoeff();
    const double spurious = std::log(kDoubt) - std::log(1.5 * 2.03) -
                            std::log(2.0 * std::numbers::pi) - 2.0 * std::log(size);
    const double expected = log_sum(std::log(1.0 - kDoubt) + real, spurious);
    EXPECT_NEAR(found.log_likelihood, expected, 1e-10) << turn;
    EXPECT_NEAR(found.matches[0].spurious, std::exp(spurious - expected), 1e-10) << turn;
    EXPECT_EQ(found.freedoms, found.matches[0].spurious < 0.5 ? 3 : 0) << turn;
    doubted += found.matches[0].spurious > 0.5;
  }
  EXPECT_GT(doubted, 0);
  EXPECT_LT(doubted, 4);
}

// The computed mode is left to a measured mode of the structure.
TEST(ModalLikelihood, ASpuriousModeDoesNotReplaceAnother) {
  const MatrixXd shapes = three_shapes();
  const Modes modes = modes_of({1.0, 2.0, 3.0, 4.0}, shapes);
  MatrixXd measured(5, 3);
  measured << shapes.transpose().topRows(2), Eigen::RowVector3d(0.9, 0.8, -1.0),
      shapes.transpose().bottomRows(2);
  ModalData data = data_of({1.0, 2.0, 2.0, 3.0, 4.0}, 0.01, measured, 0.02);
  data.doubt = 0.05;
  const auto found = ModalLikelihood(data).score(modes, {});
  const int computed[] = {0, 1, -1, 2, 3};
  for (int i = 0; i < 5; ++i) {
    const auto& match = found.matches[static_cast<std::size_t>(i)];
    if (i == 2) {
      EXPECT_GT(match.spurious, 0.999);
    } else {
      EXPECT_EQ(match.computed, computed[i]);
      EXPECT_LT(match.spurious, 1e-3);
    }
  }
}

void expect_gradient_of_differences(const UpdateCase& update_case, const std::vector<double>& x) {
  const auto problem = make_update_problem(update_case);
  const auto likelihood = problem->problem.likelihood();
  std::vector<double> gradient(x.size());
  ASSERT_TRUE(likelihood->gradient(0, x, gradient));
  for (std::size_t p = 0; p < x.size(); ++p) {
    auto up = x, down = x;
    const double step = 1e-5 * x[p];
    up[p] += step, down[p] -= step;
    const double slope =
        (likelihood->log_likelihood(0, up) - likelihood->log_likelihood(0, down)) / (2.0 * step);
    EXPECT_NEAR(gradient[p], slope, 1e-5 * std::abs(slope) + 1e-9) << p;
  }
}

TEST(ModalLikelihood, GradientsOfPossiblySpuriousModesAgreeWithDifferences) {
  for (const double second : {0.4, 0.62}) {  // matches well, matches hardly
    UpdateCase update_case = modal::two_storeys(0.01, 0.05);
    update_case.data.shapes(0, 0) = second;
    update_case.data.doubt = 0.2;
    expect_gradient_of_differences(update_case, {1400.0, 900.0});
  }
}

/// A tuned mass damper: two modes closer than 2 %, which the model error may rotate.
UpdateCase close_modes() {
  UpdateCase out{.title = "damper",
                 .structure = modal::chain({1e4, 1.0}, {inference::Uniform{5e6, 15e6},
                                                        inference::Uniform{500.0, 1500.0}})};
  out.data.sensors = modal::at_masses({1, 2});
  out.simulation = ModalSimulation{
      .parameters = {1e7, 1005.0}, .modes = 2, .cov = 0.01, .shape_sd = 0.1, .seed = 4};
  simulate(out, 4);
  return out;
}

TEST(ModalLikelihood, GradientsOfModesThatMayRotateOrMixAgreeWithDifferences) {
  UpdateCase update_case = close_modes();
  expect_gradient_of_differences(update_case, {1.001e7, 1003.0});
  update_case.data.discrepancy.value = 0.01;
  update_case.data.mixing.value = 0.7;
  expect_gradient_of_differences(update_case, {1.001e7, 1003.0});
}

// Without residuals, the information is minus the expected Hessian: compared with differences of
// gradients at the parameters that give the data.
TEST(ModalLikelihood, TheInformationIsTheHessianAtAPerfectFit) {
  UpdateCase update_case = modal::two_storeys(0.01, 0.05);
  const std::vector<double> x = {1400.0, 900.0};
  {
    const auto problem = make_update_problem(update_case);
    StructuralPredictor predictor(*problem);
    ModeObservation::Scored scored;
    ASSERT_TRUE(predictor.score(0, x, scored));
    for (Eigen::Index i = 0; i < 2; ++i) {
      update_case.data.frequencies_hz[static_cast<std::size_t>(i)] =
          std::sqrt(scored.modes[0].eigenvalues[i]) / kTwoPi;
      update_case.data.shapes.row(i) = scored.modes[0].shapes.col(i).transpose();
    }
  }
  const auto problem = make_update_problem(update_case);
  const auto likelihood = problem->problem.likelihood();
  EXPECT_TRUE(likelihood->has_exact_derivatives());
  const std::vector<double> steps = {3.0, -2.0};
  std::vector<double> gradient(2), information(4);
  ASSERT_TRUE(likelihood->gauss_newton(0, x, steps, gradient, information));
  for (std::size_t j = 0; j < 2; ++j) {
    EXPECT_NEAR(gradient[j], 0.0, 1e-6);
    auto up = x, down = x;
    up[j] += 1.0, down[j] -= 1.0;
    std::vector<double> above(2), below(2);
    ASSERT_TRUE(likelihood->gradient(0, up, above));
    ASSERT_TRUE(likelihood->gradient(0, down, below));
    for (std::size_t i = 0; i < 2; ++i) {
      const double hessian = (above[i] - below[i]) / 2.0;
      EXPECT_NEAR(information[2 * i + j] / (steps[i] * steps[j]), -hessian,
                  2e-3 * std::abs(hessian) + 1e-12);
    }
  }
}

TEST(ModalLikelihood, DoubtNeedsShapes) {
  ModalData data = data_of({1.0, 3.0}, 0.01, {}, 0.0);
  data.doubt = 0.1;
  EXPECT_THROW(ModalLikelihood{data}, std::invalid_argument);
}

TEST(ModalLikelihood, GradientsAgreeWithDifferences) {
  UpdateCase update_case = modal::two_storeys(0.01, 0.05);
  update_case.data.discrepancy.prior = inference::LogUniform{1e-3, 1e-1};
  expect_gradient_of_differences(update_case, {1300.0, 1000.0, 0.02});
}

}  // namespace
}  // namespace wheeltap::identification::modal_likelihood_test
