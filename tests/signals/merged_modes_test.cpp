#include "signals/modal/merged_modes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/random.hpp"
#include "random_vibration.hpp"

namespace wheeltap::signals {
namespace {

using testing::ElementsAre;

/// A set-up that measures these degrees of freedom of whole shapes. Each mode has its own factor
/// and errors with the stated covariance.
SetUpModes seen(const std::vector<int>& sensors, const Eigen::VectorXd& frequencies,
                const Eigen::MatrixXd& shapes, double error, std::uint64_t seed) {
  base::Random random(seed, 0, 0, base::Purpose::test);
  const Eigen::Index count = frequencies.size();
  SetUpModes out{.covariance = Eigen::MatrixXd::Zero(2 * count, 2 * count), .sensors = sensors};
  const auto own = static_cast<Eigen::Index>(sensors.size());
  for (Eigen::Index m = 0; m < count; ++m) {
    Mode mode;
    const double f_sd = error * frequencies[m], damping_sd = error;
    mode.pole.frequency_hz = frequencies[m] + f_sd * random.normal();
    mode.pole.damping = 0.02 + damping_sd * random.normal();
    mode.pole.frequency_sd = f_sd;
    mode.pole.damping_sd = damping_sd;
    out.covariance(m, m) = f_sd * f_sd;
    out.covariance(count + m, count + m) = damping_sd * damping_sd;
    mode.pole.shape.resize(own);
    for (Eigen::Index c = 0; c < own; ++c)
      mode.pole.shape[c] = {
          shapes(sensors[static_cast<std::size_t>(c)], m) + error * random.normal(),
          error * random.normal()};
    mode.shape_covariance = error * error * Eigen::MatrixXd::Identity(2 * own, 2 * own);
    const std::complex<double> factor = std::polar(0.3 + random.uniform(), 6.28 * random.uniform());
    mode.pole.shape *= factor;
    mode.shape_covariance *= std::norm(factor);  // of circular errors
    out.modes.push_back(std::move(mode));
  }
  return out;
}

struct Whole {
  Eigen::VectorXd frequencies = Eigen::Vector3d(1.0, 2.1, 3.3);
  Eigen::MatrixXd shapes = Eigen::MatrixXd(6, 3);
  std::vector<std::vector<int>> set_ups = {{0, 1, 2}, {0, 1, 3}, {4, 5, 1, 0}};
  Whole() {
    for (Eigen::Index k = 0; k < 6; ++k)
      for (Eigen::Index m = 0; m < 3; ++m)
        shapes(k, m) = std::sin((0.4 + static_cast<double>(k)) * (1.0 + static_cast<double>(m)));
  }
  [[nodiscard]] std::vector<SetUpModes> all(double error, std::uint64_t seed) const {
    std::vector<SetUpModes> out;
    for (std::size_t s = 0; s < set_ups.size(); ++s)
      out.push_back(seen(set_ups[s], frequencies, shapes, error, seed + 100 * s));
    return out;
  }
};

TEST(MergedModes, MergesPartialShapes) {
  const Whole whole;
  const MergedModes merged = merge_modes(whole.all(1e-9, 1), 6);
  EXPECT_THAT(merged.references, ElementsAre(0, 1));
  ASSERT_EQ(merged.modes.size(), 3U);
  for (Eigen::Index m = 0; m < 3; ++m) {
    const MergedMode& mode = merged.modes[static_cast<std::size_t>(m)];
    EXPECT_EQ(mode.found(), 3);
    EXPECT_NEAR(mode.frequency_hz, whole.frequencies[m], 1e-7);
    EXPECT_NEAR(modal_assurance(mode.shape, whole.shapes.col(m).cast<std::complex<double>>()), 1.0,
                1e-7);
    EXPECT_NEAR(mode.shape.cwiseAbs().maxCoeff(), 1.0, 1e-9);
    EXPECT_GT(mode.collinearity, 1.0 - 1e-7);
  }
}

// Over many realisations errors match the covariances: χ² of entries has its expectation.
TEST(MergedModes, CovariancesMatchTheErrors) {
  const Whole whole;
  constexpr int kRuns = 400;
  double shape = 0.0, frequency = 0.0, damping = 0.0;
  int entries = 0;
  for (int run = 0; run < kRuns; ++run) {
    const MergedModes merged =
        merge_modes(whole.all(0.01, 1000 + 7 * static_cast<std::uint64_t>(run)), 6);
    ASSERT_EQ(merged.modes.size(), 3U);
    for (Eigen::Index m = 0; m < 3; ++m) {
      const MergedMode& mode = merged.modes[static_cast<std::size_t>(m)];
      frequency += std::pow((mode.frequency_hz - whole.frequencies[m]) / mode.frequency_sd, 2);
      damping += std::pow((mode.damping - 0.02) / mode.damping_sd, 2);
      Eigen::Index top = 0;
      mode.shape.cwiseAbs().maxCoeff(&top);
      const Eigen::VectorXcd truth =
          (whole.shapes.col(m) / whole.shapes(top, m)).cast<std::complex<double>>();
      for (Eigen::Index k = 0; k < 6; ++k) {
        if (k == top) continue;
        const std::complex<double> error = mode.shape[k] - truth[k];
        shape += std::pow(error.real(), 2) / mode.shape_covariance(k, k) +
                 std::pow(error.imag(), 2) / mode.shape_covariance(6 + k, 6 + k);
        entries += 2;
      }
    }
  }
  // The variance of frequencies and damping ratios between set-ups is estimated as >= 0, so
  // normalised errors are too small by some tenths at most. 1200 squares have a standard error of
  // .041.
  EXPECT_NEAR(frequency / (3 * kRuns), 0.9, 0.2);
  EXPECT_NEAR(damping / (3 * kRuns), 0.9, 0.2);
  // 12000 squares, correlated within a mode (10 of them): at most .041 again.
  EXPECT_NEAR(shape / entries, 1.0, 0.12);
}

TEST(MergedModes, AMissingModeLeavesAGapInTheShape) {
  const Whole whole;
  std::vector<SetUpModes> set_ups = whole.all(1e-3, 5);
  set_ups[1].modes.erase(set_ups[1].modes.begin() + 1);
  Eigen::MatrixXd less(4, 4);
  const std::vector<Eigen::Index> kept = {0, 2, 3, 5};
  for (Eigen::Index i = 0; i < 4; ++i)
    for (Eigen::Index j = 0; j < 4; ++j)
      less(i, j) = set_ups[1].covariance(kept[static_cast<std::size_t>(i)],
                                         kept[static_cast<std::size_t>(j)]);
  set_ups[1].covariance = less;
  const MergedModes merged = merge_modes(set_ups, 6);
  ASSERT_EQ(merged.modes.size(), 3U);
  EXPECT_THAT(merged.modes[1].places, ElementsAre(1, -1, 1));
  EXPECT_TRUE(std::isnan(merged.modes[1].shape[3].real()));
  EXPECT_FALSE(std::isnan(merged.modes[0].shape[3].real()));
  EXPECT_TRUE(merged.modes[1].shape_covariance.allFinite());
  EXPECT_TRUE(merged.covariance.allFinite());
}

TEST(MergedModes, ReportsInconsistentSetUps) {
  const Whole whole;
  std::vector<SetUpModes> set_ups = whole.all(1e-4, 9);
  set_ups[2].modes[0].pole.frequency_hz *= 1.01;  // a hundred standard deviations
  const MergedModes merged = merge_modes(set_ups, 6);
  ASSERT_EQ(merged.modes.size(), 3U);
  EXPECT_THAT(merged.modes[0].doubts, testing::Contains(MergeDoubt::inconsistent));
  EXPECT_GT(merged.modes[0].frequency_sd, 1e-3) << "and the interval holds what they say";
  EXPECT_TRUE(merged.modes[1].doubts.empty());
}

// Close in frequency, but separated by their shapes at the references.
TEST(MergedModes, KeepsCloseModesApart) {
  Whole whole;
  whole.frequencies = Eigen::Vector3d(1.0, 1.005, 3.3);
  const MergedModes merged = merge_modes(whole.all(1e-3, 11), 6);
  ASSERT_EQ(merged.modes.size(), 3U);
  for (std::size_t m = 0; m < 2; ++m)
    EXPECT_GT(modal_assurance(
                  merged.modes[m].shape,
                  whole.shapes.col(static_cast<Eigen::Index>(m)).cast<std::complex<double>>()),
              0.999);
}

// From records of a chain of six masses, with sensors on the first two in every set-up.
TEST(MergedModes, MergesModesFromRecordsOfAChain) {
  const VibratingStructure structure = chain(6, 1.0, 400.0);
  const VibratingStructure::Modes truth = structure.modes();
  std::vector<SetUpModes> set_ups;
  std::uint64_t seed = 20;
  for (const std::vector<int>& sensors :
       std::vector<std::vector<int>>{{0, 5, 1, 2}, {0, 5, 3}, {4, 0, 5}}) {
    const Eigen::MatrixXd all = structure.accelerations(12000, 0.05, seed++);
    Eigen::MatrixXd records(static_cast<Eigen::Index>(sensors.size()), all.cols());
    for (std::size_t c = 0; c < sensors.size(); ++c)
      records.row(static_cast<Eigen::Index>(c)) = all.row(sensors[c]);
    ModalResult found = identify_modes(records, {.sample_rate_hz = 20.0, .lowest_hz = 0.3});
    set_ups.push_back({.modes = found.modes,
                       .covariance = found.covariance,
                       .sensors = sensors,
                       .covariance_samples = found.covariance_samples() - (sensors[0] == 4)});
  }
  const MergedModes merged = merge_modes(set_ups, 6);
  EXPECT_EQ(merged.covariance_samples, 49);
  ASSERT_GE(merged.modes.size(), 5U);
  for (std::size_t m = 0; m < 5; ++m) {
    const MergedMode& mode = merged.modes[m];
    const auto k = static_cast<Eigen::Index>(m);
    EXPECT_EQ(mode.found(), 3) << m;
    EXPECT_NEAR(mode.frequency_hz, truth.frequencies_hz[k], 5.0 * mode.frequency_sd);
    EXPECT_GT(modal_assurance(mode.shape, truth.shapes.col(k).cast<std::complex<double>>()), 0.99)
        << m;
  }
}

TEST(MergedModes, ExactSetUpsHaveFiniteMeans) {
  const Whole whole;
  const MergedModes merged = merge_modes(whole.all(0.0, 3), 6);
  ASSERT_EQ(merged.modes.size(), 3U);
  for (const MergedMode& mode : merged.modes) {
    EXPECT_TRUE(std::isfinite(mode.frequency_hz) && std::isfinite(mode.damping_sd));
    EXPECT_TRUE(mode.shape_covariance.allFinite());
  }
}

TEST(MergedModes, RejectsMisuse) {
  const Whole whole;
  EXPECT_THROW(merge_modes({}, 6), std::invalid_argument);
  std::vector<SetUpModes> set_ups = whole.all(1e-3, 1);
  EXPECT_THROW(merge_modes(set_ups, 5), std::invalid_argument);
  set_ups[0].sensors = {0, 0, 1};
  EXPECT_THROW(merge_modes(set_ups, 6), std::invalid_argument);
  set_ups[0].sensors = {2, 3, 3 + 1};
  set_ups[1].sensors = {0, 1, 5};
  EXPECT_THROW(merge_modes(set_ups, 6), std::invalid_argument);
}

}  // namespace
}  // namespace wheeltap::signals
