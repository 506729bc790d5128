#include "signals/modal/modal_identification.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <utility>
#include <vector>

#include "random_vibration.hpp"
#include "signals/refuse.hpp"

namespace wheeltap::signals {
namespace {

using testing::Contains;

std::vector<double> frequencies(const ModalResult& result) {
  std::vector<double> out;
  for (const Mode& m : result.modes) out.push_back(m.pole.frequency_hz);
  return out;
}

const ModalOptions kChain{.sample_rate_hz = 20.0, .lowest_hz = 0.3};

TEST(ModalIdentification, FindsAChainWithItsCovariance) {
  const VibratingStructure structure = chain(3, 1.0, 200.0);
  const ModalResult found = identify_modes(structure.accelerations(18000, 0.05, 1), kChain);
  const VibratingStructure::Modes truth = structure.modes();
  ASSERT_EQ(found.modes.size(), 3U);
  ASSERT_EQ(found.covariance.rows(), 6);
  for (Eigen::Index m = 0; m < 3; ++m) {
    const Mode& mode = found.modes[static_cast<std::size_t>(m)];
    EXPECT_NEAR(mode.pole.frequency_hz, truth.frequencies_hz[m], 5.0 * mode.pole.frequency_sd);
    EXPECT_NEAR(mode.pole.damping, 0.015, 5.0 * mode.pole.damping_sd);
    EXPECT_NEAR(std::sqrt(found.covariance(m, m)), mode.pole.frequency_sd, 1e-12);
    EXPECT_NEAR(std::sqrt(found.covariance(3 + m, 3 + m)), mode.pole.damping_sd, 1e-12);
    EXPECT_GT(modal_assurance(mode.pole.shape, truth.shapes.col(m).cast<std::complex<double>>()),
              0.999);
    EXPECT_GT(mode.collinearity, 0.99);
    EXPECT_NEAR(mode.amplitude_kurtosis, 2.0, 0.5);
    EXPECT_TRUE(mode.doubts.empty());
    // The entry of 1 has no error.
    Eigen::Index top = 0;
    mode.pole.shape.cwiseAbs().maxCoeff(&top);
    EXPECT_NEAR(mode.shape_covariance(top, top), 0.0, 1e-20);
  }
}

// Regression: in a band below a tenth of its frequency, all modes counted as too close to an end.
TEST(ModalIdentification, DoubtsModesOnlyNearTheEndsOfTheBand) {
  const VibratingStructure structure = chain(1, 1.0, 200.0);
  const double hz = structure.modes().frequencies_hz[0];
  const auto is_doubted = [&](double lowest, double highest) {
    const ModalResult found =
        identify_modes(structure.accelerations(18000, 0.05, 1),
                       {.sample_rate_hz = 20.0, .lowest_hz = lowest, .highest_hz = highest});
    EXPECT_EQ(found.modes.size(), 1U);
    return std::ranges::count(found.modes.at(0).doubts, ModeDoubt::at_the_edge) > 0;
  };
  EXPECT_FALSE(is_doubted(0.96 * hz, 1.04 * hz));
  EXPECT_TRUE(is_doubted(0.5 * hz, 1.02 * hz));
}

// The automatic choice, given as a list, gives the same modes to the last bit.
TEST(ModalIdentification, PolesChosenByHandAreTheModes) {
  const Eigen::MatrixXd y = chain(3, 1.0, 200.0).accelerations(18000, 0.05, 1);
  const ModalResult automatic = identify_modes(y, kChain);
  ModalOptions options = kChain;
  for (const Mode& m : automatic.modes)
    options.poles.push_back({m.pole.order, 1.001 * m.pole.frequency_hz});
  std::ranges::reverse(options.poles);
  const ModalResult same = identify_modes(y, options);
  EXPECT_TRUE(same.chosen_by_hand);
  EXPECT_EQ(frequencies(same), frequencies(automatic));
  EXPECT_EQ(same.covariance, automatic.covariance);
  EXPECT_EQ(same.modes[1].present, automatic.modes[1].present);

  // Another order of the second mode alone: the clusters of the others are rejected.
  const ModeCluster& cluster = automatic.diagram.modes[1];
  const Pole& other = automatic.diagram.poles[static_cast<std::size_t>(cluster.members.back())];
  options.poles = {{other.order, other.frequency_hz}};
  const ModalResult one = identify_modes(y, options);
  ASSERT_EQ(one.modes.size(), 1U);
  EXPECT_EQ(one.modes[0].pole.order, other.order);
  EXPECT_NEAR(one.modes[0].pole.frequency_hz, other.frequency_hz, 1e-12 * other.frequency_hz);
  EXPECT_GT(one.modes[0].pole.frequency_sd, 0.0);
  EXPECT_EQ(one.modes[0].present, static_cast<int>(cluster.members.size()));
  EXPECT_EQ(std::ranges::count(one.diagram.rejected, Rejection::not_chosen, &RejectedCluster::why),
            2);
}

TEST(ModalIdentification, RejectsPolesThatTheDiagramDoesNotHave) {
  const Eigen::MatrixXd y = chain(3, 1.0, 200.0).accelerations(18000, 0.05, 1);
  const Pole pole = identify_modes(y, kChain).modes[0].pole;
  const auto rejected = [&](std::vector<ChosenPole> poles) -> long {
    ModalOptions options = kChain;
    options.poles = std::move(poles);
    try {
      (void)identify_modes(y, options);
    } catch (const ChosenPoleError& error) {
      return error.pole;
    }
    return -1;
  };
  const double f = pole.frequency_hz;
  EXPECT_EQ(rejected({{pole.order, f}}), -1);
  EXPECT_EQ(rejected({{pole.order, f}, {pole.order + 1, f}}), 1);      // odd
  EXPECT_EQ(rejected({{pole.order + 1000, f}}), 0);                    // beyond the largest
  EXPECT_EQ(rejected({{pole.order, 1.007 * f}}), 0);                   // too far
  EXPECT_EQ(rejected({{pole.order, f}, {pole.order, 1.001 * f}}), 1);  // twice
}

// The same record at five times its rate gives the same modes.
TEST(ModalIdentification, DecimatesToTheBand) {
  VibratingStructure structure = chain(3, 1.0, 200.0);
  structure.step = 0.01;
  const ModalResult found =
      identify_modes(structure.accelerations(90000, 0.05, 2),
                     {.sample_rate_hz = 100.0, .lowest_hz = 0.3, .highest_hz = 6.0});
  EXPECT_EQ(found.decimated, 6);
  ASSERT_EQ(found.modes.size(), 3U);
  const Eigen::VectorXd truth = structure.modes().frequencies_hz;
  for (std::size_t m = 0; m < 3; ++m)
    EXPECT_NEAR(found.modes[m].pole.frequency_hz, truth[static_cast<Eigen::Index>(m)],
                5.0 * found.modes[m].pole.frequency_sd);
}

TEST(ModalIdentification, MarksHarmonicsOfMachines) {
  Eigen::MatrixXd y = chain(3, 1.0, 200.0).accelerations(18000, 0.05, 3);
  for (Eigen::Index k = 0; k < y.cols(); ++k)
    y.col(k) += Eigen::Vector3d(1.0, 0.8, 0.5) *
                std::sin(2.0 * std::numbers::pi * 1.7 * 0.05 * static_cast<double>(k));
  const ModalResult found = identify_modes(y, kChain);
  bool seen = false;
  for (const Mode& mode : found.modes) {
    const bool tone = std::abs(mode.pole.frequency_hz - 1.7) < 0.01;
    EXPECT_EQ(std::ranges::count(mode.doubts, ModeDoubt::tone), tone ? 1 : 0)
        << mode.pole.frequency_hz << " " << mode.pole.damping;
    seen = seen || tone;
  }
  EXPECT_TRUE(seen) << testing::PrintToString(frequencies(found));
}

TEST(ModalIdentification, DistinguishesSinesFromNoise) {
  base::Random random(4, 0, 0, base::Purpose::test);
  Eigen::VectorXd sine(40000), noise(40000);
  for (Eigen::Index k = 0; k < 40000; ++k) {
    sine[k] = std::sin(0.3 * static_cast<double>(k));
    noise[k] = random.normal();
  }
  const double hz = 0.3 / (2.0 * std::numbers::pi);
  EXPECT_NEAR(amplitude_kurtosis(sine, hz, 1.0), 1.0, 1e-6);
  EXPECT_NEAR(amplitude_kurtosis(noise, hz, 1.0), 2.0, 0.5);
}

// A splinter of a mode, 4.4 standard deviations away but within its width and with the same shape,
// is doubtful; the mode is not. With another shape, or further away, it is a mode.
TEST(ModalIdentification, DoubtsSplintersOfAMode) {
  const auto doubts = [](double frequency_hz, double second_entry) {
    ModalResult found{.lowest_hz = 0.5, .highest_hz = 16.0};
    for (const auto& [f, sd, damping, entry] :
         {std::array{6.680, 0.0011, 0.002, 0.5}, {frequency_hz, 0.008, 0.01, second_entry}}) {
      Mode mode{.collinearity = 1.0, .present = 10, .orders = 10, .amplitude_kurtosis = 2.0};
      mode.pole.frequency_hz = f;
      mode.pole.frequency_sd = sd;
      mode.pole.damping = damping;
      mode.pole.damping_sd = 0.1 * damping;
      mode.pole.shape = Eigen::Vector2cd(1.0, entry);
      found.modes.push_back(mode);
    }
    doubt_modes(found);
    return std::pair{found.modes[0].doubts, found.modes[1].doubts};
  };
  const std::vector<ModeDoubt> none, twin = {ModeDoubt::twin};
  EXPECT_EQ(doubts(6.716, 0.5), std::pair(none, twin));
  EXPECT_EQ(doubts(6.716, -2.0), std::pair(none, none));
  EXPECT_EQ(doubts(6.90, 0.5), std::pair(none, none));
  EXPECT_EQ(doubts(6.69, 0.5), std::pair(twin, twin));  // neither is identifiable as the splinter
}

TEST(ModalIdentification, RejectsInvalidRecords) {
  const Eigen::MatrixXd y = chain(3, 1.0, 200.0).accelerations(2000, 0.05, 1);
  Eigen::MatrixXd copied = y;
  copied.row(2) = -3.0 * copied.row(0);
  try {
    (void)identify_modes(copied, kChain);
    FAIL();
  } catch (const ChannelError& error) {
    EXPECT_EQ(error.channel, 2);
    EXPECT_EQ(error.original, 0);
  }
  Eigen::MatrixXd still = y;
  still.row(1).setZero();
  EXPECT_THROW((void)identify_modes(still, kChain), ChannelError);
  EXPECT_THROW((void)identify_modes(y.leftCols(30), kChain), std::invalid_argument);
  EXPECT_THROW((void)identify_modes(y, {.sample_rate_hz = 20.0, .lowest_hz = 11.0}),
               std::invalid_argument);
  EXPECT_TRUE(identify_modes(y.leftCols(600), kChain).remarks.short_blocks);
}

}  // namespace
}  // namespace wheeltap::signals
