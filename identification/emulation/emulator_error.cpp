#include "identification/emulation/emulator_error.hpp"

#include <algorithm>

namespace wheeltap::identification {
namespace {

using Eigen::Index;
using emulator::RowMatrix;

constexpr double kLeastSeverity = 1e-3;  // keeps variances above rounding as r → 0

// Σ r / (1 - r): compliance added by the damages, relative to that of one intact element.
double severity(std::span<const fem::Damage> damages) {
  double sum = kLeastSeverity;
  for (const fem::Damage& d : damages) sum += d.reduction / (1.0 - d.reduction);
  return sum;
}

}  // namespace

void error_variance(const EmulatorError& error, std::span<const fem::Damage> damages,
                    std::span<double> variance) {
  if (error.scale.empty()) {
    for (std::size_t i = 0; i < variance.size(); ++i)
      variance[i] = error.holdout[i].rmse * error.holdout[i].rmse;
    return;
  }
  const double s = severity(damages);
  for (std::size_t i = 0; i < variance.size(); ++i) variance[i] = error.scale[i] * s;
}

EmulatorError measured_error(const RowMatrix& truth, RowMatrix predicted, RowMatrix variance,
                             bool has_variance) {
  predicted = predicted.array().isNaN().select(truth, predicted);
  EmulatorError error;
  error.holdout = emulator::holdout_error(truth, predicted);
  for (Index mode = 0; mode < truth.cols(); ++mode) {
    const double ratio =
        ((truth.col(mode) - predicted.col(mode)).array().square() / variance.col(mode).array())
            .mean();
    error.scale.push_back(has_variance ? std::max(1.0, ratio) : ratio);
    variance.col(mode) *= error.scale.back();
  }
  error.standardised = emulator::standardised_residuals(truth, predicted, variance);
  return error;
}

RowMatrix to_matrix(const EmulatorError& error) {
  RowMatrix m(static_cast<Index>(error.holdout.size()), 8);
  for (Index i = 0; i < m.rows(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    const auto& h = error.holdout[at];
    const auto& s = error.standardised[at];
    m.row(i) << h.rmse, h.max_error, h.spread, h.q2, error.scale[at], s.mean, s.rms, s.beyond_two;
  }
  return m;
}

EmulatorError error_from(const RowMatrix& m) {
  EmulatorError error;
  for (Index i = 0; i < m.rows(); ++i) {
    error.holdout.push_back(
        {.rmse = m(i, 0), .max_error = m(i, 1), .spread = m(i, 2), .q2 = m(i, 3)});
    error.scale.push_back(m(i, 4));
    error.standardised.push_back({.mean = m(i, 5), .rms = m(i, 6), .beyond_two = m(i, 7)});
  }
  return error;
}

}  // namespace wheeltap::identification
