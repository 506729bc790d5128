#include "identification/structural/likelihood/shape_density.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "base/log_gamma.hpp"

namespace wheeltap::identification {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Replaces an sd of 0, as a fraction of the smallest other sd: small enough to fix the scale of
/// the shape, large enough for double precision.
constexpr double kTied = 1e-3;

/// ln of the normal density with variance v, wrapped with period π, at α in (-π/2, π/2].
double log_wrapped_normal(double alpha, double v) {
  // Above this v, the density is uniform up to rounding: its first Fourier term is 2 exp(-2 v).
  constexpr double kUniform = 20.0;
  if (v > kUniform) return -std::log(kPi);
  const int reach = 1 + static_cast<int>(6.0 * std::sqrt(v) / kPi);
  double sum = 0.0;
  for (int k = -reach; k <= reach; ++k) {
    const double a = alpha + k * kPi;
    sum += std::exp(-0.5 * (a * a - alpha * alpha) / v);
  }
  return -0.5 * alpha * alpha / v + std::log(sum) - 0.5 * std::log(2.0 * kPi * v);
}

double mac_of(const VectorXd& a, const VectorXd& b) {
  const double along = a.dot(b), both = a.squaredNorm() * b.squaredNorm();
  return both > 0.0 ? along * along / both : 0.0;
}

}  // namespace

ShapeDensity::ShapeDensity(VectorXd values, const MatrixXd& covariance)
    : values_(std::move(values)) {
  const auto refuse = [](const std::string& message) { throw std::invalid_argument(message); };
  const Index m = values_.size();
  if (m < 2) refuse("a shape needs at least 2 entries, has " + std::to_string(m));
  if (!values_.allFinite()) refuse("a shape's entries must be finite");
  const double largest = values_.cwiseAbs().maxCoeff();
  if (!(largest > 0.0)) refuse("a shape must have an entry other than 0");
  values_ /= largest;
  if (covariance.rows() != m || covariance.cols() != m)
    refuse("the covariance is " + std::to_string(covariance.rows()) + " x " +
           std::to_string(covariance.cols()) + ": must be " + std::to_string(m) + " x " +
           std::to_string(m) + ", by the number of shape entries");
  if (!covariance.allFinite()) refuse("the covariance's entries must be finite");
  if ((covariance - covariance.transpose()).cwiseAbs().maxCoeff() >
      1e-8 * covariance.cwiseAbs().maxCoeff())
    refuse("the covariance must be symmetric");
  MatrixXd sigma = 0.5 * (covariance + covariance.transpose());
  Index tied = -1;
  double smallest = 0.0;
  for (Index i = 0; i < m; ++i) {
    const double variance = sigma(i, i);
    if (variance < 0.0) refuse("the covariance must be positive definite");
    if (variance == 0.0) {
      if (tied >= 0 || sigma.row(i).cwiseAbs().maxCoeff() > 0.0)
        refuse(
            "the covariance must be positive definite apart from one row and column of zeros (the "
            "entry by which the shape was scaled)");
      tied = i;
    } else if (smallest == 0.0 || variance < smallest) {
      smallest = variance;
    }
  }
  if (tied >= 0) sigma(tied, tied) = kTied * kTied * smallest;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(sigma);
  axes_ = solver.eigenvectors();
  spread_ = solver.eigenvalues();
  if (!(spread_[0] > 1e-14 * spread_[m - 1])) refuse("the covariance must be positive definite");
  in_axes_ = axes_.transpose() * values_;
}

VectorXd ShapeDensity::weights(double scale, double more) const {
  return (scale * spread_.array() + more).sqrt().inverse().matrix();
}

double ShapeDensity::log_normaliser(const VectorXd& w) const {
  // |Σ|^{-1/2} is the product of the weights.
  const double along = w.cwiseProduct(in_axes_).squaredNorm() / values_.squaredNorm();
  return w.array().log().sum() - 0.5 * std::log(along) -
         0.5 * static_cast<double>(freedoms()) * std::log(2.0 * kPi);
}

double ShapeDensity::log_uniform_density() const {
  const double m = static_cast<double>(values_.size());
  return base::log_gamma(0.5 * m) - 0.5 * m * std::log(kPi) -
         0.5 * (m - 1.0) * std::log(values_.squaredNorm());
}

double ShapeDensity::sd() const {
  return std::sqrt(spread_.mean());
}

ShapeDensity::Comparison ShapeDensity::against(const VectorXd& shape, double scale,
                                               double more) const {
  const VectorXd w = weights(scale, more);
  return fitted(shape, w.cwiseProduct(in_axes_), w.cwiseProduct(axes_.transpose() * shape),
                log_normaliser(w));
}

ShapeDensity::Comparison ShapeDensity::against(const VectorXd& shape, const Mixing& mixing,
                                               double scale, double more) const {
  VectorXd residual;
  MatrixXd moves;
  return against(shape, mixing, scale, more, MatrixXd(shape.size(), 0), residual, moves);
}

ShapeDensity::Comparison ShapeDensity::against(const VectorXd& shape, const Mixing& mixing,
                                               double scale, double more, const MatrixXd& moved,
                                               VectorXd& residual, MatrixXd& moves) const {
  const double size = shape.squaredNorm();
  const double amplitude = size > 0.0 ? shape.dot(values_) / size : 0.0;
  const MatrixXd mixed = axes_.transpose() * mixing.others * (amplitude * mixing.tau).asDiagonal();
  MatrixXd sigma = mixed * mixed.transpose();
  sigma.diagonal().array() += scale * spread_.array() + more;
  const Eigen::LLT<MatrixXd> llt(sigma);
  const VectorXd measured = llt.matrixL().solve(in_axes_);
  const VectorXd computed = llt.matrixL().solve(axes_.transpose() * shape);
  const double log_normaliser = -llt.matrixLLT().diagonal().array().log().sum() -
                                0.5 * std::log(measured.squaredNorm() / values_.squaredNorm()) -
                                0.5 * static_cast<double>(freedoms()) * std::log(2.0 * kPi);
  if (moved.cols() > 0) {
    const double whitened = computed.squaredNorm();
    const double a = whitened > 0.0 ? measured.dot(computed) / whitened : 0.0;
    residual = measured - a * computed;
    moves = a * llt.matrixL().solve(axes_.transpose() * moved);
    if (whitened > 0.0) moves -= computed * (computed.transpose() * moves / whitened);
  }
  return fitted(shape, measured, computed, log_normaliser);
}

ShapeDensity::Comparison ShapeDensity::fitted(const VectorXd& shape, const VectorXd& measured,
                                              const VectorXd& computed,
                                              double log_normaliser) const {
  const double size = computed.squaredNorm();
  Comparison out;
  // A mode without motion at the sensors explains no part of the shape.
  out.chi_square = size > 0.0 ? (measured - measured.dot(computed) / size * computed).squaredNorm()
                              : measured.squaredNorm();
  out.log_density = log_normaliser - 0.5 * out.chi_square;
  out.mac = mac_of(values_, shape);
  return out;
}

ShapeDensity::Comparison ShapeDensity::against(const VectorXd& shape, const VectorXd& close,
                                               double tau, double scale, double more) const {
  const VectorXd w = weights(scale, more);
  const VectorXd measured = w.cwiseProduct(in_axes_);
  const VectorXd first = w.cwiseProduct(axes_.transpose() * shape);
  const VectorXd second = w.cwiseProduct(axes_.transpose() * close);
  const double size = first.squaredNorm();
  const VectorXd across = size > 0.0 ? second - first.dot(second) / size * first : second;
  // A rotation has no effect if both modes have the same motion at the sensors.
  if (!(size > 0.0) || !(across.squaredNorm() > 1e-12 * second.squaredNorm()))
    return against(shape, scale, more);
  const double by_close = measured.dot(across) / across.squaredNorm();
  const double by_first = measured.dot(first) / size - by_close * first.dot(second) / size;
  const double amplitude = std::hypot(by_first, by_close);
  Comparison out;
  // The angle has period π; it is 0 if neither mode fits the shape.
  out.turn = by_first != 0.0 ? std::atan(by_close / by_first) : by_close != 0.0 ? 0.5 * kPi : 0.0;
  out.chi_square = (measured - by_first * first - by_close * second).squaredNorm();
  // The part of the fit's change with the angle that is orthogonal to the fit.
  const VectorXd fit = std::cos(out.turn) * first + std::sin(out.turn) * second;
  VectorXd moves = std::cos(out.turn) * second - std::sin(out.turn) * first;
  moves -= moves.dot(fit) / fit.squaredNorm() * fit;
  // The mean of exp(-(α - α̂)²/2s²) over the angles: at most 1. It is 1 if the noise exceeds the
  // shape, so that all angles fit equally well.
  const double s = 1.0 / (amplitude * moves.norm());
  const double mean =
      0.5 * std::log(2.0 * kPi) + std::log(s) + log_wrapped_normal(out.turn, tau * tau + s * s);
  out.log_density = log_normaliser(w) - 0.5 * out.chi_square + std::min(mean, 0.0);
  out.mac = mac_of(values_, std::cos(out.turn) * shape + std::sin(out.turn) * close);
  return out;
}

// With a = w·v/|v|²: ∂(-χ²/2)/∂v = a (w - a v).
VectorXd ShapeDensity::slope(const VectorXd& shape, double scale, double more) const {
  const VectorXd w = weights(scale, more);
  const VectorXd measured = w.cwiseProduct(in_axes_);
  const VectorXd computed = w.cwiseProduct(axes_.transpose() * shape);
  const double size = computed.squaredNorm();
  if (!(size > 0.0)) return VectorXd::Zero(shape.size());
  const double a = measured.dot(computed) / size;
  return axes_ * w.cwiseProduct(a * (measured - a * computed));
}

}  // namespace wheeltap::identification
