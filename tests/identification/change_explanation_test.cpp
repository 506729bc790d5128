#include "identification/monitoring/causes/change_explanation.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "base/index.hpp"
#include "base/random.hpp"

namespace wheeltap::identification::monitoring {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// One change point, Gaussian noise, every onset kept.
TEST(ShiftLikelihood, EqualsThatOfRowsWithoutTheShift) {
  BaselineParameters b;
  b.terms.low = b.terms.high = b.terms.long_low = b.terms.long_high = VectorXd();
  b.fast_rate = 0.15;
  b.fast_sd = Eigen::Vector2d(0.8, 0.5);
  b.slow_sd = Eigen::Vector2d(0.3, 0.2);
  b.noise_sd = Eigen::Vector2d(1.0, 0.7);
  b.correlation = (MatrixXd(2, 2) << 1.0, 0.4, 0.4, 1.0).finished();
  b.coefficient_mean = MatrixXd::Zero(1, 2);
  b.coefficient_sd = MatrixXd::Constant(1, 2, 2.0);
  BaselineDraw draw{.parameters = b, .filter = BaselineFilter(b)};
  const Baseline baseline{.scaling = CovariateScaling(MatrixXd(10, 0)),
                          .residual_sd = Eigen::Vector2d(1.2, 0.9),
                          .draws = {draw}};
  base::Random random(3, 0, 0, base::Purpose::test);
  std::vector<Row> rows;
  for (int t = 0; t < 12; ++t) {
    Row row{.hours = 1.0 + t, .features = VectorXd(2), .relative_variance = VectorXd::Ones(2)};
    for (double& y : row.features) y = random.normal() + (t > 5 ? 1.5 : 0.0);
    if (t % 4 == 1) row.features[1] = kNaN;
    rows.push_back(row);
  }
  ChangePoint change(baseline, {.hazard_per_hour = 0.01,
                                .transients_per_hour = 0.0,
                                .ramp_share = 0.0,
                                .young = 0,
                                .fixed_share = 0.0});
  for (const Row& row : rows) static_cast<void>(change.add(row));
  const ShiftLikelihood found =
      shift_likelihood(change.candidates(), rows.back().hours, baseline.residual_sd,
                       {.components = 100, .negligible = 0.0});
  ASSERT_EQ(found.components.size(), rows.size());
  // ln Σ over onsets of P(onset) p(rows | onset, shift).
  const auto direct = [&](const VectorXd& shift) {
    double sum = 0.0;
    for (std::size_t onset = 0; onset < rows.size(); ++onset) {
      BaselineFilter filter(b);
      double log_density = 0.0, before = 0.0;
      for (std::size_t t = 0; t < rows.size(); ++t) {
        Row row = rows[t];
        if (t >= onset) row.features -= shift;
        const Weather weather{.h = VectorXd::Ones(3)};
        log_density += filter_row(b, weather, row, row.hours - before, filter).log_density;
        before = row.hours;
      }
      sum += std::exp(log_density - 0.01 * static_cast<double>(onset));
    }
    return std::log(sum);
  };
  const VectorXd none = VectorXd::Zero(2);
  for (const auto& [a, c] : {std::pair{1.5, 1.4}, {-0.5, 2.0}, {4.0, 0.0}}) {
    const VectorXd shift = Eigen::Vector2d(a, c);
    EXPECT_NEAR(log_likelihood(found, shift) - log_likelihood(found, none),
                direct(shift) - direct(none), 1e-8);
  }
}

/// A three-span beam with reductions and added masses, six modes.
struct Bridge {
  Bridge() {
    std::vector<fem::Support> supports;
    for (const double x : {0.0, 9.0, 20.0, 30.0})
      supports.push_back({.at = x, .deflection = true, .rotation = false, .stiffness = {}});
    damage_case.beam = {
        .length = 30.0,
        .elements = 30,
        .supports = supports,
        .material = {.young = 30e9, .poisson = 0.2, .density = 2500.0},
        .section = {.area = 0.6, .second_moment = 0.018, .shear_coefficient = 0.85}};
    const auto add = [&](const char* type, double most) {
      DefectKind kind{.type = find_defect_type(type),
                      .name = type,
                      .max_count = 1,
                      .weights = {0.5, 0.5},
                      .location = inference::Uniform{0.0, 30.0},
                      .severity = inference::Prior(inference::Uniform{0.0, most})};
      kind.line = SiteLine::of_beam(damage_case.beam);
      damage_case.kinds.push_back(kind);
    };
    add("reduction", 0.8);
    add("mass", 2000.0);
    paths = defect_paths(damage_case, {0, 1, 2, 3, 4, 5}, 1);
    options = {.weights = {.damage = 1.0, .mass = 1.0, .sensor = 1.0, .other = 0.1},
               .is_mass = {false, true},
               .share = {1.0, 1.0},
               .residual_sd = VectorXd::Constant(6, 0.002),
               .covariate_sd = VectorXd::Constant(1, 6.0)};
    slopes = MatrixXd(6, 1);
    slopes << -0.0005, -0.0006, -0.0004, -0.0005, -0.0007, -0.0003;
  }
  /// The shift of a true defect, between the nodes of its path.
  [[nodiscard]] VectorXd shift(int kind, double x, double share) const {
    for (const DefectPath& path : paths) {
      if (path.kind != kind || x < path.from || x >= path.to) continue;
      const double at = share * static_cast<double>(path.severities.size() - 1);
      const auto i = static_cast<Index>(at);
      return path.shifts.col(i) +
             (at - static_cast<double>(i)) * (path.shifts.col(i + 1) - path.shifts.col(i));
    }
    return {};
  }
  [[nodiscard]] ChangeExplanation explain(const VectorXd& measured, double sd) const {
    const ShiftLikelihood likelihood{
        .components = {{.mean = measured, .precision = MatrixXd::Identity(6, 6) / (sd * sd)}}};
    return explain_change(likelihood, slopes, damage_case.kinds, paths, options);
  }
  DamageCase damage_case;
  std::vector<DefectPath> paths;
  CauseOptions options;
  MatrixXd slopes;
};

TEST(ChangeExplanation, FindsPlaceAndSeverityOfASharplyMeasuredDamage) {
  const Bridge bridge;
  const ChangeExplanation found = bridge.explain(bridge.shift(0, 13.5, 0.5), 1e-5);
  EXPECT_GT(found.damage, 0.9);
  EXPECT_LT(found.distance_to_damage, 1e-3);
  EXPECT_NEAR(found.defects[0].location.q50, 13.5, 0.6);
  EXPECT_NEAR(found.defects[0].severity.q50, 0.4, 0.01);
  EXPECT_NEAR(found.damage + found.mass + found.sensor + found.other, 1.0, 1e-12);
}

// The masses of neighbouring elements overlap in severity: sorted by their lower ends alone, the
// median of an added mass exceeded its 95 % quantile.
TEST(ChangeExplanation, QuantilesAreInOrder) {
  const Bridge bridge;
  for (const double x : {3.5, 7.5, 13.5, 22.0})
    for (const double share : {0.3, 0.7, 0.99})
      for (const ExplainedDefect& defect : bridge.explain(bridge.shift(0, x, share), 1e-4).defects)
        for (const CentralInterval& of : {defect.location, defect.severity}) {
          EXPECT_LE(of.q5, of.q50) << x << " m, " << share;
          EXPECT_LE(of.q50, of.q95) << x << " m, " << share;
        }
}

// Shifts of a damage plus a deviation: five to seven standard deviations from every damage.
TEST(ChangeExplanation, CallsNoShiftDamageThatIsFarFromEveryDamage) {
  const Bridge bridge;
  constexpr double kSd = 0.0005;
  base::Random random(5, 0, 0, base::Purpose::test);
  int far = 0, called = 0;
  for (int i = 0; i < 200; ++i) {
    VectorXd shift = bridge.shift(0, 30.0 * random.uniform(), random.uniform());
    for (double& x : shift) x += 3.5 * kSd * random.normal();
    const ChangeExplanation found = bridge.explain(shift, kSd);
    if (found.distance_to_damage < 5.0 || found.distance_to_damage > 7.0) continue;
    ++far;
    called += found.damage > 0.05 ? 1 : 0;
  }
  EXPECT_GT(far, 40);
  EXPECT_LE(called, far / 20);
}

// Causes, places and severities from their priors. 450 changes: the numbers of covered places and
// severities and the sums of the probabilities lie within 3.3 standard errors (1 in 1000 each).
TEST(ChangeExplanation, IsCalibratedUnderItsPriors) {
  Bridge bridge;
  bridge.options.weights.other = 1e-3;  // it never occurs here
  base::Random random(7, 0, 0, base::Purpose::test);
  constexpr int kEach = 150;
  constexpr double kSd = 0.001;
  int places = 0, severities = 0;
  Eigen::Vector3d expected = Eigen::Vector3d::Zero(), variance = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3 * kEach; ++i) {
    VectorXd shift;
    const double x = 30.0 * random.uniform(), share = random.uniform();
    if (i % 3 < 2) {
      shift = bridge.shift(i % 3, x, share);
    } else if (random.uniform() < 0.5) {
      constexpr std::array kSizes{0.5, 1.5, 5.0, 15.0, 50.0};
      shift = VectorXd::Zero(6);
      shift[static_cast<Index>(6.0 * random.uniform())] =
          0.002 * kSizes[static_cast<std::size_t>(5.0 * random.uniform())] * random.normal();
    } else {
      constexpr std::array kSizes{0.1, 0.3, 1.0, 3.0};
      shift = bridge.slopes.col(0) * 6.0 *
              kSizes[static_cast<std::size_t>(4.0 * random.uniform())] * random.normal();
    }
    for (double& y : shift) y += kSd * random.normal();
    const ChangeExplanation found = bridge.explain(shift, kSd);
    const Eigen::Vector3d causes(found.damage, found.mass, found.sensor);
    expected += causes;
    variance.array() += causes.array() * (1.0 - causes.array());
    if (i % 3 != 0) continue;
    const auto& damage = found.defects[0];
    places += damage.location.q5 <= x && x <= damage.location.q95 ? 1 : 0;
    severities += damage.severity.q5 <= 0.8 * share && 0.8 * share <= damage.severity.q95 ? 1 : 0;
  }
  const double error = std::sqrt(kEach * 0.9 * 0.1);
  EXPECT_NEAR(places, 0.9 * kEach, 3.3 * error);
  EXPECT_NEAR(severities, 0.9 * kEach, 3.3 * error);
  // Offsets of thermometers follow the slopes here without the deviations that are allowed for.
  for (Index cause = 0; cause < 3; ++cause)
    EXPECT_NEAR(expected[cause], kEach, 3.3 * std::sqrt(variance[cause]) + 3.0) << cause;
}

}  // namespace
}  // namespace wheeltap::identification::monitoring
