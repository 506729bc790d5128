#include "base/simd.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/lanes.hpp"

namespace {

namespace lanes = wheeltap::base::lanes;
using wheeltap::base::Compiled, wheeltap::base::Instructions, wheeltap::base::processor_has,
    wheeltap::base::runnable;

struct Loops {
  int width;
};

TEST(Simd, OffersAvailableInstructionsNarrowestFirst) {
  const Loops two{2}, four{4}, eight{8};
  const Compiled<Loops> compiled{.baseline = &two, .avx2 = &four, .avx512 = &eight};
  int last = 0;
  for (const Loops* loops : runnable(compiled)) {
    EXPECT_GT(loops->width, last);
    last = loops->width;
  }
  EXPECT_EQ(runnable(compiled).front(), &two);
  EXPECT_EQ(runnable(compiled).back(), processor_has(Instructions::avx512) ? &eight
                                       : processor_has(Instructions::avx2) ? &four
                                                                           : &two);
}

// Tests override the choice with this variable.
TEST(Simd, OffersOnlyTheRequestedInstructions) {
  const Loops two{2}, four{4};
  const Compiled<Loops> compiled{.baseline = &two, .avx2 = &four};
  ASSERT_EQ(runnable(compiled, Instructions::baseline).size(), 1U);
  EXPECT_EQ(runnable(compiled, Instructions::baseline).front(), &two);
  EXPECT_EQ(runnable(compiled, Instructions::avx2).size(),
            processor_has(Instructions::avx2) ? 1U : 0U);
  EXPECT_TRUE(runnable(compiled, Instructions::avx512).empty());  // not compiled
}

TEST(Lanes, AgreesWithTheStandardLibrary) {
  using Pair __attribute__((vector_size(16))) = double;
  for (int i = -3000; i <= 3000; ++i) {
    const double x = 0.00731 * i;
    const Pair both{x, 30.0 * x};
    const Pair e = lanes::exp(both), t = lanes::tanh(both);
    for (int lane = 0; lane < 2; ++lane) {
      EXPECT_NEAR(e[lane] / std::exp(both[lane]), 1.0, 7e-16) << both[lane];
      EXPECT_NEAR(t[lane], std::tanh(both[lane]), 4e-16) << both[lane];
    }
    EXPECT_EQ(lanes::exp(x), e[0]);
    EXPECT_EQ(lanes::tanh(x), t[0]);
  }
}

TEST(Lanes, AbsWorksInEveryLane) {
  using Pair __attribute__((vector_size(16))) = double;
  const Pair x = lanes::abs(Pair{-2.5, 3.0}), y = lanes::abs(Pair{-HUGE_VAL, std::nan("")});
  EXPECT_EQ(x[0], 2.5);
  EXPECT_EQ(x[1], 3.0);
  EXPECT_EQ(y[0], HUGE_VAL);
  EXPECT_TRUE(std::isnan(y[1]));
}

}  // namespace
