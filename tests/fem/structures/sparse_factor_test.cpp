#include "fem/structures/modes/sparse_factor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <stdexcept>

#include "base/eigen_solvers.hpp"

namespace wheeltap::fem::sparse_factor_test {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A pattern with all diagonal entries and some others.
Eigen::SparseMatrix<double> random_pattern(int n, double share, std::mt19937_64& random) {
  std::bernoulli_distribution present(share);
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 1.0);
    for (int j = 0; j < i; ++j)
      if (present(random)) {
        entries.emplace_back(i, j, 1.0);
        entries.emplace_back(j, i, 1.0);
      }
  }
  Eigen::SparseMatrix<double> out(n, n);
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

template <int W>
void expect_solutions_of(const Eigen::SparseMatrix<double>& pattern, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const SparseFactor factor(pattern);
  const Index n = pattern.rows();
  std::vector<MatrixXd> matrices(W, MatrixXd::Zero(n, n));
  SparseFactor::Values values{std::vector<double>(static_cast<std::size_t>(n) * W),
                              std::vector<double>(factor.entries() * W)};
  std::vector<double> x(static_cast<std::size_t>(n) * W);
  MatrixXd right(n, W);
  for (int w = 0; w < W; ++w) {
    for (int c = 0; c < pattern.outerSize(); ++c)
      for (Eigen::SparseMatrix<double>::InnerIterator it(pattern, c); it; ++it) {
        if (it.row() < c) continue;
        // Indefinite, but with pivots far from zero.
        const double v =
            it.row() == c ? (c % 3 == w % 3 ? -1.0 : 1.0) * static_cast<double>(n) : normal(random);
        matrices[static_cast<std::size_t>(w)](it.row(), c) = v;
        matrices[static_cast<std::size_t>(w)](c, it.row()) = v;
        const std::size_t a = factor.position(static_cast<std::size_t>(it.row()));
        const std::size_t b = factor.position(static_cast<std::size_t>(c));
        (a == b ? values.diagonal[a * W + static_cast<std::size_t>(w)]
                : values.lower[factor.index(a, b) * W + static_cast<std::size_t>(w)]) = v;
      }
    for (Index i = 0; i < n; ++i) {
      right(i, w) = normal(random);
      x[factor.position(static_cast<std::size_t>(i)) * W + static_cast<std::size_t>(w)] =
          right(i, w);
    }
  }
  // Four right-hand sides of a single matrix: multiples of the first.
  std::vector<double> several;
  for (const double v : x)
    for (int r = 0; r < 4 && W == 1; ++r) several.push_back((1.0 + r) * v);
  factor.factorise<W>(values);
  factor.solve<W>(values, x.data());
  if (W == 1) {
    factor.solve_several<4>(values, several.data());
    double most = 0.0;
    for (const double v : x) most = std::max(most, std::abs(v));
    for (std::size_t i = 0; i < several.size(); ++i)
      EXPECT_NEAR(several[i], (1.0 + static_cast<double>(i % 4)) * x[i / 4], 1e-11 * most);
  }
  for (int w = 0; w < W; ++w) {
    const MatrixXd& a = matrices[static_cast<std::size_t>(w)];
    VectorXd ours(n);
    for (Index i = 0; i < n; ++i)
      ours[i] = x[factor.position(static_cast<std::size_t>(i)) * W + static_cast<std::size_t>(w)];
    EXPECT_LT((a * ours - right.col(w)).norm(), 1e-12 * right.col(w).norm()) << "matrix " << w;
    // Sylvester's law of inertia.
    Index negative = 0;
    for (Index i = 0; i < n; ++i)
      negative +=
          values.diagonal[static_cast<std::size_t>(i) * W + static_cast<std::size_t>(w)] < 0.0;
    const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(a);
    EXPECT_EQ(negative, (solver.eigenvalues().array() < 0.0).count());
  }
}

TEST(SparseFactor, SolvesAndCountsNegativeEigenvalues) {
  std::mt19937_64 random(1);
  for (const int n : {1, 2, 7, 30, 60})
    for (const double share : {0.0, 0.05, 0.3, 1.0}) {
      const auto pattern = random_pattern(n, share, random);
      expect_solutions_of<1>(pattern, random);
      expect_solutions_of<4>(pattern, random);
    }
}

TEST(SparseFactor, AllInstructionSetsGiveTheSameBits) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal;
  for (const double share : {0.03, 0.2}) {
    const int n = 90;
    const SparseFactor factor(random_pattern(n, share, random));
    std::vector<double> pivots, entries, right;
    for (int i = 0; i < 4 * n; ++i) pivots.push_back(n + normal(random));
    for (std::size_t i = 0; i < 4 * factor.entries(); ++i) entries.push_back(normal(random));
    for (int i = 0; i < 4 * n; ++i) right.push_back(normal(random));
    // The factors and solutions of all functions of a kernel.
    const auto all_results = [&](const detail::SparseKernel& kernel) {
      std::vector<double> out;
      const auto keep = [&](const std::vector<double>& v) {
        out.insert(out.end(), v.begin(), v.end());
      };
      std::vector<double> diagonal = pivots, lower = entries, x = right;
      kernel.factorise(factor.pattern(), diagonal.data(), lower.data());
      kernel.solve(factor.pattern(), diagonal.data(), lower.data(), x.data());
      for (const auto* v : {&diagonal, &lower, &x}) keep(*v);
      x = right;
      kernel.solve_several4(factor.pattern(), diagonal.data(), lower.data(), x.data());
      keep(x);
      diagonal = pivots, lower = entries, x = right;
      kernel.factorise4(factor.pattern(), diagonal.data(), lower.data());
      kernel.solve4(factor.pattern(), diagonal.data(), lower.data(), x.data());
      for (const auto* v : {&diagonal, &lower, &x}) keep(*v);
      return out;
    };
    const std::vector<double> baseline = all_results(detail::kBaselineSparse);
    for (const auto* kernel = detail::sparse_kernels(); *kernel != nullptr; ++kernel)
      EXPECT_EQ(all_results(**kernel), baseline) << (*kernel)->name;
  }
}

TEST(SparseFactor, AChainHasNoFill) {
  Eigen::SparseMatrix<double> chain(50, 50);
  for (int i = 0; i < 50; ++i) {
    chain.insert(i, i) = 1.0;
    if (i > 0) chain.insert(i, i - 1) = 1.0;
    if (i > 0) chain.insert(i - 1, i) = 1.0;
  }
  EXPECT_EQ(SparseFactor(chain).entries(), 49U);
}

TEST(SparseFactor, RefusesAPatternThatIsNotSquareAndEntriesThatItLacks) {
  EXPECT_THROW(SparseFactor(Eigen::SparseMatrix<double>(3, 4)), std::invalid_argument);
  Eigen::SparseMatrix<double> diagonal(2, 2);
  diagonal.insert(0, 0) = 1.0;
  diagonal.insert(1, 1) = 1.0;
  EXPECT_THROW((void)SparseFactor(diagonal).index(0, 1), std::out_of_range);
}

}  // namespace
}  // namespace wheeltap::fem::sparse_factor_test
