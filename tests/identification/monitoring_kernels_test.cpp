// The loops of the monitoring give the same bits with vector registers of every width.
#include <gtest/gtest.h>

#include <cmath>

#include "base/index.hpp"
#include "base/random.hpp"
#include "base/simd.hpp"
#include "identification/monitoring/kernels/candidate_kernel.hpp"
#include "identification/monitoring/kernels/evidence_kernel.hpp"
#include "identification/monitoring/kernels/lane_log.hpp"
#include "identification/monitoring/marginal_likelihood.hpp"

namespace wheeltap::identification::monitoring {
namespace {

using detail::CandidateKernel;
using detail::CandidateLayout;
using detail::CandidateTiles;
using detail::EvidenceKernel;
using detail::kTile;
using Eigen::Index;

std::vector<const EvidenceKernel*> evidence_kernels() {
  base::Compiled<EvidenceKernel> compiled{.baseline = &detail::kBaselineEvidence};
#ifdef WHEELTAP_X86_KERNELS
  compiled.avx2 = &detail::kAvx2Evidence;
  compiled.avx512 = &detail::kAvx512Evidence;
#endif
  return base::runnable(compiled);
}

std::vector<const CandidateKernel*> candidate_kernels() {
  base::Compiled<CandidateKernel> compiled{.baseline = &detail::kBaselineCandidates};
#ifdef WHEELTAP_X86_KERNELS
  compiled.avx2 = &detail::kAvx2Candidates;
  compiled.avx512 = &detail::kAvx512Candidates;
#endif
  return base::runnable(compiled);
}

TEST(LaneLog, AgreesWithTheStandardLibrary) {
  using Pair = double __attribute__((vector_size(16)));
  for (int i = -3000; i <= 3000; ++i) {
    const Pair x{std::exp(0.2 * i + 1e-3), 1.0 + 1e-4 * i};
    const Pair y = detail::log(x);
    for (int lane = 0; lane < 2; ++lane)
      EXPECT_NEAR(y[lane], std::log(x[lane]), 3e-16 * (1.0 + std::abs(std::log(x[lane]))));
  }
}

/// Rows in which some features are missing.
std::vector<FeatureRows> some_rows(int n, int features, base::Random& random) {
  std::vector<FeatureRows> out;
  for (int j = 0; j < features; ++j) {
    FeatureRows rows;
    std::vector<double> values, precisions;
    for (int t = 0; t < n; ++t) {
      if (random.uniform() < 0.3) continue;
      rows.rows.push_back(t);
      values.push_back(random.normal());
      precisions.push_back(0.5 + random.uniform());
    }
    rows.y = Eigen::Map<Eigen::VectorXd>(values.data(), static_cast<Index>(values.size()));
    rows.precision =
        Eigen::Map<Eigen::VectorXd>(precisions.data(), static_cast<Index>(precisions.size()));
    out.push_back(std::move(rows));
  }
  return out;
}

TEST(EvidenceData, AgreesWithOneFeatureAfterTheOther) {
  base::Random random(1, 0, 0, base::Purpose::test);
  for (const int features : {1, 6, 9})
    for (const Index terms : {1, 4, 9, 26}) {  // 26: without the kernel
      constexpr int kRows = 70;
      std::vector<double> hours;
      for (int t = 0; t < kRows; ++t) hours.push_back(t + 0.4 * random.uniform());
      const std::vector<FeatureRows> rows = some_rows(kRows, features, random);
      Eigen::MatrixXd table(terms, kRows);
      for (double& x : table.reshaped()) x = random.normal();
      const std::vector<double> ratios(index(features), 0.7);
      const std::vector<RegressionPrior> priors(
          index(features),
          {.coefficient_scale = Eigen::VectorXd::Constant(terms, 3.0), .scale = 0.4});
      const auto found = EvidenceData(hours, rows, 40.0)(table, 0.2, 0.3, ratios, priors);
      for (std::size_t j = 0; j < rows.size(); ++j) {
        const MarginalLikelihood one = marginal_likelihood(
            hours, table, rows[j],
            {.fast_rate = 0.2, .fast_ratio = 0.7, .slow_ratio = 0.3, .slow_hours = 40.0},
            priors[j]);
        EXPECT_NEAR(found[j].log_density, one.log_density, 1e-9);
        EXPECT_NEAR(found[j].scale, one.scale, 1e-9);
        EXPECT_TRUE(found[j].coefficients.isApprox(one.coefficients, 1e-9));
      }
    }
}

TEST(EvidenceKernel, HasTheSameBitsAtEveryWidth) {
  base::Random random(2, 0, 0, base::Purpose::test);
  constexpr int kRows = 61;
  for (const int terms : {1, 5, 8}) {
    std::vector<double> table(index(kRows * terms)), values(kRows * 8), variance(kRows * 8);
    for (double& x : table) x = random.normal();
    for (double& x : values) x = random.normal();
    for (double& x : variance) x = random.uniform() < 0.3 ? 0.0 : 0.5 + random.uniform();
    const std::vector<double> fast(kRows, 0.9), slow(kRows, 0.999), ratios(8, 0.6);
    std::vector<double> first;
    for (const EvidenceKernel* kernel : evidence_kernels()) {
      std::vector<double> sums(index((terms + 1) * (terms + 2) / 2) * 8 + 8);
      kernel->accumulate({.rows = kRows,
                          .terms = terms,
                          .table = table.data(),
                          .values = values.data(),
                          .variance = variance.data(),
                          .fast_decay = fast.data(),
                          .slow_decay = slow.data(),
                          .fast_ratio = ratios.data(),
                          .slow_ratio = 0.2},
                         8, {.gram = sums.data() + 8, .log_scales = sums.data()});
      if (first.empty()) first = sums;
      EXPECT_EQ(sums, first) << kernel->name;
    }
  }
}

/// One row of two draws over three tiles; all numbers that the loops change.
std::vector<double> after_a_row(const CandidateKernel& kernel, double degrees) {
  base::Random random(3, 0, 0, base::Purpose::test);
  constexpr int kTiles = 3;
  const CandidateLayout at{.features = 3, .block = 5};
  const auto filled = [&](int rows) {
    std::vector<double> out(index(rows * kTiles * kTile));
    for (double& x : out) x = 0.1 * random.normal();
    return out;
  };
  std::vector<std::vector<double>> state, scratch;
  std::vector<CandidateTiles> draws;
  for (int m = 0; m < 2; ++m) {
    state.push_back(filled(at.rows()));
    for (int tile = 0; tile < kTiles; ++tile)
      for (int lane = 0; lane < kTile; ++lane) {
        const auto put = [&](int row, double value) {
          state.back()[index((tile * at.rows() + row) * kTile + lane)] = value;
        };
        for (int size = 0; size < detail::kSizes; ++size)
          for (int j = 0; j < 3; ++j)
            put(at.covariance() + size * at.half() + j * (j + 3) / 2, 2.0);
        for (int j = 0; j < 3; ++j) put(at.precision() + j, 1.0);
        for (int i = 0; i < at.hypotheses(); ++i) put(at.weight() + i, 0.01 + random.uniform());
      }
    scratch.push_back(filled(at.scratch_rows()));
  }
  for (std::size_t m = 0; m < 2; ++m)
    draws.push_back(
        {.layout = at, .tiles = kTiles, .state = state[m].data(), .scratch = scratch[m].data()});
  const std::vector<double> h = {1.0, 0.3, 0.0, 1.0, 1.0}, prior(9, 0.5), reference(24, 0.1);
  const std::vector<char> present = {1, 0, 1};
  std::vector<double> out;
  for (const CandidateTiles& draw : draws) {
    kernel.begin(draw, {.h = h.data(), .fast = 0.9, .slow = 0.99, .is_present = present.data()});
    std::vector<double> gains, along;
    for (const int j : {0, 2}) {
      const detail::Entry entry{.j = j,
                                .e = j / 2,
                                .v = 0.7 - j,
                                .s = 1.3,
                                .degrees = degrees,
                                .along = along.data(),
                                .prior = prior.data()};
      out.push_back(kernel.score(draw, entry));
      kernel.update(draw, entry, 1.5);
      for (int r = 0; r < at.states(); ++r) gains.push_back(0.1 * r);
      along.push_back(0.25);
    }
    kernel.finish(draw, 2, degrees, gains.data());
    kernel.weigh(draw, -0.2, reference.data());
  }
  kernel.normalise(draws.data(), 2, reference.data(), 0.01);
  for (std::size_t m = 0; m < 2; ++m) {
    out.insert(out.end(), state[m].begin(), state[m].end());
    out.insert(out.end(), scratch[m].begin(), scratch[m].end());
  }
  return out;
}

TEST(CandidateKernel, HasTheSameBitsAtEveryWidth) {
  for (const double degrees : {5.0, std::numeric_limits<double>::infinity()}) {
    const std::vector<double> first = after_a_row(*candidate_kernels().front(), degrees);
    for (const double x : first) ASSERT_TRUE(std::isfinite(x));
    for (const CandidateKernel* kernel : candidate_kernels())
      EXPECT_EQ(after_a_row(*kernel, degrees), first) << kernel->name;
  }
}

}  // namespace
}  // namespace wheeltap::identification::monitoring
