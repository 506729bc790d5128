#include "fem/structures/modes/tridiagonal.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/eigen_solvers.hpp"

namespace wheeltap::fem {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Random matrices, also with a zero below the diagonal and with a wide range of entries.
TEST(Tridiagonal, LastComponentsAgreeWithTheDenseSolution) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  for (const Index n : {1, 2, 3, 10, 40})
    for (int kind = 0; kind < 3; ++kind) {
      VectorXd diagonal(n), below(n - 1);
      for (Index i = 0; i < n; ++i) {
        diagonal[i] =
            normal(random) * (kind == 2 ? std::pow(10.0, -0.3 * static_cast<double>(i)) : 1.0);
        if (i > 0) below[i - 1] = 0.1 * diagonal[i] * normal(random);
      }
      if (kind == 1 && n > 2) below[n / 2 - 1] = 0.0;
      MatrixXd dense = diagonal.asDiagonal();
      dense.diagonal(-1) = below;
      const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(dense);  // reads the lower half
      VectorXd values, last;
      ASSERT_TRUE(last_components(diagonal, below, values, last));
      EXPECT_LT((values - solver.eigenvalues()).norm(), 1e-13 * solver.eigenvalues().norm());
      EXPECT_LT(
          (last.cwiseAbs2() - VectorXd(solver.eigenvectors().bottomRows(1).transpose()).cwiseAbs2())
              .norm(),
          1e-11);
    }
}

}  // namespace
}  // namespace wheeltap::fem
