// Kriging: Gaussian-process interpolation of runs at scattered points, with prediction variances.
#pragma once

#include <memory>

#include "emulator/interpolant.hpp"

namespace wheeltap::emulator {

/// Correlation as a function of the distance r between two points, r² = Σ_j ((u_j - u'_j) / ℓ_j)²,
/// with one correlation length ℓ_j per factor. u_j is the scale coordinate of factor j, mapped to
/// [0, 1].
enum class Kernel {
  matern52,            ///< (1 + √5 r + 5 r²/3) exp(-√5 r): twice differentiable
  squared_exponential  ///< exp(-r²/2): infinitely smooth
};

/// Correlation function of a Gaussian process: the covariance divided by the variance of the
/// process.
struct Correlation {
  Kernel kernel = Kernel::matern52;
  Eigen::VectorXd lengths;  ///< ℓ, one per factor, > 0, in units of the factor's range
  double nugget = 0.0;      ///< η >= 0: variance of independent noise / variance of the process
};

/// Log marginal likelihood ln L, and its derivatives with respect to ln ℓ_1 … ln ℓ_d, ln η.
struct LogLikelihood {
  double value;  ///< -∞ if R is not numerically positive definite
  Eigen::VectorXd gradient;
};

/// Computes the log marginal likelihood of m independent columns y of `values` (n × m) at
/// `unit_points` (n × d, in the unit cube), with the correlation matrix R = k(X, X) + η I. Each
/// column's constant mean β = 1ᵀR⁻¹y / 1ᵀR⁻¹1 and variance σ² = (y-β)ᵀR⁻¹(y-β)/n have their
/// maximum-likelihood values (Rasmussen & Williams 2006, Gaussian Processes for Machine Learning,
/// sections 2.7 and 5.4):
///   ln L = -½ Σ_columns [n ln(2π σ²) + ln|R| + n],
///   ∂ ln L / ∂p = ½ Σ_columns [αᵀ ∂R α / σ² - tr(R⁻¹ ∂R)],  α = R⁻¹(y - β).
[[nodiscard]] LogLikelihood log_marginal_likelihood(const RowMatrix& unit_points,
                                                    const RowMatrix& values,
                                                    const Correlation& correlation);

struct GaussianProcessOptions {
  Kernel kernel = Kernel::matern52;
  /// If true, all responses have the same correlation lengths; an evaluation then takes as long as
  /// for one response. If false, each response has its own correlation lengths. Separate lengths
  /// give more accurate predictions if responses oscillate with different wavelengths.
  bool shared_lengths = false;
  /// If true, the nugget is also fitted, for model runs with noise. If false, the nugget is the
  /// smallest value that keeps R positive definite, and the process interpolates the runs.
  bool infer_nugget = false;
  /// Largest number of runs in the fit of the correlation lengths (drawn with `seed`). The run time
  /// of a fit to n runs is O(n³). The predictions of the Gaussian process use all runs.
  Eigen::Index most_fitted_runs = 400;
  int most_iterations = 60;  ///< limit of the quasi-Newton search
  int threads = 1;
  std::uint64_t seed = 1;
};

/// Ordinary Kriging with a constant mean β. For each response,
///   f(x) | y ~ N(β + rᵀR⁻¹(y - β),  σ² [1 - rᵀR⁻¹r + (1 - 1ᵀR⁻¹r)² / 1ᵀR⁻¹1]),  r = k(X, x)
/// (Rasmussen & Williams 2006, section 2.7). The last term of the variance is due to the
/// uncertainty of β. A nugget of at least 1e-12 (Matérn) or 1e-8 (squared exponential) keeps R
/// positive definite. The nugget is multiplied by ten until the factorisation of R succeeds.
/// Several threads may call `evaluate` at once.
class GaussianProcess final : public Interpolant {
 public:
  /// Fits the correlation lengths (and the nugget) to the runs by maximum marginal likelihood. A
  /// quasi-Newton search with the analytic gradient starts from the best of several initial values,
  /// each with the same correlation length for all factors. `points` (runs × factors) must lie in
  /// the factors' ranges. Throws std::invalid_argument for fewer than two runs, sizes that
  /// disagree, points outside the ranges or values that are not finite.
  GaussianProcess(std::vector<Factor> factors, const RowMatrix& points, const RowMatrix& values,
                  const GaussianProcessOptions& options = {});

  /// Uses the `parameters()` of an earlier fit to the same runs, instead of a new fit. Throws the
  /// exceptions of the other constructor, and std::invalid_argument if `parameters` does not have 1
  /// or `responses` rows of d + 1 positive numbers.
  GaussianProcess(std::vector<Factor> factors, const RowMatrix& points, const RowMatrix& values,
                  Kernel kernel, const RowMatrix& parameters);
  ~GaussianProcess() override;
  GaussianProcess(GaussianProcess&&) noexcept;
  GaussianProcess& operator=(GaussianProcess&&) noexcept;

  /// Writes the predicted means of all responses at x. Throws std::out_of_range for x outside the
  /// box of the factors' ranges, because interpolants do not extrapolate.
  void evaluate(std::span<const double> x, std::span<double> mean) const override;
  /// Writes the predicted means and variances of the model's responses at x; the variances do not
  /// include the noise of the runs.
  void evaluate(std::span<const double> x, std::span<double> mean,
                std::span<double> variance) const override;

  /// Computes leave-one-out predictions with the fitted correlation lengths, nugget and variance.
  /// For each omitted run, β is estimated again without this run (Dubrule 1983, Cross validation of
  /// Kriging in a unique neighborhood). With Q = R⁻¹ - R⁻¹1 1ᵀR⁻¹ / 1ᵀR⁻¹1, the residual of run i
  /// is [Q y]_i / Q_ii, with the variance σ² / Q_ii.
  [[nodiscard]] LeaveOneOut leave_one_out() const override;

  /// Returns the fitted parameters ℓ_1 … ℓ_d, η: one row for all responses, or one row per
  /// response.
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

/// Interpolant type for Kriging with a Matérn kernel and separate correlation lengths for each
/// response; a table stores `parameters()` as "gaussian_process".
extern const InterpolantType kGaussianProcess;

}  // namespace wheeltap::emulator
