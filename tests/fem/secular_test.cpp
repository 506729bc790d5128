#include "fem/secular.hpp"
#include "base/eigen_solvers.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace wheeltap::fem::detail {
namespace {

/// Random amplitudes on eigenvalues j⁴, as for a beam. All modes are summed explicitly or, with
/// `terms`, the far ones by an artificial Chebyshev series.
struct Problem {
  static constexpr int kAll = 45;
  std::vector<double> eigenvalues, scales, c, series, product, pairs;
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
    scales = eigenvalues;
    scales[0] = scales[1] = scales[2];  // as for soft modes
    for (int i = 0; i < terms * (kAll - near); ++i) series.push_back(1e-13 * normal(generator));
    series_end.assign(static_cast<std::size_t>(terms), kAll - near);
    secular = {.columns = columns,
               .supports = columns / 3,
               .near = near,
               .terms = terms,
               .cap = 1e5,
               .eigenvalues = eigenvalues.data(),
               .scales = scales.data(),
               .stride = kAll,
               .c = c.data()};
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
    const Eigen::Map<const Eigen::VectorXd> values(problem.eigenvalues.data(), Problem::kAll);
    const Eigen::Map<const Eigen::VectorXd> scales(problem.scales.data(), Problem::kAll);
    Eigen::VectorXd signs = Eigen::VectorXd::Ones(columns);
    signs.head(problem.secular.supports).setConstant(-1.0);
    const Eigen::MatrixXd e = scales.cwiseSqrt().cwiseInverse().asDiagonal() * c;
    for (int l = 0; l < kLanes; ++l) {
      const double z = kLambda.lane[l];
      const int p = kPoles[l];
      const auto kappa = [&](double at) -> Eigen::VectorXd {
        return scales.array() / (values.array() - at) - 1.0;
      };
      // A and H at a λ from their definitions.
      const auto a_of = [&](double at) {
        Eigen::VectorXd weight = kappa(at);
        weight.segment<2>(p).setZero();
        return Eigen::MatrixXd(Eigen::MatrixXd(signs.asDiagonal()) -
                               e.transpose() * weight.asDiagonal() * e);
      };
      const Eigen::MatrixXd a = a_of(z);
      const Eigen::MatrixXd ep = e.middleRows<2>(p).transpose(), y = a.lu().solve(ep);
      const Eigen::Matrix2d h =
          Eigen::Matrix2d(kappa(z).segment<2>(p).cwiseInverse().asDiagonal()) - ep.transpose() * y;
      Eigen::VectorXd slope = scales.array() / (values.array() - z).square();
      const Eigen::Vector2d own =
          slope.segment<2>(p).cwiseQuotient(kappa(z).segment<2>(p).cwiseAbs2());
      slope.segment<2>(p).setZero();
      const Eigen::Matrix2d n = Eigen::Matrix2d(own.asDiagonal()) +
                                y.transpose() * (e.transpose() * slope.asDiagonal() * e) * y;
      const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> pencil(Eigen::MatrixXd{h},
                                                                             Eigen::MatrixXd{n});
      const Eigen::Vector2d d = pencil.eigenvalues();
      const double scale = d.cwiseAbs().maxCoeff();
      EXPECT_NEAR(steps.low.lane[l], d[0], 1e-9 * scale);
      EXPECT_NEAR(steps.high.lane[l], d[1], 1e-9 * scale);
      const Eigen::VectorXd spectrum =
          Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(a).eigenvalues();
      EXPECT_EQ(steps.negative.lane[l], static_cast<double>((spectrum.array() < 0.0).count()));

      // The shape of each δ: all coordinates, and the residual in the damaged problem.
      for (const bool low : {true, false}) {
        const Eigen::Vector2d v = pencil.eigenvectors().col(low ? 0 : 1);
        const Eigen::VectorXd eta = y * v;
        Eigen::VectorXd x = (c * eta).cwiseQuotient(Eigen::VectorXd(values.array() - z));
        for (const int i : {0, 1})  // v = √s x - eᵀ η at the poles
          x[p + i] = (v[i] + e.row(p + i).dot(eta)) / std::sqrt(scales[p + i]);
        const Eigen::VectorXd residual = (values.array() - z).matrix().cwiseProduct(x) - c * eta;
        EXPECT_LT(residual.norm() - residual.segment<2>(p).norm(), 1e-8 * residual.norm());
        const double step = x.dot(residual) / x.squaredNorm();
        const double squared = (residual - step * x).squaredNorm() / x.squaredNorm();
        EXPECT_NEAR((low ? steps.low_step : steps.high_step).lane[l], step, 1e-8 * scale * z);
        EXPECT_NEAR((low ? steps.low_residual : steps.high_residual).lane[l], squared,
                    1e-7 * (squared + step * step));
      }
    }
  }
}

TEST(Secular, EveryInstructionSetGivesTheSameBits) {
  const auto bits = [](const SecularKernel& kernel, int columns) {
    Problem problem(kernel, columns, 28, 11);
    SecularSteps steps;
    kernel.evaluate(problem.secular, kLambda, kPoles, problem.scratch, steps);
    std::vector<double> all = problem.pairs;
    for (const Pack* pack :
         {&steps.negative, &steps.smallest_pivot, &steps.low, &steps.high, &steps.low_step,
          &steps.high_step, &steps.low_residual, &steps.high_residual, &steps.low_v1, &steps.low_a1,
          &steps.low_a2, &steps.high_v2, &steps.high_a1, &steps.high_a2})
      all.insert(all.end(), pack->lane, pack->lane + kLanes);
    std::vector<double> out(Problem::kAll);
    kernel.coordinates(problem.secular, Problem::kAll, problem.scales.data(), 777.0, 4, out.data());
    all.insert(all.end(), out.begin(), out.end());
    kernel.project(problem.c.data(), columns, Problem::kAll, problem.eigenvalues.data(),
                   Problem::kAll, out.data());
    all.insert(all.end(), out.begin(), out.begin() + columns);
    all.push_back(kernel.weighted_dot(problem.c.data(), problem.c.data() + 3, problem.scales.data(),
                                      Problem::kAll - 3));
    kernel.subtract(out.data(), problem.c.data(), 0.7, Problem::kAll);
    all.insert(all.end(), out.begin(), out.end());
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
