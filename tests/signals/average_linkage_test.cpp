#include "signals/modal/average_linkage.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace wheeltap::signals {
namespace {

using Clusters = std::vector<std::vector<int>>;

Clusters on_a_line(const std::vector<double>& x, const std::vector<int>& groups, double threshold) {
  return average_linkage(
      groups,
      [&](int i, int j) {
        return std::abs(x[static_cast<std::size_t>(i)] - x[static_cast<std::size_t>(j)]);
      },
      threshold);
}

TEST(AverageLinkage, JoinsCloseItems) {
  EXPECT_EQ(on_a_line({0.0, 5.0, 0.1, 5.2, 9.0}, {0, 1, 2, 3, 4}, 1.0),
            (Clusters{{0, 2}, {1, 3}, {4}}));
}

TEST(AverageLinkage, NeverJoinsTwoItemsOfOneGroup) {
  // 1 is nearest to 0 but in its group; 2 joins the nearer of both.
  EXPECT_EQ(on_a_line({0.0, 0.1, 0.2}, {7, 7, 8}, 1.0), (Clusters{{0}, {1, 2}}));
}

// Between the mean of the distances and their largest: 0, .4 and .8 would form one cluster only by
// single linkage.
TEST(AverageLinkage, UsesTheMeanDistance) {
  EXPECT_EQ(on_a_line({0.0, 0.4, 0.9}, {0, 1, 2}, 0.6), (Clusters{{0, 1}, {2}}));
  EXPECT_EQ(on_a_line({0.0, 0.4, 0.9}, {0, 1, 2}, 0.71), (Clusters{{0, 1, 2}}));
}

TEST(AverageLinkage, NeverJoinsItemsAtInfiniteDistance) {
  const double never = std::numeric_limits<double>::infinity();
  const auto distance = [&](int i, int j) { return i + j == 1 ? never : 0.1; };
  // 0 and 1 are both near 2, which joins one of them.
  EXPECT_EQ(average_linkage({0, 1, 2}, distance, 1e9).size(), 2U);
  EXPECT_TRUE(average_linkage({}, distance, 1.0).empty());
}

}  // namespace
}  // namespace wheeltap::signals
