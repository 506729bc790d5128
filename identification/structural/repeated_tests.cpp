#include "identification/structural/repeated_tests.hpp"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <map>
#include <numeric>
#include <stdexcept>
#include <string>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "base/log_gamma.hpp"
#include "base/random.hpp"

namespace wheeltap::identification {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kUpperSigma = 0.8413447460685429;  // Φ(1)

/// Location and scale of the known numbers of a column.
struct Spread {
  double centre = 0.0, scale = 0.0;
};

double sample_median(std::vector<double> values) {
  const std::size_t half = values.size() / 2;
  std::ranges::sort(values);
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

/// Median and 1.4826 times the median absolute deviation. If more than half of the values are equal
/// (rounded frequencies), the scale is 1.2533 times the mean absolute deviation.
Spread spread_of(const std::vector<double>& values) {
  Spread out{.centre = sample_median(values), .scale = 0.0};
  std::vector<double> distances;
  for (const double x : values) distances.push_back(std::abs(x - out.centre));
  out.scale = 1.4826 * sample_median(distances);
  if (out.scale > 0.0) return out;
  out.scale = 1.2533 * std::accumulate(distances.begin(), distances.end(), 0.0) /
              static_cast<double>(distances.size());
  return out;
}

/// The tests in which the same modes were identified.
struct Pattern {
  std::vector<Index> known, missing;  // modes
  std::vector<Index> rows;
};

/// Gibbs sampler in the coordinates z_j = (ln f_j - centre_j) / s_j, in which the scale matrix of
/// the prior is the identity.
class Sampler {
 public:
  Sampler(MatrixXd z, const RepeatedTestsOptions& options)
      : z_(std::move(z)),
        options_(options),
        mean_(VectorXd::Zero(z_.cols())),
        covariance_(MatrixXd::Identity(z_.cols(), z_.cols())),
        weights_(VectorXd::Ones(z_.rows())),
        mean_weights_(VectorXd::Ones(z_.rows())) {
    std::map<std::vector<bool>, Pattern> patterns;
    for (Index t = 0; t < z_.rows(); ++t) {
      std::vector<bool> known;
      for (Index j = 0; j < z_.cols(); ++j) known.push_back(!std::isnan(z_(t, j)));
      patterns[known].rows.push_back(t);
    }
    for (auto& [known, pattern] : patterns) {
      for (std::size_t j = 0; j < known.size(); ++j)
        (known[j] ? pattern.known : pattern.missing).push_back(static_cast<Index>(j));
      patterns_.push_back(std::move(pattern));
    }
    probabilities_.resize(options.degrees_of_freedom.size());
  }

  /// One iteration: (ν, weights, missing entries) given (μ, Σ), then (μ, Σ) given these.
  void step(int iteration) {
    base::Random random(options_.seed, 0, static_cast<std::uint64_t>(iteration),
                        base::Purpose::sampling);
    distances();
    draw_degrees_of_freedom(random);
    for (std::size_t k = 0; k < patterns_.size(); ++k) complete(k, random);
    draw_mean_and_covariance(random);
  }

  /// Mean and covariance of μ given ν, the weights and the missing entries.
  [[nodiscard]] const VectorXd& conditional_mean() const { return conditional_mean_; }
  [[nodiscard]] const MatrixXd& conditional_covariance() const { return conditional_covariance_; }
  [[nodiscard]] const MatrixXd& covariance() const { return covariance_; }
  [[nodiscard]] std::size_t degrees_of_freedom() const { return nu_; }
  /// Probability of each ν given (μ, Σ) of the previous iteration.
  [[nodiscard]] const std::vector<double>& probabilities() const { return probabilities_; }
  /// Expected weight of each test given ν, and (μ, Σ) of the previous iteration.
  [[nodiscard]] const VectorXd& mean_weights() const { return mean_weights_; }

 private:
  /// Squared Mahalanobis distances of the known entries.
  void distances() {
    squares_.clear();
    factors_.clear();
    for (const Pattern& pattern : patterns_) {
      factors_.emplace_back(covariance_(pattern.known, pattern.known));
      const MatrixXd residuals =
          z_(pattern.rows, pattern.known).transpose().colwise() - VectorXd(mean_(pattern.known));
      squares_.push_back(
          factors_.back().matrixL().solve(residuals).colwise().squaredNorm().transpose());
    }
  }

  /// p(ν | μ, Σ, known entries) ∝ Π_t Γ((ν + q)/2) / Γ(ν/2) · (2/ν)^{q/2} · (1 + d_t²/ν)^{-(ν +
  /// q)/2} with q known entries in test t; exp(-d_t²/2) for ν = ∞.
  void draw_degrees_of_freedom(base::Random& random) {
    const std::vector<double>& list = options_.degrees_of_freedom;
    std::vector<double> logs(list.size(), 0.0);
    for (std::size_t n = 0; n < list.size(); ++n) {
      const double nu = list[n];
      for (std::size_t k = 0; k < patterns_.size(); ++k) {
        const auto q = static_cast<double>(patterns_[k].known.size());
        if (std::isinf(nu)) {
          logs[n] -= 0.5 * squares_[k].sum();
          continue;
        }
        logs[n] += static_cast<double>(squares_[k].size()) *
                   (base::log_gamma(0.5 * (nu + q)) - base::log_gamma(0.5 * nu) +
                    0.5 * q * std::log(2.0 / nu));
        logs[n] -= 0.5 * (nu + q) * (squares_[k].array() / nu).log1p().sum();
      }
    }
    const double most = *std::ranges::max_element(logs);
    double sum = 0.0;
    for (std::size_t n = 0; n < list.size(); ++n)
      sum += probabilities_[n] = std::exp(logs[n] - most);
    for (double& p : probabilities_) p /= sum;
    double left = random.uniform();
    nu_ = 0;
    while (nu_ + 1 < list.size() && (left -= probabilities_[nu_]) > 0.0) ++nu_;
  }

  /// Draws the weights w ~ Gamma((ν + q)/2, rate (ν + d²)/2) of a pattern's tests, and their
  /// missing entries from the normal distribution given the known entries.
  void complete(std::size_t k, base::Random& random) {
    const Pattern& pattern = patterns_[k];
    const double nu = options_.degrees_of_freedom[nu_];
    const auto q = static_cast<double>(pattern.known.size());
    for (std::size_t r = 0; r < pattern.rows.size(); ++r) {
      const Index t = pattern.rows[r];
      const double rate = nu + squares_[k][static_cast<Index>(r)];
      mean_weights_[t] = std::isinf(nu) ? 1.0 : (nu + q) / rate;
      weights_[t] = std::isinf(nu) ? 1.0 : 2.0 * random.gamma(0.5 * (nu + q)) / rate;
    }
    if (pattern.missing.empty()) return;
    const MatrixXd gain =
        factors_[k].solve(covariance_(pattern.known, pattern.missing)).transpose();
    MatrixXd rest = covariance_(pattern.missing, pattern.missing) -
                    gain * covariance_(pattern.known, pattern.missing);
    const Eigen::LLT<MatrixXd> factor(rest);
    for (const Index t : pattern.rows) {
      VectorXd noise(static_cast<Index>(pattern.missing.size()));
      for (double& x : noise) x = random.normal();
      const VectorXd known = z_.row(t)(pattern.known).transpose() - VectorXd(mean_(pattern.known));
      z_.row(t)(pattern.missing) = (mean_(pattern.missing) + gain * known +
                                    factor.matrixL() * noise / std::sqrt(weights_[t]))
                                       .transpose();
    }
  }

  /// Σ ~ inverse Wishart(p + N - 1, 1 + S), μ | Σ ~ N(weighted mean, Σ / Σ_t w_t), with S the
  /// weighted sum of squares. Σ⁻¹ by the decomposition of Bartlett.
  void draw_mean_and_covariance(base::Random& random) {
    const Index p = z_.cols(), n = z_.rows();
    const double total = weights_.sum();
    conditional_mean_ = z_.transpose() * weights_ / total;
    const MatrixXd centred = z_.rowwise() - conditional_mean_.transpose();
    MatrixXd scale = MatrixXd::Identity(p, p);
    scale.noalias() += centred.transpose() * weights_.asDiagonal() * centred;
    const Index freedoms = p + n - 1;
    conditional_covariance_ = scale / (total * static_cast<double>(freedoms - p - 1));
    MatrixXd a = MatrixXd::Zero(p, p);
    for (Index i = 0; i < p; ++i) {
      a(i, i) = std::sqrt(2.0 * random.gamma(0.5 * static_cast<double>(freedoms - i)));
      for (Index j = 0; j < i; ++j) a(i, j) = random.normal();
    }
    const MatrixXd lower = scale.llt().matrixL();
    // Σ = B Bᵀ with B = L A⁻ᵀ: Bᵀ = A⁻¹ Lᵀ
    const MatrixXd half = a.triangularView<Eigen::Lower>().solve(lower.transpose()).transpose();
    covariance_.noalias() = half * half.transpose();
    VectorXd noise(p);
    for (double& x : noise) x = random.normal();
    mean_ = conditional_mean_ + half * noise / std::sqrt(total);
  }

  MatrixXd z_;
  const RepeatedTestsOptions& options_;
  std::vector<Pattern> patterns_;
  VectorXd mean_;
  MatrixXd covariance_;
  VectorXd weights_, mean_weights_;
  std::vector<Eigen::LLT<MatrixXd>> factors_;
  std::vector<VectorXd> squares_;
  std::size_t nu_ = 0;
  std::vector<double> probabilities_;
  VectorXd conditional_mean_;
  MatrixXd conditional_covariance_;
};

/// Mean of draws and their covariance, updated draw by draw (Welford 1962).
class Moments {
 public:
  explicit Moments(Index size)
      : mean_(VectorXd::Zero(size)), squares_(MatrixXd::Zero(size, size)) {}
  void add(const VectorXd& x) {
    ++count_;
    const VectorXd before = x - mean_;
    mean_ += before / count_;
    squares_ += before * (x - mean_).transpose();
  }
  [[nodiscard]] const VectorXd& mean() const { return mean_; }
  [[nodiscard]] MatrixXd covariance() const { return squares_ / count_; }

 private:
  double count_ = 0.0;
  VectorXd mean_;
  MatrixXd squares_;
};

/// Correlation of consecutive tests of one mode; residuals are NaN if missing. The estimate is
/// corrected for the bias of the known mean, E[r] = ρ - (1 + 4ρ)/N (Kendall 1954, Biometrika
/// 41:403).
struct Serial {
  double correlation = 0.0, inflation = 1.0;
};

Serial serial_of(const VectorXd& residuals) {
  double product = 0.0, first = 0.0, second = 0.0, pairs = 0.0, count = 0.0;
  for (Index t = 0; t < residuals.size(); ++t) {
    if (std::isnan(residuals[t])) continue;
    ++count;
    if (t + 1 == residuals.size() || std::isnan(residuals[t + 1])) continue;
    ++pairs;
    product += residuals[t] * residuals[t + 1];
    first += residuals[t] * residuals[t];
    second += residuals[t + 1] * residuals[t + 1];
  }
  Serial out;
  if (pairs < 8 || !(first > 0.0) || !(second > 0.0)) return out;
  const double r = product / std::sqrt(first * second);
  out.correlation = std::clamp(r + (1.0 + 4.0 * r) / count, -1.0, 1.0);
  if (r + 1.0 / count < kSerialLevel / std::sqrt(pairs)) return out;
  out.inflation = out.correlation < 1.0
                      ? std::min(count, (1.0 + out.correlation) / (1.0 - out.correlation))
                      : count;
  return out;
}

/// Modes that at least one test identified. Throws std::invalid_argument.
std::vector<Index> identified_modes(const MatrixXd& frequencies_hz, std::vector<int>& counts) {
  std::vector<Index> out;
  for (Index j = 0; j < frequencies_hz.cols(); ++j) {
    const std::string mode = "mode " + std::to_string(j + 1);
    int count = 0;
    double low = kInfinity, high = 0.0;
    for (const double f : frequencies_hz.col(j)) {
      if (std::isnan(f)) continue;
      if (!(f > 0.0) || std::isinf(f))
        throw std::invalid_argument(mode + ": frequencies must be > 0");
      ++count;
      low = std::min(low, f);
      high = std::max(high, f);
    }
    counts.push_back(count);
    if (count == 0) continue;
    if (count < kLeastTests)
      throw std::invalid_argument(
          mode + " was identified in " + std::to_string(count) + (count == 1 ? " test" : " tests") +
          ": the scatter between tests needs at least " + std::to_string(kLeastTests) +
          "; add tests, or write null for this mode in all tests");
    if (count < kLeastShare * static_cast<double>(frequencies_hz.rows()))
      throw std::invalid_argument(
          mode + " was identified in " + std::to_string(count) + " of " +
          std::to_string(frequencies_hz.rows()) +
          " tests: the inference needs at least one test in twenty; write null for this mode in "
          "all tests, or leave out tests without it");
    if (!(std::log(low) < std::log(high)))
      throw std::invalid_argument(
          mode +
          " has the same frequency in all tests, so that its scatter cannot be inferred; "
          "give the measured frequencies with more digits, or one list \"frequencies\" with "
          "\"cov\"");
    out.push_back(j);
  }
  if (out.empty()) throw std::invalid_argument("no test identified a mode");
  return out;
}

/// Rows in the lexicographic order of their numbers, so that results do not depend on the order of
/// the tests.
std::vector<Index> sorted_rows(const MatrixXd& z) {
  std::vector<Index> rows(static_cast<std::size_t>(z.rows()));
  std::iota(rows.begin(), rows.end(), Index{0});
  const auto number = [](double x) { return std::isnan(x) ? kInfinity : x; };
  std::ranges::stable_sort(rows, [&](Index a, Index b) {
    for (Index j = 0; j < z.cols(); ++j)
      if (number(z(a, j)) != number(z(b, j))) return number(z(a, j)) < number(z(b, j));
    return false;
  });
  return rows;
}

}  // namespace

RepeatedTests infer_repeated_tests(const MatrixXd& frequencies_hz,
                                   const RepeatedTestsOptions& options) {
  RepeatedTests out;
  out.tests = static_cast<int>(frequencies_hz.rows());
  const std::vector<Index> modes = identified_modes(frequencies_hz, out.identified);
  const auto p = static_cast<Index>(modes.size());
  const Index all = frequencies_hz.cols();
  MatrixXd z = frequencies_hz(Eigen::all, modes).array().log();
  VectorXd centre(p), scale(p);
  for (Index j = 0; j < p; ++j) {
    std::vector<double> values;
    for (const double x : z.col(j))
      if (!std::isnan(x)) values.push_back(x);
    const Spread spread = spread_of(values);
    centre[j] = spread.centre;
    scale[j] = spread.scale;
    z.col(j) = (z.col(j).array() - spread.centre) / spread.scale;
  }
  // Tests that identified no mode have no information.
  std::vector<Index> rows;
  for (const Index t : sorted_rows(z))
    if ((z.row(t).array() == z.row(t).array()).any()) rows.push_back(t);

  std::vector<double> quantiles;
  for (const double nu : options.degrees_of_freedom)
    quantiles.push_back(
        std::isinf(nu) ? 1.0 : boost::math::quantile(boost::math::students_t(nu), kUpperSigma));
  out.degrees_of_freedom = options.degrees_of_freedom;
  out.probabilities.assign(quantiles.size(), 0.0);

  Sampler sampler(z(rows, Eigen::all), options);
  Moments means(p), scatters(p);
  MatrixXd within = MatrixXd::Zero(p, p), correlation = MatrixXd::Zero(p, p);
  VectorXd weights = VectorXd::Zero(static_cast<Index>(rows.size()));
  for (int i = 0; i < options.warmup + options.draws; ++i) {
    sampler.step(i);
    if (i < options.warmup) continue;
    means.add(sampler.conditional_mean());
    within += sampler.conditional_covariance() / options.draws;
    const VectorXd sd = sampler.covariance().diagonal().cwiseSqrt();
    correlation += sampler.covariance().cwiseQuotient(sd * sd.transpose()) / options.draws;
    scatters.add(quantiles[sampler.degrees_of_freedom()] * sd.cwiseProduct(scale));
    weights += sampler.mean_weights() / options.draws;
    for (std::size_t n = 0; n < quantiles.size(); ++n)
      out.probabilities[n] += sampler.probabilities()[n] / options.draws;
  }

  out.weights.assign(static_cast<std::size_t>(out.tests), 1.0);
  for (std::size_t r = 0; r < rows.size(); ++r)
    out.weights[static_cast<std::size_t>(rows[r])] = weights[static_cast<Index>(r)];
  for (int t = 0; t < out.tests; ++t)
    if (out.weights[static_cast<std::size_t>(t)] < kOutlierWeight) out.outliers.push_back(t);

  const VectorXd root_weights =
      Eigen::Map<const VectorXd>(out.weights.data(), out.tests).cwiseSqrt();
  const auto size = static_cast<std::size_t>(all);
  out.frequencies_hz.assign(size, kNaN);
  out.scatter.assign(size, kNaN);
  out.scatter_sd.assign(size, kNaN);
  out.serial_correlation.assign(size, kNaN);
  out.inflation.assign(size, 1.0);
  VectorXd factors(p);  // from z to Hz, with the inflation
  const VectorXd scatter_variances = scatters.covariance().diagonal();
  for (Index j = 0; j < p; ++j) {
    const auto mode = static_cast<std::size_t>(modes[static_cast<std::size_t>(j)]);
    const Serial serial =
        serial_of(root_weights.cwiseProduct((z.col(j).array() - means.mean()[j]).matrix()));
    out.frequencies_hz[mode] = std::exp(centre[j] + scale[j] * means.mean()[j]);
    out.scatter[mode] = scatters.mean()[j];
    out.scatter_sd[mode] = std::sqrt(scatter_variances[j]);
    out.serial_correlation[mode] = serial.correlation;
    out.inflation[mode] = serial.inflation;
    factors[j] = out.frequencies_hz[mode] * scale[j] * std::sqrt(serial.inflation);
  }
  out.covariance_hz2 = MatrixXd::Zero(all, all);
  out.covariance_hz2(modes, modes) =
      factors.asDiagonal() * (within + means.covariance()) * factors.asDiagonal();
  out.correlation = MatrixXd::Zero(all, all);
  out.correlation(modes, modes) = correlation;
  return out;
}

}  // namespace wheeltap::identification
