#include "fem/beam/full_spectrum.hpp"

#include <gtest/gtest.h>

#include "base/eigen_solvers.hpp"
#include "beams.hpp"
#include "fem/beam/assembly.hpp"

namespace wheeltap::fem {
namespace {

class FullSpectra : public testing::TestWithParam<std::string_view> {};

TEST_P(FullSpectra, AreOrthonormalAndSolveTheProblem) {
  const Beam beam = slender_beam(GetParam(), 60);
  Beam unsupported = beam;
  unsupported.supports = {};
  const FullSpectrum s = full_spectrum(beam);
  const Eigen::Index n = s.eigenvalues.size();
  using Matrix = FullSpectrum::Matrix;
  const Assembly<long double> all = assemble<long double>(unsupported, {});
  const Matrix m = s.shapes.transpose() * (all.mass * s.shapes);
  EXPECT_LT((m - Matrix::Identity(n, n)).cwiseAbs().maxCoeff(), 1e-12L);

  const Assembly<long double> a = assemble<long double>(beam, {});
  EXPECT_EQ(n, a.stiffness.rows());
  const auto expected = Eigen::GeneralizedSelfAdjointEigenSolver<Matrix>(
                            Matrix(a.stiffness), Matrix(a.mass), Eigen::EigenvaluesOnly)
                            .eigenvalues();
  // The dense reference is accurate to about the largest eigenvalue times 1e-19.
  const long double floor = 1e-16L * expected[n - 1];
  for (Eigen::Index i = 0; i < n; ++i) {
    if (i < s.rigid_body_modes)
      EXPECT_EQ(s.eigenvalues[i], 0.0L);
    else
      EXPECT_LT(std::abs(s.eigenvalues[i] - expected[i]), 1e-14L * expected[i] + floor);
    EXPECT_TRUE(i == 0 || s.eigenvalues[i] >= s.eigenvalues[i - 1]);
  }
}

INSTANTIATE_TEST_SUITE_P(Supports, FullSpectra, testing::ValuesIn(kNamedSupports));

TEST(FullSpectrum, SeparatesEqualEigenvalues) {
  // Clamped in the middle as well: both halves have the same frequencies.
  Beam beam = slender_beam("clamped-clamped", 20);
  beam.supports.push_back({.at = 0.5, .rotation = true, .stiffness = {}});
  const FullSpectrum s = full_spectrum(beam);
  for (Eigen::Index i = 0; i < s.eigenvalues.size(); i += 2)
    EXPECT_LT(s.eigenvalues[i + 1] / s.eigenvalues[i] - 1, 1e-12L);
  beam.supports = {};
  const FullSpectrum::Matrix m =
      s.shapes.transpose() * (assemble<long double>(beam, {}).mass * s.shapes);
  EXPECT_LT((m - FullSpectrum::Matrix::Identity(m.rows(), m.cols())).cwiseAbs().maxCoeff(), 1e-12L);
}

TEST(FullSpectrum, ShapesOfCloseModesAreAccurate) {
  // Regression: for two modes 1e-11 apart the quotients were correct, but the shapes were mixed.
  Beam beam = slender_beam("free-free", 47);
  beam.length = 232.0;
  const FullSpectrum s = full_spectrum(beam);
  const auto elastic = s.eigenvalues.tail(s.eigenvalues.size() - 2).cast<double>().cwiseSqrt();
  const Eigen::MatrixXd c =
      s.strains.rightCols(elastic.size()) * elastic.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd energy = c.transpose() * c;
  EXPECT_LT((energy - Eigen::MatrixXd::Identity(c.cols(), c.cols())).cwiseAbs().maxCoeff(), 1e-13);
}

TEST(FullSpectrum, SolvesTheSmallestMeshes) {
  EXPECT_EQ(full_spectrum(slender_beam("clamped-pinned", 1)).eigenvalues.size(), 1);
  EXPECT_EQ(full_spectrum(slender_beam("free-free", 1)).eigenvalues.size(), 4);
}

}  // namespace
}  // namespace wheeltap::fem
