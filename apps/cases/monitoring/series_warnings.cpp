#include "apps/cases/monitoring/series_warnings.hpp"

#include <algorithm>
#include <cmath>

#include "apps/cases/monitoring/monitor_case.hpp"
#include "base/index.hpp"
#include "base/number.hpp"
#include "identification/monitoring/series.hpp"

namespace wheeltap::apps {
namespace {

/// Lengths of sequences of missing values and of equal values.
struct Sequences {
  int missing = 0, equal = 0;
};

/// The sequences that end at the last of rows [from, to), and the longest sequences in these rows.
struct ColumnSequences {
  Sequences last = {}, longest = {};
  double value = NAN;  ///< value of the last row that has one
};

ColumnSequences sequences_of(const Eigen::Ref<const Eigen::VectorXd>& column, int from, int to) {
  ColumnSequences out;
  for (int i = from; i < to; ++i) {
    if (std::isnan(column[i])) {
      ++out.last.missing;
    } else {
      out.last.missing = 0;
      out.last.equal = column[i] == out.value ? out.last.equal + 1 : 1;
      out.value = column[i];
    }
    out.longest.missing = std::max(out.longest.missing, out.last.missing);
    out.longest.equal = std::max(out.longest.equal, out.last.equal);
  }
  return out;
}

void warn_of_dead_column(const Eigen::Ref<const Eigen::VectorXd>& column, const std::string& name,
                         const std::string& consequence, MonitorCaseFile& out) {
  constexpr int kFewestRows = 24;  // shorter sequences are common
  constexpr int kLonger = 3;       // times the longest sequence of the training period
  const int n = out.series.rows();
  const ColumnSequences learnt = sequences_of(column, 0, out.learning_rows);
  const ColumnSequences now = sequences_of(column, out.learning_rows, n);
  const auto long_since = [&](int rows, int usual) {
    return rows >= std::max(kFewestRows, kLonger * usual);
  };
  const auto since = [&](int rows) {
    return " since " + out.time.text(out.series.hours[index(n - rows)]) + " (" +
           std::to_string(rows) + " rows)";
  };
  if (long_since(now.last.missing, learnt.longest.missing))
    out.warnings.push_back(name + " has no value" + since(now.last.missing) + ": " + consequence);
  else if (now.last.missing == 0 && long_since(now.last.equal, learnt.longest.equal))
    out.warnings.push_back(name + " is " + base::number(now.value) + " in all rows" +
                           since(now.last.equal) + ": " + consequence);
}

}  // namespace

void warn_of_error_codes(MonitorCaseFile& out) {
  for (int c = 0; c < out.series.covariate_count(); ++c) {
    std::vector<double> values;
    for (int i = 0; i < out.learning_rows; ++i)
      if (const double u = out.series.covariates(i, c); std::isfinite(u)) values.push_back(u);
    if (values.empty()) continue;
    const auto median = [](std::vector<double> list) {
      const auto middle = list.begin() + static_cast<std::ptrdiff_t>(list.size() / 2);
      std::nth_element(list.begin(), middle, list.end());
      return *middle;
    };
    const double centre = median(values);
    for (double& u : values) u = std::abs(u - centre);
    const double limit = identification::monitoring::kLargestDeviation * 1.4826 * median(values);
    for (int i = 0; i < out.learning_rows && limit > 0.0; ++i) {
      const double u = out.series.covariates(i, c);
      if (!(std::abs(u - centre) > limit)) continue;
      out.warnings.push_back("The covariate " + out.series.covariate_names[index(c)] + " is " +
                             base::number(u) + " at " + out.time.text(out.series.hours[index(i)]) +
                             ", in the training period, where its median is " +
                             base::number(centre) +
                             ": leave the cell empty if this value is an error code.");
      break;
    }
  }
}

void warn_of_dead_columns(MonitorCaseFile& out) {
  for (int j = 0; j < out.series.feature_count(); ++j)
    warn_of_dead_column(out.features.col(j), "The feature " + out.series.feature_names[index(j)],
                        "changes of this feature are not detected. Check the sensor.", out);
  for (int c = 0; c < out.series.covariate_count(); ++c)
    warn_of_dead_column(out.series.covariates.col(c),
                        "The covariate " + out.series.covariate_names[index(c)],
                        "an alarm may be an effect of the weather. Check the sensor.", out);
}

}  // namespace wheeltap::apps
