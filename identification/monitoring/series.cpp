#include "identification/monitoring/series.hpp"

#include <algorithm>
#include <cmath>

#include "base/index.hpp"

namespace wheeltap::identification::monitoring {
namespace {

using Eigen::Index;

/// The finite values of the first `rows` entries of a column.
std::vector<double> finite_values(const Eigen::MatrixXd& table, Index column, int rows) {
  std::vector<double> out;
  for (Index i = 0; i < rows; ++i)
    if (std::isfinite(table(i, column))) out.push_back(table(i, column));
  return out;
}

bool is_constant(const std::vector<double>& values) {
  const auto [low, high] = std::ranges::minmax_element(values);
  return *high - *low <= 1e-12 * std::max(std::abs(*low), std::abs(*high));
}

}  // namespace

Series Series::first(int rows) const {
  Series out = *this;
  out.hours.resize(index(rows));
  out.features = features.topRows(rows);
  if (sds.size() > 0) out.sds = sds.topRows(rows);
  out.covariates = covariates.topRows(rows);
  return out;
}

std::vector<SeriesFault> find_faults(const Series& series, int learning) {
  using Kind = SeriesFault::Kind;
  std::vector<SeriesFault> out;
  for (int i = 1; i < series.rows(); ++i) {
    const double step = series.hours[index(i)] - series.hours[index(i - 1)];
    if (!(step > 0.0))
      out.push_back({.kind = step == 0.0 ? Kind::time_repeated : Kind::time_decreasing, .row = i});
  }
  if (learning < kFewestLearningRows) {
    out.push_back({.kind = Kind::no_learning_rows});
    return out;
  }
  for (int j = 0; j < series.feature_count(); ++j) {
    const std::vector<double> values = finite_values(series.features, j, learning);
    if (static_cast<int>(values.size()) < kFewestLearningRows)
      out.push_back({.kind = Kind::feature_missing, .column = j});
    else if (is_constant(values))
      out.push_back({.kind = Kind::feature_constant, .column = j});
    for (Index i = 0; i < series.sds.rows(); ++i)
      if (std::isfinite(series.features(i, j)) && !(series.sds(i, j) > 0.0)) {
        out.push_back({.kind = Kind::sd_not_positive, .row = static_cast<int>(i), .column = j});
        break;
      }
  }
  for (int c = 0; c < series.covariate_count(); ++c) {
    const std::vector<double> values = finite_values(series.covariates, c, learning);
    if (values.empty())
      out.push_back({.kind = Kind::covariate_missing, .column = c});
    else if (is_constant(values))
      out.push_back({.kind = Kind::covariate_constant, .column = c});
  }
  return out;
}

double median_step(const std::vector<double>& hours) {
  std::vector<double> steps;
  for (std::size_t t = 1; t < hours.size(); ++t) steps.push_back(hours[t] - hours[t - 1]);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

Eigen::VectorXd usual_sds(const Series& series, int learning) {
  if (series.sds.size() == 0) return {};
  Eigen::VectorXd out(series.feature_count());
  for (Index j = 0; j < out.size(); ++j) {
    std::vector<double> values = finite_values(series.sds, j, learning);
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    out[j] = *middle;
  }
  return out;
}

Row row_of(const Series& series, int i, const Eigen::VectorXd& usual) {
  Row out{.hours = series.hours[index(i)],
          .features = series.features.row(i).transpose(),
          .relative_variance = Eigen::VectorXd::Ones(series.feature_count()),
          .covariates = series.covariates.row(i).transpose()};
  for (Index j = 0; j < usual.size(); ++j)
    if (!std::isnan(series.sds(i, j))) {
      const double ratio = series.sds(i, j) / usual[j];
      out.relative_variance[j] = std::min(ratio * ratio, kLargestRelativeVariance);
    }
  return out;
}

}  // namespace wheeltap::identification::monitoring
