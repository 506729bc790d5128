#include "identification/structural/likelihood/mode_matching.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "base/eigen_solvers.hpp"
#include "base/random.hpp"

namespace wheeltap::identification {
namespace {

using Eigen::MatrixXd;

double sum_of(const MatrixXd& costs, const std::vector<int>& columns) {
  double sum = 0.0;
  for (std::size_t i = 0; i < columns.size(); ++i)
    sum += costs(static_cast<Eigen::Index>(i), columns[i]);
  return sum;
}

// Compares with all assignments of up to 6 rows to 7 columns.
TEST(LeastCostAssignment, HasTheLeastCostOfAll) {
  base::Random random(5, 0, 0, base::Purpose::test);
  for (int trial = 0; trial < 300; ++trial) {
    const int columns = 1 + random.index(7), rows = 1 + random.index(std::min(columns, 6));
    MatrixXd costs(rows, columns);
    for (double& c : costs.reshaped()) c = 10.0 * random.normal();
    std::vector<int> order(static_cast<std::size_t>(columns));
    std::iota(order.begin(), order.end(), 0);
    double best = std::numeric_limits<double>::infinity();
    do {
      best = std::min(best, sum_of(costs, {order.begin(), order.begin() + rows}));
    } while (std::ranges::next_permutation(order).found);
    const auto found = least_cost_assignment(costs);
    EXPECT_NEAR(sum_of(costs, found), best, 1e-12);
    auto sorted = found;
    std::ranges::sort(sorted);
    EXPECT_EQ(std::ranges::adjacent_find(sorted), sorted.end()) << "columns differ";
  }
}

TEST(LeastCostAssignment, ForbiddenPairsAreAvoided) {
  const double inf = std::numeric_limits<double>::infinity();
  MatrixXd costs(2, 2);
  costs << 0.0, 100.0, 0.0, inf;
  EXPECT_EQ(least_cost_assignment(costs), (std::vector<int>{1, 0}));
}

TEST(LeastCostAssignment, RejectsInvalidCosts) {
  EXPECT_THROW(least_cost_assignment(MatrixXd::Zero(3, 2)), std::invalid_argument);
  EXPECT_THROW(least_cost_assignment(MatrixXd::Constant(1, 1, std::nan(""))),
               std::invalid_argument);
}

}  // namespace
}  // namespace wheeltap::identification
