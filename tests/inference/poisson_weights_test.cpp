#include "inference/model/poisson_weights.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

namespace wheeltap::inference {
namespace {

TEST(PoissonWeights, AreThoseOfThePoissonDistribution) {
  const double mean = 1.7;
  const std::vector<double> all = poisson_weights(mean, 0, 60);
  EXPECT_NEAR(std::accumulate(all.begin(), all.end(), 0.0), 1.0, 1e-13);
  const std::vector<double> some = poisson_weights(mean, 2, 4);
  ASSERT_EQ(some.size(), 3U);
  EXPECT_NEAR(some[1] / some[0], mean / 3.0, 1e-14);
  EXPECT_NEAR(some[2] / some[1], mean / 4.0, 1e-14);
}

}  // namespace
}  // namespace wheeltap::inference
