#include "signals/modal/merged_subspace.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "random_vibration.hpp"
#include "signals/modal/modal_identification.hpp"

namespace wheeltap::signals {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Five masses, two with permanent sensors, the others measured in turn, under forces of different
/// strength.
struct MovingSensors {
  VibratingStructure structure = chain(5, 1.0, 400.0);
  std::vector<std::vector<int>> sensors = {{0, 1, 4}, {4, 2, 1}, {3, 1, 4}};
  std::vector<std::vector<int>> references = {{1, 2}, {2, 0}, {1, 2}};  // 1 and 4

  [[nodiscard]] std::vector<MatrixXd> records(std::uint64_t seed) const {
    std::vector<MatrixXd> out;
    for (std::size_t s = 0; s < sensors.size(); ++s) {
      const MatrixXd all = structure.accelerations(12000, 0.05, 10 * seed + s);
      MatrixXd y(static_cast<Index>(sensors[s].size()), all.cols());
      for (Index c = 0; c < y.rows(); ++c)
        y.row(c) = std::pow(3.0, static_cast<double>(s)) *
                   all.row(sensors[s][static_cast<std::size_t>(c)]);
      out.push_back(std::move(y));
    }
    return out;
  }
  [[nodiscard]] ModalResult identify(std::uint64_t seed) const {
    return identify_set_ups(records(seed), sensors, references, 5,
                            {.sample_rate_hz = 20.0, .largest_order = 20});
  }
};

// For 60 records of three set-ups: squared errors over their variances, for all modes. 300 squares
// have a standard error of .08, with few blocks .1; entries of one shape are correlated, so their
// mean is known to a fifth.
TEST(MergedSubspace, ModesOfAllSensorsAndTheirCovariances) {
  const MovingSensors moving;
  const VibratingStructure::Modes truth = moving.structure.modes();
  double frequency = 0.0, damping = 0.0, shape = 0.0;
  int modes = 0, entries = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const ModalResult found = moving.identify(seed);
    for (Index m = 0; m < 5; ++m) {
      const auto same = std::ranges::find_if(found.modes, [&](const Mode& mode) {
        return mode.doubts.empty() &&
               std::abs(mode.pole.frequency_hz / truth.frequencies_hz[m] - 1.0) < 0.03;
      });
      if (same == found.modes.end()) continue;
      ++modes;
      const Pole& p = same->pole;
      frequency += std::pow((p.frequency_hz - truth.frequencies_hz[m]) / p.frequency_sd, 2);
      damping += std::pow((p.damping - moving.structure.damping_ratio) / p.damping_sd, 2);
      EXPECT_GT(modal_assurance(p.shape, truth.shapes.col(m).cast<std::complex<double>>()), 0.95)
          << seed << ", mode " << m;
      Index top = 0;
      p.shape.cwiseAbs().maxCoeff(&top);
      for (Index k = 0; k < 5; ++k) {
        if (k == top) continue;
        const std::complex<double> error = p.shape[k] - truth.shapes(k, m) / truth.shapes(top, m);
        shape += std::pow(error.real(), 2) / same->shape_covariance(k, k);
        ++entries;
      }
    }
  }
  std::printf("%d modes: f %.2f, damping %.2f, shapes %.2f\n", modes, frequency / modes,
              damping / modes, shape / entries);
  EXPECT_GE(modes, 290);
  EXPECT_NEAR(frequency / modes, 1.0, 0.4);
  EXPECT_NEAR(damping / modes, 1.0, 0.4);
  EXPECT_NEAR(shape / entries, 1.0, 0.4);
}

// One set-up with all sensors as references is unchanged, except for the effect of the fixed B.
TEST(MergedSubspace, EqualsASingleSetUp) {
  const MovingSensors moving;
  const MatrixXd y = moving.structure.accelerations(12000, 0.05, 3);
  const ModalOptions options{.sample_rate_hz = 20.0, .largest_order = 20};
  const ModalResult alone = identify_modes(y, options);
  const ModalResult merged =
      identify_set_ups({y}, {{0, 1, 2, 3, 4}}, {{0, 1, 2, 3, 4}}, 5, options);
  ASSERT_EQ(merged.modes.size(), alone.modes.size());
  for (std::size_t m = 0; m < alone.modes.size(); ++m) {
    const Pole &a = alone.modes[m].pole, &b = merged.modes[m].pole;
    EXPECT_NEAR(a.frequency_hz, b.frequency_hz, 0.5 * a.frequency_sd);
    EXPECT_NEAR(b.frequency_sd / a.frequency_sd, 1.0, 0.5);
    EXPECT_GT(modal_assurance(a.shape, b.shape), 0.999);
  }
}

TEST(MergedSubspace, RejectsARankAboveThatOfTheReferences) {
  const MovingSensors moving;
  const std::vector<MatrixXd> y = moving.records(1);
  std::vector<SetUpCovariances> set_ups;
  for (std::size_t s = 0; s < y.size(); ++s)
    set_ups.push_back({.covariances = output_covariances(
                           y[s], {.lags = 8, .blocks = 10, .references = moving.references[s]}),
                       .sensors = moving.sensors[s]});
  EXPECT_EQ(merge_covariances(set_ups, 5, 4, 8).hankel.cols(), 8);
  EXPECT_THROW((void)merge_covariances(set_ups, 5, 4, 10), std::invalid_argument);
}

}  // namespace
}  // namespace wheeltap::signals
