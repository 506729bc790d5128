#include "identification/structural/likelihood/mode_contributions.hpp"

#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <numbers>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"

namespace wheeltap::identification {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Smallest adequate effective sample size of the reweighted draws.
constexpr double kFewDraws = 50.0;

}  // namespace

VectorXd single_mode_densities(const ModalData& data, const std::vector<int>& with,
                               const MatrixXd& c, const ModalLikelihood::Score& score) {
  const auto n = static_cast<Index>(score.matches.size());
  const auto match = [&](Index i) -> const auto& {
    return score.matches[static_cast<std::size_t>(i)];
  };
  VectorXd out = VectorXd::Zero(n);
  if (data.doubt > 0.0) {
    for (Index i = 0; i < n; ++i) out[i] = match(i).log_likelihood;
    return out;
  }
  if (!with.empty()) {
    const MatrixXd precision = c.inverse();
    VectorXd r(static_cast<Index>(with.size()));
    for (Index k = 0; k < r.size(); ++k) {
      const int i = with[static_cast<std::size_t>(k)];
      r[k] = data.frequencies_hz[static_cast<std::size_t>(i)] - match(i).frequency_hz;
    }
    const VectorXd pull = precision * r;
    for (Index k = 0; k < r.size(); ++k) {
      const double p = precision(k, k);
      out[with[static_cast<std::size_t>(k)]] =
          -0.5 * pull[k] * pull[k] / p + 0.5 * std::log(p / (2.0 * std::numbers::pi));
    }
  }
  for (Index i = 0; i < n; ++i)
    if (match(i).shape) out[i] += match(i).shape->log_density;
  return out;
}

WithoutMode without_mode(std::span<const double> log_density, std::span<const double> weights) {
  const std::size_t draws = log_density.size();
  WithoutMode out{.weights = std::vector<double>(draws)};
  if (draws == 0) return out;
  const double least = *std::ranges::min_element(log_density);
  double all = 0.0, mean = 0.0, sum = 0.0, squares = 0.0;
  for (std::size_t s = 0; s < draws; ++s) {
    const double before = weights.empty() ? 1.0 : weights[s];
    const double after = before * std::exp(least - log_density[s]);
    out.weights[s] = after;
    all += before;
    mean += before * log_density[s];
    sum += after;
    squares += after * after;
  }
  for (double& w : out.weights) w /= sum;
  // E ln p - ln(1 / E (1/p)).
  out.information = std::max(0.0, mean / all - least + std::log(sum / all));
  out.reliable = sum * sum / squares >= kFewDraws;
  return out;
}

double chi_square_tail(double freedoms, double chi_square) {
  return freedoms > 0.0 ? boost::math::gamma_q(0.5 * freedoms, 0.5 * std::max(0.0, chi_square))
                        : 1.0;
}

ShapesBeside shapes_beside(const ModalLikelihood& likelihood,
                           const fem::ParametricModes::Modes& modes,
                           std::span<const ModalLikelihood::Match> matches) {
  const ModalData& data = likelihood.data();
  // There may be more computed modes than measured modes can be matched with.
  const Index compared = likelihood.candidates(static_cast<int>(modes.shapes.cols()));
  const MatrixXd shapes = modes.shapes.leftCols(compared);
  ShapesBeside out{.mac = MatrixXd::Constant(data.modes(), shapes.cols(), kNaN),
                   .computed = MatrixXd::Constant(data.modes(), shapes.rows(), kNaN)};
  for (int i = 0; i < data.modes(); ++i) {
    if (!likelihood.shape(i)) continue;
    std::vector<int> entries;
    for (Index s = 0; s < shapes.rows(); ++s)
      if (!std::isnan(data.shapes(i, s))) entries.push_back(static_cast<int>(s));
    const VectorXd measured = data.shapes.row(i).transpose()(entries);
    for (Index j = 0; j < shapes.cols(); ++j) {
      const VectorXd computed = shapes.col(j)(entries);
      const double along = measured.dot(computed);
      out.mac(i, j) = along * along / (measured.squaredNorm() * computed.squaredNorm());
    }
    const VectorXd matched = shapes.col(matches[static_cast<std::size_t>(i)].computed);
    const VectorXd there = matched(entries);
    const double scale = measured.dot(there) / there.squaredNorm();
    out.computed.row(i) = scale * matched.transpose();
  }
  return out;
}

}  // namespace wheeltap::identification
