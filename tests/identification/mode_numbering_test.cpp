#include "identification/structural/updating/mode_numbering.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/constants.hpp"
#include "tests/identification/modal_cases.hpp"

namespace wheeltap::identification {
namespace {

/// Five storeys of 16 N/m and 1 kg, each stiffness log-normal.
std::shared_ptr<const StructureModel> five_storeys(double log_sd) {
  const inference::Prior k = inference::LogNormal{std::log(16.0), log_sd};
  return modal::chain({1.0, 1.0, 1.0, 1.0, 1.0}, {k, k, k, k, k});
}

double true_hz(int mode) {
  return 8.0 / kTwoPi * std::sin((2 * mode - 1) * kPi / 22.0);
}

/// `modes`: the structure's mode for each row; 0 for a gap.
ModalData data_of(const std::vector<int>& modes) {
  ModalData data;
  std::vector<double> sds;
  for (const int m : modes) {
    data.frequencies_hz.push_back(m == 0 ? kNaN : true_hz(m));
    sds.push_back(m == 0 ? 0.0 : 0.005 * true_hz(m));
  }
  data.covariance = modal::diagonal(sds);
  return data;
}

NumberingFinding judged(const std::vector<int>& modes, double log_sd) {
  const ModalData data = data_of(modes);
  return numbering_of(*five_storeys(log_sd), data, data.covariance).value();
}

TEST(ModeNumbering, TheTrueNumbersAreProbable) {
  const NumberingFinding found = judged({1, 0, 3, 4, 5}, 0.3);
  EXPECT_EQ(found.measured, (std::vector<int>{1, 3, 4, 5}));
  EXPECT_GT(found.probability, 0.95);
  EXPECT_FALSE(found.is_doubtful());
}

TEST(ModeNumbering, AMissingLowestModeIsFound) {
  const NumberingFinding found = judged({2, 3, 4}, 0.3);
  EXPECT_LT(found.probability, 0.05);
  EXPECT_EQ(found.likeliest.modes, (std::vector<int>{2, 3, 4}));
  EXPECT_GT(found.likeliest.probability, 0.9);
}

TEST(ModeNumbering, AMissingModeBetweenOthersIsFound) {
  const NumberingFinding found = judged({1, 3, 4, 5}, 0.1);
  EXPECT_TRUE(found.is_doubtful());
  EXPECT_EQ(found.likeliest.modes, (std::vector<int>{1, 3, 4, 5}));
}

// One frequency and a stiffness with a wide prior: the data have no information about the number.
TEST(ModeNumbering, OneFrequencyUnderAWidePriorKeepsItsNumber) {
  const NumberingFinding found = judged({1}, 2.0);
  EXPECT_GT(found.probability, 0.8);
}

TEST(ModeNumbering, ShapesAreMatchedAndNotNumbered) {
  ModalData data = data_of({1, 2});
  data.sensors = modal::at_masses({1, 2});
  data.shapes = Eigen::MatrixXd::Ones(2, 2);
  EXPECT_FALSE(numbering_of(*five_storeys(0.3), data, data.covariance).has_value());
}

}  // namespace
}  // namespace wheeltap::identification
