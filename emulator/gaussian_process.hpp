// Kriging: interpolation of scattered runs that says how uncertain it is.
#pragma once

#include <memory>

#include "emulator/interpolant.hpp"

namespace wheeltap::emulator {

/// Correlation of two points whose distance is r² = Σ_j ((u_j - u'_j) / ℓ_j)², with one length ℓ_j
/// a factor; u are the factors' scale coordinates, mapped to [0, 1].
enum class Kernel {
  matern52,            ///< (1 + √5 r + 5 r²/3) exp(-√5 r): twice differentiable
  squared_exponential  ///< exp(-r²/2): infinitely smooth
};

/// What a Gaussian process is told about covariance, less its variance.
struct Correlation {
  Kernel kernel = Kernel::matern52;
  Eigen::VectorXd lengths;  ///< ℓ, one a factor, > 0, in units of the factor's range
  double nugget = 0.0;      ///< η >= 0: variance of independent noise / variance of the process
};

/// ln L and its derivatives by ln ℓ_1 … ln ℓ_d, ln η.
struct LogLikelihood {
  double value;  ///< -∞ where R is not numerically positive definite
  Eigen::VectorXd gradient;
};

/// Log marginal likelihood of m independent columns y of `values` (n × m) at `unit_points` (n × d,
/// in the unit cube), under R = k(X, X) + η I, with each column's constant mean β = 1ᵀR⁻¹y / 1ᵀR⁻¹1
/// and variance σ² = (y-β)ᵀR⁻¹(y-β)/n put in at their most likely values (Rasmussen & Williams
/// 2006, Gaussian Processes for Machine Learning, sections 2.7 and 5.4):
///   ln L = -½ Σ_columns [n ln(2π σ²) + ln|R| + n],
///   ∂ ln L / ∂p = ½ Σ_columns [αᵀ ∂R α / σ² - tr(R⁻¹ ∂R)],  α = R⁻¹(y - β).
[[nodiscard]] LogLikelihood log_marginal_likelihood(const RowMatrix& unit_points,
                                                    const RowMatrix& values,
                                                    const Correlation& correlation);

struct GaussianProcessOptions {
  Kernel kernel = Kernel::matern52;
  /// One set of lengths for all responses: evaluations cost as one response does. Else each
  /// response has its own, which is more accurate where responses wave at different lengths.
  bool shared_lengths = false;
  /// Fit the nugget too: for runs with noise. Else it is the least that arithmetic needs, and the
  /// process interpolates.
  bool infer_nugget = false;
  /// Lengths are fitted on at most this many of the runs (drawn by `seed`): the cost of a fit grows
  /// with their cube. The process itself uses them all.
  Eigen::Index most_fitted_runs = 400;
  int most_iterations = 60;  ///< of the quasi-Newton search
  int threads = 1;
  std::uint64_t seed = 1;
};

/// Ordinary Kriging with constant mean β, for each response
///   f(x) | y ~ N(β + rᵀR⁻¹(y - β),  σ² [1 - rᵀR⁻¹r + (1 - 1ᵀR⁻¹r)² / 1ᵀR⁻¹1]),  r = k(X, x)
/// (the last term is what not knowing β adds; Rasmussen & Williams 2006, section 2.7). R is kept
/// positive definite by a nugget of at least 1e-12 (Matérn; 1e-8 with the squared exponential),
/// raised tenfold as often as its factorisation needs it. Evaluations may run in several threads at
/// once.
class GaussianProcess final : public Interpolant {
 public:
  /// Fits lengths (and nugget) to runs by maximum marginal likelihood: the best of a ladder of
  /// common lengths starts a quasi-Newton search with the analytic gradient. `points` (runs ×
  /// factors) must lie in the factors' ranges. Throws std::invalid_argument for fewer than two
  /// runs, shapes that disagree, points outside or values that are not finite.
  GaussianProcess(std::vector<Factor> factors, const RowMatrix& points, const RowMatrix& values,
                  const GaussianProcessOptions& options = {});

  /// With `parameters()` of an earlier fit to the same runs: nothing is fitted. Throws
  /// std::invalid_argument as above, and unless parameters are 1 or `responses` rows of d + 1
  /// positive numbers.
  GaussianProcess(std::vector<Factor> factors, const RowMatrix& points, const RowMatrix& values,
                  Kernel kernel, const RowMatrix& parameters);
  ~GaussianProcess() override;
  GaussianProcess(GaussianProcess&&) noexcept;
  GaussianProcess& operator=(GaussianProcess&&) noexcept;

  /// Means of all responses at x. Throws std::out_of_range outside the factors' box, as the other
  /// interpolants do: there is no extrapolation.
  void evaluate(std::span<const double> x, std::span<double> mean) const override;
  /// And the variances of the model's answer, without the runs' own noise.
  void evaluate(std::span<const double> x, std::span<double> mean,
                std::span<double> variance) const override;

  /// At the fitted lengths, nugget and variance, with β estimated anew each time (Dubrule 1983,
  /// Cross validation of Kriging in a unique neighborhood): with
  /// Q = R⁻¹ - R⁻¹1 1ᵀR⁻¹ / 1ᵀR⁻¹1, the residual of run i is [Q y]_i / Q_ii, its variance σ² /
  /// Q_ii.
  [[nodiscard]] LeaveOneOut leave_one_out() const override;

  /// One row per set of lengths (1, or one a response): ℓ_1 … ℓ_d, η.
  [[nodiscard]] RowMatrix parameters() const;
  [[nodiscard]] Kernel kernel() const;
  [[nodiscard]] const std::vector<Factor>& factors() const;
  [[nodiscard]] Eigen::Index responses() const;
  [[nodiscard]] bool contains(std::span<const double> x) const override {
    return emulator::contains(factors(), x);
  }

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

/// With a Matérn kernel and lengths for each response; a table keeps `parameters()` as
/// "gaussian_process".
extern const InterpolantType kGaussianProcess;

}  // namespace wheeltap::emulator
