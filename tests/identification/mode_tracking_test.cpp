#include "identification/monitoring/mode_tracking.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "base/index.hpp"
#include "base/random.hpp"

namespace wheeltap::identification::monitoring {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Sums over all assignments, one by one.
MatrixXd enumerated(const MatrixXd& ratio, const VectorXd& detection) {
  MatrixXd out = MatrixXd::Zero(ratio.rows(), ratio.cols());
  double all = 0.0;
  std::vector<Index> chosen;
  const std::function<void(double)> choose = [&](double weight) {
    const auto k = static_cast<Index>(chosen.size());
    if (k == ratio.rows()) {
      all += weight;
      for (Index i = 0; i < k; ++i)
        if (chosen[index(i)] >= 0) out(i, chosen[index(i)]) += weight;
      return;
    }
    chosen.push_back(-1);
    choose(weight * (1.0 - detection[k]));
    chosen.pop_back();
    for (Index j = 0; j < ratio.cols(); ++j) {
      if (std::ranges::find(chosen, j) != chosen.end()) continue;
      chosen.push_back(j);
      choose(weight * detection[k] * ratio(k, j));
      chosen.pop_back();
    }
  };
  choose(1.0);
  return out / all;
}

TEST(PairProbabilities, EqualTheSumOverAllAssignments) {
  base::Random random(3, 0, 0, base::Purpose::test);
  for (const auto& [tracked, modes] : {std::pair{1, 1}, {3, 4}, {4, 3}, {5, 5}, {2, 0}}) {
    MatrixXd ratio(tracked, modes);
    for (double& r : ratio.reshaped()) r = std::exp(4.0 * random.normal());
    VectorXd detection(tracked);
    for (double& d : detection) d = 0.1 + 0.8 * random.uniform();
    EXPECT_LT((pair_probabilities(ratio, detection) - enumerated(ratio, detection)).norm(), 1e-12)
        << tracked << " " << modes;
  }
}

TEST(ModalAssurance, IgnoresScalePhaseAndMissingEntries) {
  Eigen::VectorXcd a(3), b(3);
  a << 1.0, std::complex<double>(0.2, 0.5), -0.4;
  b = std::polar(3.0, 0.7) * a;
  EXPECT_NEAR(modal_assurance(a, b), 1.0, 1e-12);
  b[2] = NAN;
  EXPECT_NEAR(modal_assurance(a, b), 1.0, 1e-12);
  Eigen::VectorXcd c(3);
  c << 0.4, 0.0, 1.0;
  EXPECT_NEAR(modal_assurance(a, c), 0.0, 1e-12);
}

Eigen::VectorXcd shape_of(double a, double b, double c) {
  return Eigen::Vector3d(a, b, c).cast<std::complex<double>>();
}

/// Two modes that cross, one that jumps by 10 % at record 60, spurious modes, and missing ones.
struct Simulated {
  std::vector<IdentifiedRecord> records;
  std::vector<std::array<int, 3>> truth;  // index of each mode, -1: missing
};

Simulated simulated_records(int n, std::uint64_t seed) {
  base::Random random(seed, 0, 0, base::Purpose::test);
  const Eigen::VectorXcd shapes[] = {shape_of(1, 0.8, 0.5), shape_of(1, -0.2, -0.9),
                                     shape_of(0.5, -1, 0.6)};
  Simulated out;
  for (int t = 0; t < n; ++t) {
    const double x = static_cast<double>(t) / n;
    const double f[] = {4.0 + 0.6 * x, 4.5 - 0.4 * x, t < 60 ? 12.0 : 10.8};
    IdentifiedRecord record;
    std::array<int, 3> truth = {-1, -1, -1};
    for (int k = 2; k >= 0; --k) {
      if (random.uniform() < 0.1) continue;
      truth[index(k)] = static_cast<int>(record.size());
      IdentifiedMode mode{.frequency_hz = f[k] * std::exp(0.002 * random.normal()),
                          .frequency_sd = 0.001 * f[k],
                          .shape = shapes[k]};
      for (auto& s : mode.shape) s += 0.03 * random.normal();
      record.push_back(mode);
    }
    if (random.uniform() < 0.5) {
      IdentifiedMode mode{.frequency_hz = 3.0 * std::exp(1.5 * random.uniform()),
                          .shape = Eigen::VectorXcd(3)};
      for (auto& s : mode.shape) s = random.normal();
      record.push_back(mode);
    }
    out.records.push_back(record);
    out.truth.push_back(truth);
  }
  return out;
}

TEST(ModeTracker, FollowsModesThatCrossAndOneThatJumps) {
  const Simulated all = simulated_records(100, 5);
  const ModeTracker tracker({all.records.begin(), all.records.begin() + 50}, MatrixXd(50, 0));
  ASSERT_EQ(tracker.modes().size(), 3U);
  const auto tracked = tracker.track(all.records, MatrixXd(100, 0));
  int wrong = 0;
  for (std::size_t t = 0; t < tracked.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) wrong += tracked[t].mode[k] != all.truth[t][k] ? 1 : 0;
  EXPECT_LE(wrong, 3);  // of 300: a spurious mode may lie where a mode is missing
}

TEST(ModeTracker, RejectsRecordsWithoutACommonMode) {
  std::vector<IdentifiedRecord> records(30);
  for (std::size_t t = 0; t < records.size(); ++t)
    records[t].push_back({.frequency_hz = std::pow(1.2, static_cast<double>(t))});
  EXPECT_THROW(ModeTracker(records, MatrixXd(30, 0)), std::invalid_argument);
}

/// Frost raises both modes by 8 %: the regression on temperature predicts it.
TEST(ModeTracker, PredictsFrequenciesFromCovariates) {
  base::Random random(9, 0, 0, base::Purpose::test);
  std::vector<IdentifiedRecord> records;
  MatrixXd air(200, 1);
  for (Index t = 0; t < 200; ++t) {
    air(t, 0) = 12.0 * std::sin(0.25 * static_cast<double>(t));
    const double rise = std::exp(0.008 * std::max(0.0, -air(t, 0)));
    IdentifiedRecord record;
    for (const double f : {4.0, 4.3})
      if (random.uniform() > 0.2)
        record.push_back({.frequency_hz = f * rise * std::exp(0.003 * random.normal()),
                          .frequency_sd = 0.002 * f});
    records.push_back(record);
  }
  const ModeTracker tracker({records.begin(), records.begin() + 150}, air.topRows(150));
  ASSERT_EQ(tracker.modes().size(), 2U);
  int wrong = 0, all = 0;
  const auto tracked = tracker.track(records, air);
  for (std::size_t t = 0; t < tracked.size(); ++t) {
    const double rise = std::exp(0.008 * std::max(0.0, -air(static_cast<Index>(t), 0)));
    for (std::size_t k = 0; k < 2; ++k)
      if (const int m = tracked[t].mode[k]; m >= 0) {
        ++all;
        const double f = records[t][index(m)].frequency_hz / rise;
        wrong += (std::abs(f - 4.0) < std::abs(f - 4.3)) != (k == 0) ? 1 : 0;
      }
  }
  EXPECT_GT(all, 250);
  EXPECT_LE(wrong, 4);
}

}  // namespace
}  // namespace wheeltap::identification::monitoring
