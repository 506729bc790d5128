// Simulation-based calibration (Talts et al. 2018) of the onset, the shift and the baseline's
// parameters. Onset, shift and parameters come from their priors, and series from the model. The
// place of a true value in its posterior is then uniform. 60 series here; with WHEELTAP_LONG_TESTS
// (scripts/monitoring-calibration) 500 longer ones, and a control with a wrong hazard.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/random.hpp"
#include "identification/monitoring/change_point.hpp"

namespace wheeltap::identification::monitoring {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kDraws = 5;
constexpr Index kFeatures = 2;

/// Draws of the baseline's parameters that differ in noise, drift and lag, each equally probable.
Baseline random_baseline(base::Random& random) {
  MatrixXd air(100, 1);
  for (double& u : air.reshaped()) u = 5.0 * random.normal();
  Baseline out{.scaling = CovariateScaling(air),
               .residual_sd = Eigen::Vector2d(1.1, 0.8),
               .rows_per_hour = 1.0};
  for (int m = 0; m < kDraws; ++m) {
    BaselineDraw draw;
    BaselineParameters& b = draw.parameters;
    b.terms.lag_hours = 4.0 * random.uniform();
    b.terms.hinge_of = {0};
    b.terms.knots = {random.normal()};
    b.terms.low = b.terms.long_low = VectorXd::Constant(1, -9.0);
    b.terms.high = b.terms.long_high = VectorXd::Constant(1, 9.0);
    b.fast_rate = std::exp(-1.0 - 2.0 * random.uniform());
    const double size = std::exp(0.4 * random.normal());
    b.noise_sd = size * Eigen::Vector2d(0.9, 0.6);
    b.fast_sd = (0.3 + 0.7 * random.uniform()) * b.noise_sd;
    b.slow_sd = 0.5 * b.noise_sd;
    const double r = 0.8 * random.uniform();
    b.correlation = (MatrixXd(2, 2) << 1.0, r, r, 1.0).finished();
    b.coefficient_mean = MatrixXd::Zero(3 + kUnseenTerms, kFeatures);
    b.coefficient_sd = MatrixXd::Constant(3 + kUnseenTerms, kFeatures, 1.0);
    draw.filter = BaselineFilter(b);
    out.draws.push_back(draw);
  }
  return out;
}

struct Truth {
  int draw = 0;
  int onset = -1;  // -1: no change
  VectorXd shift = VectorXd::Zero(kFeatures);
};

Truth random_onset_truth(double hazard, int rows, base::Random& random) {
  Truth out{.draw = random.index(kDraws)};
  for (int t = 0; t < rows && out.onset < 0; ++t)
    if (random.uniform() < -std::expm1(-hazard)) out.onset = t;
  if (out.onset < 0) return out;
  const double s = kShiftSizes[random.index(kSizes)];
  const int which = random.uniform() < 0.5 ? -1 : random.index(kFeatures);
  for (Index j = 0; j < kFeatures; ++j)
    if (which < 0 || which == j) out.shift[j] = s * (j == 0 ? 1.1 : 0.8) * random.normal();
  return out;
}

/// Rows of the model: each entry from its predictive density.
std::vector<Row> rows_of_model(const Baseline& baseline, const Truth& truth, int n,
                               base::Random& random) {
  BaselineDraw draw = baseline.draws[index(truth.draw)];
  std::vector<Row> out;
  for (int t = 0; t < n; ++t) {
    Row row{.hours = t + 1.0,
            .features = VectorXd::Constant(kFeatures, kNaN),
            .relative_variance = VectorXd::Ones(kFeatures),
            .covariates = VectorXd::Constant(1, 5.0 * std::sin(0.4 * t) + random.normal())};
    const Weather weather = next_weather(baseline.scaling(row.covariates), 1.0, draw);
    draw.filter.predict(draw.parameters, 1.0);
    VectorXd covariance;
    for (Index j = 0; j < kFeatures; ++j) {
      if (random.uniform() < 0.1) continue;
      const int feature = static_cast<int>(j);
      draw.filter.observe(feature, weather.h, covariance);
      const double s = draw.filter.variance(feature, weather.h, covariance) +
                       noise_variance(draw.parameters, weather, row, draw.filter, feature);
      const double v = std::sqrt(s) * random.normal();
      row.features[j] = draw.filter.mean(feature, weather.h) + v;
      draw.filter.update(covariance, v, s);
      if (truth.onset >= 0 && t >= truth.onset) row.features[j] += truth.shift[j];
    }
    out.push_back(row);
  }
  return out;
}

double normal_cdf(double z) {
  return 0.5 * std::erfc(-z / std::sqrt(2.0));
}

/// Places of the truth in its posteriors, each uniform in [0, 1]; ties are broken at random.
struct Places {
  double onset, shift, draw;
};

Places places_of(const ChangePoint& change, const Truth& truth, base::Random& random) {
  Places out{};
  const double changed = change.probability_changed();
  double all = 0.0;
  for (const CandidateOnset& c : change.candidates()) all += std::exp(c.log_mass());
  const auto mass = [&](const CandidateOnset& c) { return changed * std::exp(c.log_mass()) / all; };
  // No change is an onset after the last row.
  double below = 0.0, at = 1.0 - changed;
  for (const CandidateOnset& c : change.candidates()) {
    if (truth.onset < 0 || c.row < truth.onset) below += mass(c);
    if (truth.onset >= 0 && c.row == truth.onset) at = mass(c);
  }
  out.onset = below + random.uniform() * at;
  // The first feature's shift: a mixture of normals and a point mass at zero.
  double less = 0.0, zero = 1.0 - changed;
  const double value = truth.shift[0];
  for (const CandidateOnset& c : change.candidates())
    for (const ShiftPosterior& d : c.draws)
      for (Index size = 0; size < kSizes; ++size)
        for (Index h = 0; h <= kFeatures; ++h) {
          const double weight = mass(c) * std::exp(d.log_weight(h, size));
          if (h == 2) {
            zero += weight;
            continue;
          }
          const double mean = h == 0 ? d.mean(0, size) : d.single_mean(0, size);
          const double variance =
              h == 0 ? d.covariance(0, size * kFeatures) : d.single_variance(0, size);
          less += weight * normal_cdf((value - mean) / std::sqrt(variance));
        }
  out.shift = less + (value > 0.0 ? zero : value == 0.0 ? random.uniform() * zero : 0.0);
  const VectorXd probability = change.draw_probabilities();
  out.draw = probability.head(truth.draw).sum() + random.uniform() * probability[truth.draw];
  return out;
}

Places simulated_places(int number, int rows, double hazard, double assumed) {
  base::Random random(19, index(number), 0, base::Purpose::test);
  const Baseline baseline = random_baseline(random);
  const Truth truth = random_onset_truth(hazard, rows, random);
  ChangePoint change(baseline, {.hazard_per_hour = assumed,
                                .transients_per_hour = 0.0,
                                .ramp_share = 0.0,
                                .young = 0,
                                .fixed_share = 0.0});
  for (const Row& row : rows_of_model(baseline, truth, rows, random)) change.add(row);
  return places_of(change, truth, random);
}

/// Pearson's statistic of counts in ten equal intervals: χ² with 9 degrees of freedom.
double pearson(const std::vector<double>& places) {
  std::array<double, 10> counts{};
  for (const double u : places) counts[index(std::min(9, static_cast<int>(10.0 * u)))] += 1.0;
  const double expected = static_cast<double>(places.size()) / 10.0;
  double sum = 0.0;
  for (const double n : counts) sum += (n - expected) * (n - expected) / expected;
  return sum;
}

constexpr double kLimit = 27.88;  // exceeded with probability 0.001

std::array<double, 3> statistics_of(int series, int rows, double hazard, double assumed) {
  std::vector<double> onset(index(series)), shift(index(series)), draw(index(series));
  base::parallel_for(series, 0, [&](int i) {
    const Places places = simulated_places(i, rows, hazard, assumed);
    onset[index(i)] = places.onset;
    shift[index(i)] = places.shift;
    draw[index(i)] = places.draw;
  });
  return {pearson(onset), pearson(shift), pearson(draw)};
}

TEST(MonitoringCalibration, PlacesOfTheTruthAreUniform) {
  const bool is_long = std::getenv("WHEELTAP_LONG_TESTS") != nullptr;
  const int series = is_long ? 500 : 60, rows = is_long ? 100 : 40;
  const double hazard = 1.0 / rows;
  const auto statistic = statistics_of(series, rows, hazard, hazard);
  const char* names[] = {"onset", "shift", "parameters"};
  for (std::size_t i = 0; i < 3; ++i) {
    if (is_long)
      std::printf("%s: chi-square %.1f with 9 degrees of freedom\n", names[i], statistic[i]);
    EXPECT_LT(statistic[i], kLimit) << names[i];
  }
  if (!is_long) return;
  const auto wrong = statistics_of(series, rows, hazard, 10.0 * hazard);
  std::printf("with ten times the hazard, onset: chi-square %.1f\n", wrong[0]);
  EXPECT_GT(wrong[0], kLimit);
}

}  // namespace
}  // namespace wheeltap::identification::monitoring
