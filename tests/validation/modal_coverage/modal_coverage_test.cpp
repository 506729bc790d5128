// A short version of the study. With 60 records a share of 0.95 scatters by 0.028 and a standard
// deviation by a tenth; a correct method exceeds the limits once in some thousand seeds.
#include "modal_coverage.hpp"

#include <gtest/gtest.h>

#include <iostream>

namespace wheeltap::signals {
namespace {

TEST(ModalCoverage, IntervalsOfAChainHoldWhatTheyShould) {
  constexpr int kRecords = 60;
  const Coverage study = modal_coverage(coverage_case("chain"), kRecords, 1);
  print(std::cout, study);
  // Modes are independent of each other, f and ζ nearly: 6 × 60 intervals.
  EXPECT_NEAR(study.covered, 0.95, 3.5 * std::sqrt(0.95 * 0.05 / (6 * kRecords)) + 0.01);
  EXPECT_NEAR(study.predicted, 1.0, 0.07 + 3.5 / std::sqrt(2.0 * 6 * kRecords));
  EXPECT_LT(study.surplus, 0.1);
  for (std::size_t i = 0; i < 6; ++i) {
    const CoverageRow& row = study.rows[i];
    EXPECT_EQ(row.found, kRecords) << row.name;
    EXPECT_GT(row.covered, 0.95 - 3.5 * std::sqrt(0.95 * 0.05 / kRecords)) << row.name;
    EXPECT_LT(std::abs(row.bias), 0.2 + 3.5 / std::sqrt(kRecords)) << row.name;
    // Not below the law, and not far above it.
    EXPECT_GT(row.against_law, 0.9 - 0.3) << row.name;
    EXPECT_LT(row.against_law, 1.4 + 0.3) << row.name;
  }
}

}  // namespace
}  // namespace wheeltap::signals
