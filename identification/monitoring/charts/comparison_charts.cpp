#include "identification/monitoring/charts/comparison_charts.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "identification/monitoring/charts/cointegration.hpp"
#include "identification/monitoring/residual_scatter.hpp"
#include "identification/monitoring/weather_regression.hpp"

namespace wheeltap::identification::monitoring {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kMedianRows = 12;
constexpr double kEulerGamma = 0.57721566490153286;

/// Residuals of the training rows, n x p; `residuals_of` computes those of one row.
template <class Residuals>
MatrixXd learned_residuals(const Series& learning, const Residuals& residuals_of) {
  MatrixXd out(learning.rows(), learning.feature_count());
  for (int t = 0; t < learning.rows(); ++t)
    out.row(t) = residuals_of(row_of(learning, t, {})).transpose();
  return out;
}

/// Stands in for a regression: its residuals are the features.
struct RawFeatures {
  explicit RawFeatures(const Series& /*learning*/) {}
  [[nodiscard]] VectorXd residuals(const Row& row) const { return row.features; }
};

/// Hotelling's T² of a regression's residuals.
template <class Regression>
class HotellingChart final : public ComparisonChart {
 public:
  explicit HotellingChart(const Series& learning)
      : regression_(learning),
        scatter_(robust_scatter(learned_residuals(
            learning, [this](const Row& row) { return regression_.residuals(row); }))) {}
  double add(const Row& row) override {
    return squared_distance(scatter_, regression_.residuals(row));
  }

 private:
  Regression regression_;
  Scatter scatter_;
};

/// Squared prediction error of the principal components that explain 90 % of the variance.
class ComponentChart final : public ComparisonChart {
 public:
  explicit ComponentChart(const Series& learning) : scatter_(robust_scatter(learning.features)) {
    const Index p = scatter_.sd.size();
    const VectorXd scale = scatter_.sd.cwiseInverse();
    const MatrixXd correlation = scale.asDiagonal() * scatter_.covariance * scale.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(correlation);
    Index kept = 1;
    for (double held = eigen.eigenvalues()[p - 1];
         kept < p - 1 && held < 0.9 * eigen.eigenvalues().sum(); ++kept)
      held += eigen.eigenvalues()[p - 1 - kept];
    components_ = eigen.eigenvectors().rightCols(kept);
  }
  double add(const Row& row) override {
    std::vector<Index> present;
    for (Index j = 0; j < row.features.size(); ++j)
      if (std::isfinite(row.features[j])) present.push_back(j);
    const auto n = static_cast<Index>(present.size());
    if (n <= components_.cols()) return kNaN;
    const VectorXd x = ((row.features - scatter_.median).cwiseQuotient(scatter_.sd))(present);
    const MatrixXd directions = components_(present, Eigen::all);
    const VectorXd scores = Eigen::ColPivHouseholderQR<MatrixXd>(directions).solve(x);
    const double freedom = static_cast<double>(n - components_.cols());
    return (x - directions * scores).squaredNorm() / freedom;
  }

 private:
  Scatter scatter_;
  MatrixXd components_;
};

/// Squared residual of the most stationary combination. A missing feature keeps its last value.
class CointegrationChart final : public ComparisonChart {
 public:
  explicit CointegrationChart(const Series& learning) {
    last_ = robust_scatter(learning.features).median;
    MatrixXd levels(learning.rows(), last_.size());
    for (int t = 0; t < learning.rows(); ++t) {
      follow(learning.features.row(t).transpose());
      levels.row(t) = last_.transpose();
    }
    vector_ = cointegrating_vector(levels);
    scatter_ = robust_scatter(levels * vector_);
  }
  double add(const Row& row) override {
    if (!row.features.array().isFinite().any()) return kNaN;
    follow(row.features);
    return squared_distance(scatter_, VectorXd::Constant(1, vector_.dot(last_)));
  }

 private:
  void follow(const VectorXd& features) {
    for (Index j = 0; j < features.size(); ++j)
      if (std::isfinite(features[j])) last_[j] = features[j];
  }
  VectorXd last_, vector_;
  Scatter scatter_;
};

/// Residuals of the regression in standard deviations, clipped so that one outlier is no shift.
class ClippedResiduals {
 public:
  explicit ClippedResiduals(const Series& learning)
      : regression_(learning),
        scatter_(robust_scatter(learned_residuals(
            learning, [this](const Row& row) { return regression_.residuals(row); }))) {}
  [[nodiscard]] VectorXd operator()(const Row& row) const {
    VectorXd out = (regression_.residuals(row) - scatter_.median).cwiseQuotient(scatter_.sd);
    for (double& r : out)
      if (std::isfinite(r)) r = std::clamp(r, -4.0, 4.0);
    return out;
  }
  [[nodiscard]] MatrixXd correlation() const {
    const VectorXd scale = scatter_.sd.cwiseInverse();
    return scale.asDiagonal() * scatter_.covariance * scale.asDiagonal();
  }

 private:
  HingeRegression regression_;
  Scatter scatter_;
};

/// The largest of C± = max(0, C± ± r - 1/2) over all features.
class CusumChart final : public ComparisonChart {
 public:
  explicit CusumChart(const Series& learning)
      : residuals_(learning),
        up_(VectorXd::Zero(learning.feature_count())),
        down_(VectorXd::Zero(learning.feature_count())) {}
  double add(const Row& row) override {
    constexpr double kReference = 0.5;
    const VectorXd r = residuals_(row);
    for (Index j = 0; j < r.size(); ++j) {
      if (!std::isfinite(r[j])) continue;
      up_[j] = std::max(0.0, up_[j] + r[j] - kReference);
      down_[j] = std::max(0.0, down_[j] - r[j] - kReference);
    }
    return std::max(up_.maxCoeff(), down_.maxCoeff());
  }

 private:
  ClippedResiduals residuals_;
  VectorXd up_, down_;
};

/// Statistic m' C⁻¹ m (2 - λ)/λ with m = (1 - λ) m + λ r, λ = 0.1.
class EwmaChart final : public ComparisonChart {
 public:
  explicit EwmaChart(const Series& learning)
      : residuals_(learning),
        factor_(residuals_.correlation()),
        mean_(VectorXd::Zero(learning.feature_count())) {}
  double add(const Row& row) override {
    constexpr double kShare = 0.1;
    const VectorXd r = residuals_(row);
    for (Index j = 0; j < r.size(); ++j)
      if (std::isfinite(r[j])) mean_[j] += kShare * (r[j] - mean_[j]);
    return mean_.dot(factor_.solve(mean_)) * (2.0 - kShare) / kShare;
  }

 private:
  ClippedResiduals residuals_;
  Eigen::LLT<MatrixXd> factor_;
  VectorXd mean_;
};

template <class Chart>
std::unique_ptr<ComparisonChart> learned(const Series& learning) {
  return std::make_unique<Chart>(learning);
}

/// Median of a chart's latest values; NaN until there are enough values.
class RunningMedian {
 public:
  explicit RunningMedian(int rows) : rows_(static_cast<std::size_t>(rows)) {}
  double add(double value) {
    if (!std::isfinite(value) || rows_ == 1) return value;
    values_.push_back(value);
    if (values_.size() < rows_) return kNaN;
    if (values_.size() > rows_) values_.erase(values_.begin());
    std::vector<double> sorted = values_;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    return *middle;
  }

 private:
  std::size_t rows_;
  std::vector<double> values_;
};

/// The statistic over rows [from, to).
std::vector<double> statistics_of(const ChartKind& kind, ComparisonChart& chart,
                                  const Series& series, int from, int to, bool is_short) {
  RunningMedian median(is_short ? 1 : kind.median_rows);
  std::vector<double> out;
  for (int t = from; t < to; ++t) out.push_back(median.add(chart.add(row_of(series, t, {}))));
  return out;
}

/// The first `rows` rows except rows [from, to).
Series without(const Series& series, int rows, int from, int to) {
  std::vector<Index> kept;
  for (int t = 0; t < rows; ++t)
    if (t < from || t >= to) kept.push_back(t);
  Series out = series;
  out.hours.clear();
  for (const Index t : kept) out.hours.push_back(series.hours[index(t)]);
  out.features = series.features(kept, Eigen::all);
  out.covariates = series.covariates(kept, Eigen::all);
  out.sds.resize(0, 0);
  return out;
}

ChartFinding run_chart(const ChartKind& kind, const Series& series, int learning_rows,
                       double rows_between) {
  const bool is_short = learning_rows < kFewestRowsForMedian;
  std::vector<double> healthy;
  for (int third = 0; third < 3; ++third) {
    const int from = third * learning_rows / 3, to = (third + 1) * learning_rows / 3;
    const auto chart = kind.learn(without(series, learning_rows, from, to));
    const std::vector<double> part = statistics_of(kind, *chart, series, from, to, is_short);
    healthy.insert(healthy.end(), part.begin(), part.end());
  }
  ChartFinding out{.name = kind.name, .threshold = chart_threshold(healthy, rows_between)};
  const auto chart = kind.learn(series.first(learning_rows));
  // The last training rows initialise the running median and the state of the chart.
  const int from = std::max(0, learning_rows - kMedianRows);
  out.statistic = statistics_of(kind, *chart, series, from, series.rows(), is_short);
  out.statistic.erase(out.statistic.begin(), out.statistic.begin() + (learning_rows - from));
  out.alarms = chart_alarms(out.statistic, out.threshold);
  for (int& row : out.alarms) row += learning_rows;
  return out;
}

}  // namespace

const std::vector<ChartKind>& chart_kinds() {
  static const std::vector<ChartKind> kinds = {
      {.name = "T² of features",
       .median_rows = kMedianRows,
       .learn = learned<HotellingChart<RawFeatures>>},
      {.name = "T² after regression",
       .of_covariates = true,
       .median_rows = kMedianRows,
       .learn = learned<HotellingChart<HingeRegression>>},
      {.name = "principal components",
       .fewest_features = 2,
       .median_rows = kMedianRows,
       .learn = learned<ComponentChart>},
      {.name = "cointegration",
       .fewest_features = 2,
       .median_rows = kMedianRows,
       .learn = learned<CointegrationChart>},
      {.name = "Gaussian process regression",
       .of_covariates = true,
       .median_rows = kMedianRows,
       .learn = learned<HotellingChart<ProcessRegression>>},
      {.name = "CUSUM", .learn = learned<CusumChart>},
      {.name = "EWMA", .learn = learned<EwmaChart>},
  };
  return kinds;
}

double chart_threshold(const std::vector<double>& healthy, double rows_between) {
  const std::size_t block = std::clamp<std::size_t>(healthy.size() / 20, 1, 24);
  std::vector<double> maxima;
  for (std::size_t from = 0; from < healthy.size(); from += block) {
    double most = -kInfinity;
    for (std::size_t i = from; i < std::min(from + block, healthy.size()); ++i)
      if (std::isfinite(healthy[i])) most = std::max(most, healthy[i]);
    if (std::isfinite(most)) maxima.push_back(most);
  }
  if (maxima.empty()) return kInfinity;
  std::ranges::sort(maxima);
  const auto n = static_cast<double>(maxima.size());
  double mean = 0.0, weighted = 0.0;  // b0 and b1, probability-weighted moments
  for (std::size_t i = 0; i < maxima.size(); ++i) {
    mean += maxima[i] / n;
    if (n > 1.0) weighted += maxima[i] * static_cast<double>(i) / (n * (n - 1.0));
  }
  const double scale = std::max(0.0, 2.0 * weighted - mean) / std::log(2.0);
  const double place = mean - kEulerGamma * scale;
  return place + scale * std::log(rows_between / static_cast<double>(block));
}

std::vector<int> chart_alarms(const std::vector<double>& statistic, double threshold) {
  std::vector<int> out;
  int below = kRowsBelow;
  for (std::size_t t = 0; t < statistic.size(); ++t) {
    if (!std::isfinite(statistic[t])) continue;
    if (statistic[t] < threshold) {
      ++below;
      continue;
    }
    if (below >= kRowsBelow) out.push_back(static_cast<int>(t));
    below = 0;
  }
  return out;
}

std::vector<ChartFinding> run_charts(const Series& series, int learning_rows,
                                     double rows_between_false_alarms, int threads) {
  const CovariateScaling scaling(series.covariates.topRows(learning_rows));
  std::vector<const ChartKind*> kinds;
  for (const ChartKind& kind : chart_kinds())
    if ((!kind.of_covariates || scaling.count() > 0) &&
        series.feature_count() >= kind.fewest_features)
      kinds.push_back(&kind);
  std::vector<ChartFinding> out(kinds.size());
  base::parallel_for(static_cast<int>(kinds.size()), threads, [&](int i) {
    out[index(i)] = run_chart(*kinds[index(i)], series, learning_rows, rows_between_false_alarms);
  });
  return out;
}

}  // namespace wheeltap::identification::monitoring
