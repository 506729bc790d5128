#include "identification/modal/bayesian_modes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <iostream>
#include <numbers>

#include "../signals/random_vibration.hpp"
#include "base/eigen_solvers.hpp"
#include "signals/modal/modal_identification.hpp"

namespace wheeltap::identification {
namespace {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kStep = 0.05, kSeconds = 900.0, kZeta = 0.015;

constexpr BayesianBandOptions kShort{.warmup = 2000, .draws = 1500, .searches = 10};

MatrixXd record_of_chain(double noise, std::uint64_t seed) {
  return signals::chain(3, 1.0, 200.0).accelerations(std::lround(kSeconds / kStep), noise, seed);
}

// Compares ln p with -Σ ln |E| - Σ Fᴴ E⁻¹ F - n ln π from full matrices.
TEST(BayesianModes, LikelihoodIsTheComplexNormalDensity) {
  const ModalBand band{.lowest_hz = 2.0, .highest_hz = 3.2, .peaks_hz = {2.4, 2.8}};
  const MatrixXd records = record_of_chain(0.05, 3).leftCols(4000);
  const BandLines lines = band_lines(records, 1.0 / kStep, band);
  const BandProblem of(lines, band);
  std::vector<double> x = {2.4, 0.02, 0.3, 0.1, -0.2, 2.9, 0.03, 0.2, 0.3, 0.1, 0.4, -0.6, 0.05};
  ASSERT_EQ(x.size(), of.parameters().size());
  const MatrixXcd phi = of.shapes(x).cast<std::complex<double>>();
  const std::complex<double> l(0.4, -0.6);
  MatrixXcd triangle(2, 2);
  triangle << std::sqrt(0.3), 0.0, l * std::sqrt(0.2) / std::sqrt(1.0 + std::norm(l)),
      std::sqrt(0.2) / std::sqrt(1.0 + std::norm(l));
  const MatrixXcd force = triangle * triangle.adjoint();
  double expected = 0.0;
  for (Eigen::Index k = 0; k < lines.frequencies_hz.size(); ++k) {
    MatrixXcd h = MatrixXcd::Zero(2, 2);
    for (int i = 0; i < 2; ++i) {
      const double beta = (i == 0 ? 2.4 : 2.9) / lines.frequencies_hz[k];
      h(i, i) = 1.0 / std::complex<double>(1.0 - beta * beta, -2.0 * (i == 0 ? 0.02 : 0.03) * beta);
    }
    const MatrixXcd e =
        phi * h * force * h.adjoint() * phi.transpose() + 0.05 * MatrixXcd::Identity(3, 3);
    const Eigen::VectorXcd f = lines.transform.col(k);
    expected -= std::log(std::abs(e.determinant())) + f.dot(e.inverse() * f).real() +
                3.0 * std::log(std::numbers::pi);
  }
  EXPECT_NEAR(of.log_likelihood(x), expected, 1e-9 * std::abs(expected));
  std::swap(x[0], x[5]);
  EXPECT_EQ(of.log_likelihood(x), -INFINITY);
}

// White noise of variance σ² has the one-sided density 2 σ² Δt.
TEST(BayesianModes, LinesAreScaledAsOneSidedDensity) {
  base::Random random(4, 0, 0, base::Purpose::test);
  MatrixXd white(2, 20000);
  for (double& v : white.reshaped()) v = random.normal();
  const BandLines lines =
      band_lines(white, 10.0, {.lowest_hz = 1.0, .highest_hz = 4.0, .peaks_hz = {2.0}});
  const auto count = static_cast<double>(lines.transform.size());
  EXPECT_NEAR(lines.transform.squaredNorm() / count, 0.2, 4.0 * 0.2 / std::sqrt(count));
}

// For the chain of three masses, each mode's posterior agrees with the subspace method, and its
// standard deviation with the long-data law, cov(f) = √(ζ/(2πN)), cov(ζ) = 1/√(2πζN) (Au 2017,
// section 15).
TEST(BayesianModes, AgreesWithTheSubspaceMethodAndTheLongDataLaw) {
  const MatrixXd records = record_of_chain(0.05, 11);
  const VectorXd truth = signals::chain(3, 1.0, 200.0).modes().frequencies_hz;
  const signals::ModalResult other =
      signals::identify_modes(records, {.sample_rate_hz = 1.0 / kStep, .lowest_hz = 0.3});
  ASSERT_EQ(other.modes.size(), 3U);
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double f = truth[i];
    const BayesianBand found =
        identify_band(records, 1.0 / kStep,
                      {.lowest_hz = 0.85 * f, .highest_hz = 1.15 * f, .peaks_hz = {f}}, kShort);
    const double sd = std::sqrt(found.covariance(0, 0)),
                 sd_zeta = std::sqrt(found.covariance(1, 1));
    const double cycles = f * kSeconds;
    EXPECT_TRUE(found.converged);
    EXPECT_LT(std::abs(found.frequencies_hz[0] - f), 4.0 * sd) << i;
    EXPECT_LT(std::abs(found.damping[0] - kZeta), 4.0 * sd_zeta) << i;
    EXPECT_NEAR(sd / (f * std::sqrt(kZeta / (2.0 * std::numbers::pi * cycles))), 1.15, 0.35) << i;
    EXPECT_NEAR(sd_zeta / (kZeta / std::sqrt(2.0 * std::numbers::pi * kZeta * cycles)), 1.15, 0.35)
        << i;
    const signals::Pole& pole = other.modes[static_cast<std::size_t>(i)].pole;
    EXPECT_LT(std::abs(found.frequencies_hz[0] - pole.frequency_hz),
              2.0 * std::hypot(sd, pole.frequency_sd))
        << i;
    EXPECT_NEAR(sd / pole.frequency_sd, 1.0, 0.4) << i;
    EXPECT_NEAR(sd_zeta / pole.damping_sd, 1.0, 0.4) << i;
    EXPECT_GT(
        signals::modal_assurance(pole.shape, found.shapes.col(0).cast<std::complex<double>>()),
        0.999)
        << i;
    std::cout << "f " << found.frequencies_hz[0] << " +- " << sd << " (" << pole.frequency_hz
              << " +- " << pole.frequency_sd << "), zeta " << found.damping[0] << " +- " << sd_zeta
              << " (" << pole.damping << " +- " << pole.damping_sd << "), "
              << found.likelihood_evaluations << " calls\n";
  }
}

// Two modes 2 % apart, with similar bandwidth, in one band: compared with the truth.
TEST(BayesianModes, CloseModesShareABand) {
  signals::VibratingStructure structure = signals::chain(3, 1.0, 200.0);
  structure.stiffness << 204, -4, 0, -4, 204, 0, 0, 0, 600;
  const signals::VibratingStructure::Modes truth = structure.modes();
  const MatrixXd records = structure.accelerations(std::lround(kSeconds / kStep), 0.05, 5);
  const double first = truth.frequencies_hz[0], second = truth.frequencies_hz[1];
  const BayesianBand found = identify_band(
      records, 1.0 / kStep,
      {.lowest_hz = 0.85 * first, .highest_hz = 1.15 * second, .peaks_hz = {first, second}},
      kShort);
  ASSERT_EQ(found.frequencies_hz.size(), 2);
  for (const std::string& why : found.not_established) std::cout << why << "\n";
  for (Eigen::Index i = 0; i < 2; ++i) {
    const double f = truth.frequencies_hz[i], sd = std::sqrt(found.covariance(i, i)),
                 sd_zeta = std::sqrt(found.covariance(2 + i, 2 + i));
    std::cout << "f " << found.frequencies_hz[i] << " +- " << sd << " of " << f << ", zeta "
              << found.damping[i] << " +- " << sd_zeta << "\n"
              << found.shapes.col(i).transpose() << "\n";
    EXPECT_LT(std::abs(found.frequencies_hz[i] - f), 4.0 * sd) << i;
    EXPECT_LT(std::abs(found.damping[i] - kZeta), 4.0 * sd_zeta) << i;
    EXPECT_LT(sd, 0.005 * f) << i;
    // A shape and its covariance, without the entry that is 1.
    Eigen::Index top = 0;
    found.shapes.col(i).cwiseAbs().maxCoeff(&top);
    const VectorXd off = found.shapes.col(i) - truth.shapes.col(i) / truth.shapes(top, i);
    for (Eigen::Index s = 0; s < 3; ++s)
      EXPECT_LT(std::abs(off[s]),
                4.0 * std::sqrt(found.shape_covariances[static_cast<std::size_t>(i)](s, s)) + 1e-12)
          << i << ", " << s;
  }
}

TEST(BayesianModes, RejectsInvalidInput) {
  const MatrixXd records = record_of_chain(0.05, 3).leftCols(2000);
  const auto refused = [&](const ModalBand& band) {
    EXPECT_THROW(static_cast<void>(BandProblem(band_lines(records, 1.0 / kStep, band), band)),
                 std::invalid_argument);
  };
  refused({.lowest_hz = 2.0, .highest_hz = 12.0, .peaks_hz = {2.5}});
  refused({.lowest_hz = 3.0, .highest_hz = 2.0, .peaks_hz = {2.5}});
  refused({.lowest_hz = 2.0, .highest_hz = 3.0, .peaks_hz = {}});
  refused({.lowest_hz = 2.0, .highest_hz = 3.0, .peaks_hz = {3.5}});
  refused({.lowest_hz = 2.0, .highest_hz = 3.0, .peaks_hz = {2.6, 2.4}});
  refused({.lowest_hz = 2.0, .highest_hz = 2.1, .peaks_hz = {2.05}});
  refused({.lowest_hz = 1.0, .highest_hz = 4.0, .peaks_hz = {1.5, 2.0, 2.5, 3.0}});
}

}  // namespace
}  // namespace wheeltap::identification
