#include "emulator/gaussian_process.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/eigen_solvers.hpp"
#include "base/parallel.hpp"

namespace wheeltap::emulator {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Returns the smallest nugget of a kernel. The eigenvalues of the squared exponential kernel
/// decrease fast. With a smaller nugget, large weights of opposite sign would cancel.
double least_nugget(Kernel kernel) {
  return kernel == Kernel::squared_exponential ? 1e-8 : 1e-12;
}
constexpr double kLargestNugget = 1e3;
constexpr double kLadder[] = {0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0};  // initial lengths tried
constexpr double kShortest = 0.005, kLongest = 50.0;  // limits of ℓ, in units of a factor's range
const double kSqrt5 = std::sqrt(5.0);

/// Computes the correlation k(r) from r².
template <class Array>
void correlate(Kernel kernel, Array&& squared) {
  if (kernel == Kernel::squared_exponential) {
    squared = (-0.5 * squared).exp();
  } else {
    const auto r = (kSqrt5 * squared.sqrt()).eval();
    squared = (1.0 + r + (5.0 / 3.0) * squared) * (-r).exp();
  }
}

/// Computes ∂k/∂ ln ℓ_j from r², without the factor ((u_j - u'_j)/ℓ_j)².
ArrayXd slope(Kernel kernel, const ArrayXd& squared) {
  if (kernel == Kernel::squared_exponential) return (-0.5 * squared).exp();
  const ArrayXd r = kSqrt5 * squared.sqrt();
  return (5.0 / 3.0) * (1.0 + r) * (-r).exp();
}

/// Divides points by the correlation lengths, one factor per column.
MatrixXd scaled(const RowMatrix& unit_points, const VectorXd& lengths) {
  return unit_points * lengths.cwiseInverse().asDiagonal();
}

/// Computes r² between point i and the points from row `from` on.
ArrayXd squared_distances(const MatrixXd& z, Index i, Index from) {
  ArrayXd squared = ArrayXd::Zero(z.rows() - from);
  for (Index j = 0; j < z.cols(); ++j)
    squared += (z.col(j).tail(z.rows() - from).array() - z(i, j)).square();
  return squared;
}

/// Computes the lower triangle of R = k(X, X) + η I; the upper triangle is not written.
MatrixXd correlation_matrix(const RowMatrix& unit_points, const Correlation& c) {
  const MatrixXd z = scaled(unit_points, c.lengths);
  MatrixXd r(z.rows(), z.rows());
  for (Index i = 0; i < z.rows(); ++i) {
    ArrayXd column = squared_distances(z, i, i);
    correlate(c.kernel, column);
    r.col(i).tail(z.rows() - i) = column.matrix();
    r(i, i) = 1.0 + c.nugget;
  }
  return r;
}

using Cholesky = Eigen::LLT<MatrixXd, Eigen::Lower>;

/// Mean β, weights α and variance σ² of every column of y for the correlation matrix R.
struct Trend {
  VectorXd w;   // R⁻¹ 1
  double ones;  // 1ᵀ R⁻¹ 1
  Eigen::RowVectorXd mean;
  MatrixXd alpha;  // R⁻¹ (y - β), n × m
  Eigen::RowVectorXd variance;
};

Trend trend(const Cholesky& factor, const RowMatrix& y) {
  Trend t;
  const Index n = y.rows();
  t.w = factor.solve(VectorXd::Ones(n));
  t.ones = t.w.sum();
  t.mean = (t.w.transpose() * y) / t.ones;
  const MatrixXd residual = y.rowwise() - t.mean;
  t.alpha = factor.solve(residual);
  t.variance = residual.cwiseProduct(t.alpha).colwise().sum() / static_cast<double>(n);
  return t;
}

/// Computes the log-likelihood. If `with_gradient` is false, the gradient is 0; the gradient takes
/// most of the run time.
LogLikelihood log_likelihood(const RowMatrix& unit_points, const RowMatrix& values,
                             const Correlation& c, bool with_gradient) {
  const Index n = unit_points.rows(), d = unit_points.cols(), m = values.cols();
  const auto runs = static_cast<double>(n);
  LogLikelihood out{.value = -std::numeric_limits<double>::infinity(),
                    .gradient = VectorXd::Zero(d + 1)};
  const Cholesky factor(correlation_matrix(unit_points, c));
  if (factor.info() != Eigen::Success) return out;
  const Trend t = trend(factor, values);
  if (!(t.variance.minCoeff() > 0.0)) return out;
  const double log_det = 2.0 * factor.matrixLLT().diagonal().array().log().sum();
  if (!std::isfinite(log_det)) return out;
  out.value = -0.5 * (runs * (2.0 * std::numbers::pi * t.variance.array()).log().sum() +
                      static_cast<double>(m) * (log_det + runs));
  if (!with_gradient) return out;

  // W = Σ α αᵀ / σ² - m R⁻¹; the derivative by p is ½ Σ_ab W_ab ∂R_ab/∂p.
  const MatrixXd inverse = factor.solve(MatrixXd::Identity(n, n));
  const MatrixXd weighted = t.alpha * t.variance.cwiseInverse().asDiagonal();
  const MatrixXd w = weighted * t.alpha.transpose() - static_cast<double>(m) * inverse;
  const MatrixXd z = scaled(unit_points, c.lengths);
  for (Index i = 0; i + 1 < n; ++i) {
    const Index below = n - i - 1;
    const ArrayXd common =
        slope(c.kernel, squared_distances(z, i, i + 1)) * w.col(i).tail(below).array();
    for (Index j = 0; j < d; ++j)  // factor 2 · ½, because the matrix is symmetric
      out.gradient(j) += (common * (z.col(j).tail(below).array() - z(i, j)).square()).sum();
  }
  out.gradient(d) = 0.5 * c.nugget * w.trace();
  return out;
}

}  // namespace

LogLikelihood log_marginal_likelihood(const RowMatrix& unit_points, const RowMatrix& values,
                                      const Correlation& correlation) {
  return log_likelihood(unit_points, values, correlation, true);
}

struct GaussianProcess::Impl {
  /// A group of responses with the same correlation lengths.
  struct Group {
    Index first, count;
    Correlation correlation;
    MatrixXd z;  // scaled points
    Cholesky factor;
    Trend fit;
  };

  std::vector<Factor> factors;
  Kernel kernel;
  RowMatrix unit_points;
  RowMatrix values;  // standardised: (value - offset) / size
  Eigen::RowVectorXd offset, size;
  std::vector<double> low, range;  // range of each scale coordinate
  std::vector<Group> groups;

  Impl(std::vector<Factor> f, const RowMatrix& points, const RowMatrix& y, Kernel k)
      : factors(std::move(f)), kernel(k) {
    check_factors(factors);
    if (points.rows() < 2)
      throw std::invalid_argument("Gaussian process: " + std::to_string(points.rows()) +
                                  " runs, must be at least 2");
    if (points.rows() != y.rows() || y.cols() < 1 ||
        points.cols() != static_cast<Index>(factors.size()))
      throw std::invalid_argument(
          "Gaussian process: sizes do not match: points " + std::to_string(points.rows()) + " x " +
          std::to_string(points.cols()) + " and values " + std::to_string(y.rows()) + " x " +
          std::to_string(y.cols()) + " in " + std::to_string(factors.size()) + " factors");
    if (!y.allFinite())
      throw std::invalid_argument("Gaussian process: a value of the runs is not finite");
    for (const Factor& factor : factors) {
      low.push_back(to_scale(factor.scale, factor.low()));
      range.push_back(to_scale(factor.scale, factor.high()) - low.back());
    }
    unit_points.resize(points.rows(), points.cols());
    for (Index i = 0; i < points.rows(); ++i) {
      const std::span<const double> x(points.row(i).data(), factors.size());
      try {
        require_inside(factors, x);
      } catch (const std::out_of_range& error) {
        throw std::invalid_argument("run " + std::to_string(i) + ": " + error.what());
      }
      to_unit(x, unit_points.row(i).data());
    }
    offset = y.colwise().mean();
    values = y.rowwise() - offset;
    size = values.colwise().norm() / std::sqrt(static_cast<double>(y.rows()));
    // A response that is constant to rounding gets the variance 0.
    for (Index k_response = 0; k_response < size.size(); ++k_response)
      if (!(size(k_response) > 1e-14 * std::abs(offset(k_response)))) {
        size(k_response) = 0.0;
        values.col(k_response).setZero();
      } else {
        values.col(k_response) /= size(k_response);
      }
  }

  void to_unit(std::span<const double> x, double* u) const {
    for (std::size_t j = 0; j < x.size(); ++j)
      u[j] = (to_scale(factors[j].scale, x[j]) - low[j]) / range[j];
  }

  /// Conditions the responses [first, first + count) on all runs, with the nugget increased until R
  /// is numerically positive definite.
  [[nodiscard]] Group condition(Index first, Index count, Correlation correlation) const {
    Group g{.first = first,
            .count = count,
            .correlation = std::move(correlation),
            .z = {},
            .factor = {},
            .fit = {}};
    double& nugget = g.correlation.nugget;
    for (nugget = std::max(nugget, least_nugget(g.correlation.kernel));; nugget *= 10.0) {
      g.factor.compute(correlation_matrix(unit_points, g.correlation));
      if (g.factor.info() == Eigen::Success) break;
      if (nugget > kLargestNugget)
        throw std::invalid_argument(
            "Gaussian process: no nugget makes the correlation matrix positive definite");
    }
    g.z = scaled(unit_points, g.correlation.lengths);
    g.fit = trend(g.factor, values.middleCols(first, count));
    return g;
  }
};

namespace {

/// Maximises ln L over ln ℓ (and ln η) inside a box by BFGS. Steps are projected onto the box, and
/// halved until ln L increases sufficiently (Nocedal & Wright 2006, Numerical Optimization, chapter
/// 6). Eigen has no optimiser for scalar functions, and d + 1 unknowns do not justify a dependency.
class Search {
 public:
  Search(const RowMatrix& points, const RowMatrix& values, const GaussianProcessOptions& options)
      : points_(points), values_(values), options_(options) {
    const Index d = points.cols();
    unknowns_ = d + (options.infer_nugget ? 1 : 0);
    low_ = VectorXd::Constant(unknowns_, std::log(kShortest));
    high_ = VectorXd::Constant(unknowns_, std::log(kLongest));
    if (options.infer_nugget) {
      low_(d) = std::log(least_nugget(options.kernel));
      high_(d) = std::log(kLargestNugget);
    }
  }

  Correlation run() {
    VectorXd best;
    double best_value = -std::numeric_limits<double>::infinity();
    const auto consider = [&](const VectorXd& p) {
      const double v = value(p, false).f;
      if (v > best_value) {
        best = p;
        best_value = v;
      }
    };
    const std::vector<double> nuggets =
        options_.infer_nugget ? std::vector{1e-6, 1e-3, 0.1} : std::vector{nugget_};
    // Runs close to each other may need a larger nugget at all correlation lengths.
    for (; nugget_ < kLargestNugget; nugget_ *= 10.0) {
      for (double length : kLadder)
        for (double nugget : nuggets) {
          VectorXd p = VectorXd::Constant(unknowns_, std::log(length));
          if (options_.infer_nugget) p(unknowns_ - 1) = std::log(std::max(nugget, nugget_));
          consider(p);
        }
      if (best.size() > 0) break;
    }
    if (best.size() == 0) return correlation(VectorXd::Zero(unknowns_));
    // Then varies each length separately. A response may oscillate along one factor and vary little
    // along another factor; the likelihood has a local maximum for each number of waves.
    for (bool moved = true; std::exchange(moved, false);)
      for (Index j = 0; j < points_.cols(); ++j) {
        const double before = best_value;
        VectorXd p = best;
        for (double length : kLadder) {
          p(j) = std::log(length);
          consider(p);
        }
        moved = moved || best_value > before + 1.0;
      }
    Value at = value(best, true);
    climb(best, at);
    return correlation(best);
  }

 private:
  struct Value {
    double f = -std::numeric_limits<double>::infinity();
    VectorXd gradient;
  };

  [[nodiscard]] Correlation correlation(const VectorXd& p) const {
    return {.kernel = options_.kernel,
            .lengths = p.head(points_.cols()).array().exp().matrix(),
            .nugget = options_.infer_nugget ? std::exp(p(unknowns_ - 1)) : nugget_};
  }

  [[nodiscard]] Value value(const VectorXd& p, bool with_gradient) const {
    const LogLikelihood l = log_likelihood(points_, values_, correlation(p), with_gradient);
    return {l.value, l.gradient.head(unknowns_)};
  }

  void climb(VectorXd& p, Value& at) const {
    MatrixXd h = MatrixXd::Identity(unknowns_, unknowns_);  // inverse Hessian of -ln L
    bool fresh = true;
    for (int iteration = 0; iteration < options_.most_iterations; ++iteration) {
      // An unknown at a bound stays there in this step if its gradient points outwards.
      VectorXd gradient = at.gradient;
      for (Index j = 0; j < unknowns_; ++j)
        if ((p(j) <= low_(j) && gradient(j) < 0) || (p(j) >= high_(j) && gradient(j) > 0))
          gradient(j) = 0.0;
      if (gradient.norm() < 1e-3) return;
      VectorXd direction = h * gradient;
      for (Index j = 0; j < unknowns_; ++j)
        if (gradient(j) == 0.0) direction(j) = 0.0;
      if (direction.dot(gradient) <= 0.0) {
        h.setIdentity();
        fresh = true;
        direction = gradient;
      }
      if (fresh) direction /= std::max(1.0, direction.norm());
      direction *= std::min(1.0, 2.0 / direction.cwiseAbs().maxCoeff());  // a factor of at most e²

      VectorXd next;
      Value there;
      double step = 1.0;
      for (; step > 1e-4; step *= 0.5) {
        next = (p + step * direction).cwiseMax(low_).cwiseMin(high_);
        there = value(next, true);
        if (there.f >= at.f + 1e-4 * gradient.dot(next - p) && there.f > at.f) break;
      }
      if (step <= 1e-4) {
        if (fresh) return;
        h.setIdentity();
        fresh = true;
        continue;
      }
      const VectorXd s = next - p;
      const VectorXd y = at.gradient - there.gradient;  // of -ln L
      if (const double sy = s.dot(y); sy > 1e-10 * s.norm() * y.norm()) {
        if (fresh) h = MatrixXd::Identity(unknowns_, unknowns_) * (sy / y.squaredNorm());
        const MatrixXd left = MatrixXd::Identity(unknowns_, unknowns_) - s * y.transpose() / sy;
        h = left * h * left.transpose() + s * s.transpose() / sy;
        fresh = false;
      }
      const double gain = there.f - at.f;
      p = next;
      at = there;
      if (gain < 1e-6) return;
    }
  }

  const RowMatrix& points_;
  const RowMatrix& values_;
  const GaussianProcessOptions& options_;
  Index unknowns_;
  VectorXd low_, high_;
  double nugget_ = least_nugget(options_.kernel);
};

/// The rows of m used in a fit.
RowMatrix fitted_rows(const RowMatrix& m, const std::vector<Index>& rows) {
  return m(rows, Eigen::all);
}

}  // namespace

GaussianProcess::GaussianProcess(std::vector<Factor> factors, const RowMatrix& points,
                                 const RowMatrix& values, const GaussianProcessOptions& options) {
  if (options.most_fitted_runs < 2 || options.most_iterations < 0 || options.threads < 1)
    throw std::invalid_argument(
        "Gaussian process options: most_fitted_runs >= 2, most_iterations >= 0 and threads >= 1 "
        "are needed");
  auto impl = std::make_unique<Impl>(std::move(factors), points, values, options.kernel);
  std::vector<Index> rows(static_cast<std::size_t>(points.rows()));
  std::iota(rows.begin(), rows.end(), Index{0});
  if (points.rows() > options.most_fitted_runs) {
    std::mt19937_64 generator(options.seed);
    for (std::size_t i = rows.size() - 1; i > 0; --i)
      std::swap(rows[i], rows[generator() % (i + 1)]);
    rows.resize(static_cast<std::size_t>(options.most_fitted_runs));
  }
  const RowMatrix fitted_points = fitted_rows(impl->unit_points, rows);
  const Index responses = values.cols();
  const Index groups = options.shared_lengths ? 1 : responses;
  const Index per_group = responses / groups;
  impl->groups.resize(static_cast<std::size_t>(groups));

  base::parallel_for(static_cast<int>(groups), options.threads, [&](Index g) {
    // Constant responses contain no information on lengths.
    std::vector<Index> varying;
    for (Index k = g * per_group; k < (g + 1) * per_group; ++k)
      if (impl->values(rows, k).squaredNorm() > 0.0) varying.push_back(k);
    Correlation correlation{.kernel = options.kernel,
                            .lengths = VectorXd::Ones(points.cols()),
                            .nugget = least_nugget(options.kernel)};
    if (!varying.empty()) {
      const RowMatrix fitted_values = impl->values(rows, varying);
      correlation = Search(fitted_points, fitted_values, options).run();
    }
    impl->groups[static_cast<std::size_t>(g)] =
        impl->condition(g * per_group, per_group, std::move(correlation));
  });
  impl_ = std::move(impl);
}

GaussianProcess::GaussianProcess(std::vector<Factor> factors, const RowMatrix& points,
                                 const RowMatrix& values, Kernel kernel,
                                 const RowMatrix& parameters) {
  auto impl = std::make_unique<Impl>(std::move(factors), points, values, kernel);
  const Index d = points.cols();
  if ((parameters.rows() != 1 && parameters.rows() != values.cols()) ||
      parameters.cols() != d + 1 || !(parameters.array() > 0.0).all() || !parameters.allFinite())
    throw std::invalid_argument("Gaussian process parameters: 1 or " +
                                std::to_string(values.cols()) + " rows of " +
                                std::to_string(d + 1) + " positive numbers are needed");
  const Index per_group = values.cols() / parameters.rows();
  for (Index g = 0; g < parameters.rows(); ++g)
    impl->groups.push_back(impl->condition(g * per_group, per_group,
                                           {.kernel = kernel,
                                            .lengths = parameters.row(g).head(d).transpose(),
                                            .nugget = parameters(g, d)}));
  impl_ = std::move(impl);
}

GaussianProcess::~GaussianProcess() = default;
GaussianProcess::GaussianProcess(GaussianProcess&&) noexcept = default;
GaussianProcess& GaussianProcess::operator=(GaussianProcess&&) noexcept = default;

void GaussianProcess::evaluate(std::span<const double> x, std::span<double> mean) const {
  evaluate(x, mean, {});
}

void GaussianProcess::evaluate(std::span<const double> x, std::span<double> mean,
                               std::span<double> variance) const {
  require_inside(impl_->factors, x);
  if (mean.size() != static_cast<std::size_t>(responses()) ||
      (!variance.empty() && variance.size() != mean.size()))
    throw std::invalid_argument("output arrays have " + std::to_string(mean.size()) +
                                " means and " + std::to_string(variance.size()) +
                                " variances for " + std::to_string(responses()) + " responses");
  thread_local std::vector<double> u;
  thread_local ArrayXd r;
  thread_local VectorXd half;
  u.resize(x.size());
  impl_->to_unit(x, u.data());
  for (const Impl::Group& g : impl_->groups) {
    r.setZero(g.z.rows());
    for (Index j = 0; j < g.z.cols(); ++j)
      r +=
          (g.z.col(j).array() - u[static_cast<std::size_t>(j)] / g.correlation.lengths(j)).square();
    correlate(g.correlation.kernel, r);
    double share = 0.0;
    if (!variance.empty()) {
      half = g.factor.matrixL().solve(r.matrix());
      const double unexplained = 1.0 - g.fit.w.dot(r.matrix());
      share = std::max(0.0, 1.0 - half.squaredNorm() + unexplained * unexplained / g.fit.ones);
    }
    for (Index k = 0; k < g.count; ++k) {
      const Index response = g.first + k;
      const double size = impl_->size(response);
      mean[static_cast<std::size_t>(response)] =
          impl_->offset(response) + size * (g.fit.mean(k) + g.fit.alpha.col(k).dot(r.matrix()));
      if (!variance.empty())
        variance[static_cast<std::size_t>(response)] = size * size * g.fit.variance(k) * share;
    }
  }
}

LeaveOneOut GaussianProcess::leave_one_out() const {
  const Index n = impl_->values.rows();
  LeaveOneOut out{.mean = RowMatrix(n, responses()), .variance = RowMatrix(n, responses())};
  for (const Impl::Group& g : impl_->groups) {
    const VectorXd q =
        g.factor.solve(MatrixXd::Identity(n, n)).diagonal() - g.fit.w.cwiseAbs2() / g.fit.ones;
    for (Index k = 0; k < g.count; ++k) {
      const Index response = g.first + k;
      const double size = impl_->size(response);
      // Q y = R⁻¹ (y - β), because β is fitted to y.
      const VectorXd residual = g.fit.alpha.col(k).cwiseQuotient(q);
      out.mean.col(response) =
          (impl_->offset(response) + size * (impl_->values.col(response) - residual).array())
              .matrix();
      out.variance.col(response) = size * size * g.fit.variance(k) * q.cwiseInverse();
    }
  }
  return out;
}

RowMatrix GaussianProcess::parameters() const {
  const auto d = static_cast<Index>(impl_->factors.size());
  RowMatrix out(static_cast<Index>(impl_->groups.size()), d + 1);
  Index row = 0;
  for (const Impl::Group& g : impl_->groups) {
    out.row(row).head(d) = g.correlation.lengths.transpose();
    out(row++, d) = g.correlation.nugget;
  }
  return out;
}

Kernel GaussianProcess::kernel() const {
  return impl_->kernel;
}
const std::vector<Factor>& GaussianProcess::factors() const {
  return impl_->factors;
}
Eigen::Index GaussianProcess::responses() const {
  return impl_->values.cols();
}

constinit const InterpolantType kGaussianProcess = {
    .name = "gaussian-process",
    .words = "Gaussian process",
    .runs = InterpolantType::Runs::scattered,
    .slow = true,
    .has_variance = true,
    .train = [](Table& table,
                const TrainingOptions& options) -> std::unique_ptr<const Interpolant> {
      const auto fitted = table.parameters.find("gaussian_process");
      if (fitted != table.parameters.end()) {
        return std::make_unique<GaussianProcess>(table.factors, table.points, table.values,
                                                 Kernel::matern52, fitted->second);
      }
      auto made =
          std::make_unique<GaussianProcess>(table.factors, table.points, table.values,
                                            GaussianProcessOptions{.threads = options.threads});
      table.parameters["gaussian_process"] = made->parameters();
      return made;
    }};

}  // namespace wheeltap::emulator
