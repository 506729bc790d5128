#include "fem/secular.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <bit>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace wheeltap::fem::detail {
namespace {

/// Random amplitudes on eigenvalues j⁴, as of a beam; all modes summed explicitly or, with `terms`,
/// the far ones by a made-up series of Chebyshev terms.
struct Problem {
  static constexpr int kAll = 45;
  std::vector<double> eigenvalues, c, inverse_gamma, series, product, pairs;
  std::vector<int> series_end;
  std::vector<Pack> packs;
  Secular secular;
  SecularScratch scratch;

  Problem(const SecularKernel& kernel, int columns, int near, int terms) {
    std::mt19937_64 generator(static_cast<unsigned>(columns));
    std::normal_distribution<double> normal;
    for (int j = 1; j <= kAll; ++j) eigenvalues.push_back(std::pow(j, 4.0));
    for (int i = 0; i < columns * kAll; ++i)
      c.push_back(std::pow(i % kAll + 1, 1.5) * normal(generator));
    for (int a = 0; a < columns; ++a) inverse_gamma.push_back(1.5 + a);
    for (int i = 0; i < terms * (kAll - near); ++i) series.push_back(1e-6 * normal(generator));
    series_end.assign(static_cast<std::size_t>(terms), kAll - near);
    secular = {.columns = columns,
               .near = near,
               .terms = terms,
               .cap = 1e5,
               .eigenvalues = eigenvalues.data(),
               .stride = kAll,
               .c = c.data(),
               .inverse_gamma = inverse_gamma.data()};
    const auto rows = static_cast<std::size_t>(secular.rows()),
               m = static_cast<std::size_t>(columns);
    const auto count = static_cast<std::size_t>(secular.chunks() * kPairChunk);
    pairs.resize(count * rows);
    product.resize(kAll);
    packs.resize(2 * rows + 2 * count + 4 * m);
    scratch = {.weights = packs.data(),
               .slopes = packs.data() + rows,
               .matrix = packs.data() + 2 * rows,
               .slope_matrix = packs.data() + 2 * rows + count,
               .forward = packs.data() + 2 * rows + 2 * count,
               .forces = packs.data() + 2 * rows + 2 * count + 2 * m};
    kernel.fill_pairs(secular, kAll, series.data(), series_end.data(), product.data(),
                      pairs.data());
    secular.pairs = pairs.data();
  }
};

const Pack kLambda = {{0.3, 10.0, 100.0, 500.0, 1200.0, 5000.0, 15999.0, 9e4}};
const int kPoles[kLanes] = {0, 0, 2, 3, 4, 7, 10, 16};

TEST(Secular, StepsSolveTheReducedProblem) {
  for (const int columns : {1, 2, 5}) {
    const SecularKernel& kernel = secular_kernel();
    Problem problem(kernel, columns, Problem::kAll, 0);
    SecularSteps steps;
    kernel.evaluate(problem.secular, kLambda, kPoles, problem.scratch, steps);
    const Eigen::Map<const Eigen::MatrixXd> c(problem.c.data(), Problem::kAll, columns);
    const Eigen::Map<const Eigen::VectorXd> gamma(problem.inverse_gamma.data(), columns);
    const Eigen::Map<const Eigen::VectorXd> poles(problem.eigenvalues.data(), Problem::kAll);
    for (int l = 0; l < kLanes; ++l) {
      const double z = kLambda.lane[l];
      const int p = kPoles[l];
      Eigen::VectorXd weight = (poles.array() - z).inverse();
      weight.segment<2>(p).setZero();
      const Eigen::MatrixXd a =
          Eigen::MatrixXd(gamma.asDiagonal()) - c.transpose() * weight.asDiagonal() * c;
      const Eigen::MatrixXd y = a.lu().solve(c.middleRows<2>(p).transpose());
      const Eigen::Matrix2d h =
          Eigen::Matrix2d((poles.segment<2>(p).array() - z).matrix().asDiagonal()) -
          c.middleRows<2>(p) * y;
      const Eigen::Matrix2d n =
          Eigen::Matrix2d::Identity() +
          y.transpose() * (c.transpose() * weight.cwiseAbs2().asDiagonal() * c) * y;
      const Eigen::Vector2d d =
          Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix2d>(h, n).eigenvalues();
      const double scale = d.cwiseAbs().maxCoeff();
      EXPECT_NEAR(steps.low.lane[l], d[0], 1e-9 * scale);
      EXPECT_NEAR(steps.high.lane[l], d[1], 1e-9 * scale);
      EXPECT_NEAR(steps.h12.lane[l], h(0, 1), 1e-9 * h.norm());
      EXPECT_NEAR(steps.n22.lane[l], n(1, 1), 1e-9 * n.norm());
      const Eigen::VectorXd spectrum =
          Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(a).eigenvalues();
      EXPECT_EQ(steps.negative.lane[l], static_cast<double>((spectrum.array() < 0.0).count()));
    }
  }
}

TEST(Secular, EveryInstructionSetGivesTheSameBits) {
  const auto bits = [](const SecularKernel& kernel, int columns) {
    Problem problem(kernel, columns, 28, 11);
    SecularSteps steps;
    kernel.evaluate(problem.secular, kLambda, kPoles, problem.scratch, steps);
    std::vector<double> all = problem.pairs;
    for (const Pack* pack : {&steps.low, &steps.high, &steps.negative, &steps.h11, &steps.h12,
                             &steps.h22, &steps.n11, &steps.n12, &steps.n22})
      all.insert(all.end(), pack->lane, pack->lane + kLanes);
    std::vector<double> out(Problem::kAll);
    kernel.coordinates(problem.secular, Problem::kAll, problem.inverse_gamma.data(), 777.0, 4,
                       out.data());
    all.insert(all.end(), out.begin(), out.end());
    kernel.project(problem.c.data(), columns, Problem::kAll, problem.eigenvalues.data(),
                   Problem::kAll, out.data());
    all.insert(all.end(), out.begin(), out.begin() + columns);
    std::vector<std::uint64_t> result;
    for (const double x : all) result.push_back(std::bit_cast<std::uint64_t>(x));
    return result;
  };
  for (const int columns : {1, 2, 4, 7, 12}) {
    const auto expected = bits(secular_kernel(), columns);
    for (auto kernel = secular_kernels(); *kernel != nullptr; ++kernel)
      EXPECT_EQ(bits(**kernel, columns), expected)
          << (*kernel)->name << ", " << columns << " columns";
  }
}

}  // namespace
}  // namespace wheeltap::fem::detail
