#include "apps/report_json.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace wheeltap::apps {

namespace {

double rounded(double x, int digits) {
  if (!std::isfinite(x) || x == 0.0) return x;
  char text[32];
  std::snprintf(text, sizeof text, "%.*g", digits, x);
  return std::strtod(text, nullptr);
}

}  // namespace

Report finite(double x) {
  return std::isfinite(x) ? Report(x) : Report();
}

Report rows_of(const Eigen::MatrixXd& matrix) {
  Report rows = Report::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    Report row = Report::array();
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) row.push_back(finite(matrix(i, j)));
    rows.push_back(std::move(row));
  }
  return rows;
}

double compact(double x) {
  return rounded(x, 5);
}

double compact(double x, double width) {
  if (!(width > 0.0) || x == 0.0) return compact(x);
  const double more = std::ceil(std::log10(std::abs(x) / width)) + 3.0;
  return rounded(x, static_cast<int>(std::clamp(more, 5.0, 17.0)));
}

}  // namespace wheeltap::apps
