#include "emulator/holdout.hpp"

#include <cmath>
#include <limits>
#include <string>

namespace wheeltap::emulator {

std::vector<HoldoutError> holdout_error(const RowMatrix& truth, const RowMatrix& predicted) {
  if (truth.rows() != predicted.rows() || truth.cols() != predicted.cols())
    throw std::invalid_argument(
        "truth and prediction differ in shape: " + std::to_string(truth.rows()) + " x " +
        std::to_string(truth.cols()) + " and " + std::to_string(predicted.rows()) + " x " +
        std::to_string(predicted.cols()));
  if (truth.rows() < 2)
    throw std::invalid_argument("holdout error: " + std::to_string(truth.rows()) +
                                " runs, must be at least 2");
  const auto n = static_cast<double>(truth.rows());
  std::vector<HoldoutError> errors;
  for (Eigen::Index k = 0; k < truth.cols(); ++k) {
    const auto y = truth.col(k).array();
    const auto error = predicted.col(k).array() - y;
    const double mean = y.mean();
    HoldoutError e{.rmse = std::sqrt(error.square().sum() / n),
                   .max_error = error.abs().maxCoeff(),
                   .spread = std::sqrt((y - mean).square().sum() / n),
                   .q2 = 0.0};
    const double rounding = 1e-12 * y.abs().maxCoeff();
    if (e.spread > rounding)
      e.q2 = 1.0 - (e.rmse / e.spread) * (e.rmse / e.spread);
    else
      e.q2 = e.rmse <= rounding ? 1.0 : -std::numeric_limits<double>::infinity();
    errors.push_back(e);
  }
  return errors;
}

std::vector<StandardisedResiduals> standardised_residuals(const RowMatrix& truth,
                                                          const RowMatrix& mean,
                                                          const RowMatrix& variance) {
  const auto alike = [&](const RowMatrix& m) {
    return m.rows() == truth.rows() && m.cols() == truth.cols();
  };
  if (truth.rows() < 1 || !alike(mean) || !alike(variance))
    throw std::invalid_argument(
        "standardised residuals: the matrices are empty or have different sizes");
  std::vector<StandardisedResiduals> out;
  for (Eigen::Index k = 0; k < truth.cols(); ++k) {
    double n = 0, sum = 0, squares = 0, beyond = 0;
    for (Eigen::Index i = 0; i < truth.rows(); ++i) {
      const double error = truth(i, k) - mean(i, k);
      if (error == 0.0 && variance(i, k) == 0.0) continue;
      const double z = error / std::sqrt(variance(i, k));
      n += 1;
      sum += z;
      squares += z * z;
      beyond += std::abs(z) > 2.0 ? 1.0 : 0.0;
    }
    if (n == 0)
      out.push_back({.mean = 0.0, .rms = 0.0, .beyond_two = 0.0});
    else
      out.push_back({.mean = sum / n, .rms = std::sqrt(squares / n), .beyond_two = beyond / n});
  }
  return out;
}

RowMatrix predict(const Predictor& predictor, const Design& design, Eigen::Index responses) {
  RowMatrix answers(design.runs(), responses);
  for (Eigen::Index i = 0; i < design.runs(); ++i)
    predictor(design.point(i),
              std::span<double>(answers.row(i).data(), static_cast<std::size_t>(responses)));
  return answers;
}

std::vector<HoldoutError> validate(const std::vector<Factor>& factors, Eigen::Index responses,
                                   const ModelFactory& factory, const Predictor& predictor,
                                   const HoldoutOptions& options) {
  if (options.runs < 2)
    throw std::invalid_argument("holdout runs = " + std::to_string(options.runs) + " must be >= 2");
  const Design points = random_design(factors, options.runs, options.seed);
  return holdout_error(run_experiment(points, responses, factory, options.experiment),
                       predict(predictor, points, responses));
}

}  // namespace wheeltap::emulator
