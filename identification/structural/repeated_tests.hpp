// Natural frequencies from repeated tests of one structure: mean, and scatter of a single test.
//
// Model of test t, t = 1 … N, with p modes:
//
//   y_t = ln f_t ~ Student t of p variables (ν, μ, Σ), tests independent
//
// Frequencies that were not identified are missing at random. Priors: μ flat; Σ inverse Wishart
// with p degrees of freedom and the scale matrix diag(s_j²), where s_j is the robust scatter of
// mode j; ν uniform on a list of values. This prior of Σ has the weight of one test. Without
// missing frequencies and for ν = ∞, the posterior of μ is Student t with N degrees of freedom
// about the mean of the tests. The scale matrix of this distribution is (S + diag(s_j²)) / N², with
// S the sum of squares about the mean.
//
// The posterior is drawn by Gibbs sampling with data augmentation (Liu 1996, "Bayesian robust
// multivariate linear regression with incomplete data", J. Am. Stat. Assoc. 91:1219).
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "base/eigen.hpp"

namespace wheeltap::identification {

struct RepeatedTestsOptions {
  /// Possible values of ν, the degrees of freedom, with equal prior probabilities.
  std::vector<double> degrees_of_freedom = {2.0,  3.0,  5.0,
                                            10.0, 30.0, std::numeric_limits<double>::infinity()};
  int warmup = 500, draws = 4000;
  std::uint64_t seed = 1;
};

/// Smallest number of tests in which a mode must be identified.
inline constexpr int kLeastTests = 4;
/// A mode must be identified in at least this fraction of the tests. If the mode is
/// identified in fewer tests, the draws of its missing frequencies are so strongly correlated that
/// the sampler does not converge.
inline constexpr double kLeastShare = 0.05;
/// A test whose posterior mean weight is below this limit is a probable outlier.
inline constexpr double kOutlierWeight = 0.25;

/// Posterior of the mean of the tests and of the scatter of a single test. A mode that no test
/// identified has NaN in `frequencies_hz`, `scatter`, `scatter_sd` and `serial_correlation`, and
/// zeros in the matrices.
struct RepeatedTests {
  int tests = 0;
  std::vector<int> identified = {};  ///< number of tests that identified each mode

  std::vector<double> frequencies_hz = {};  ///< exp(E[μ_j])
  /// Covariance of `frequencies_hz` [Hz²], modes × modes: f_i f_j cov(μ_i, μ_j), multiplied by
  /// √(inflation_i · inflation_j).
  Eigen::MatrixXd covariance_hz2 = {};

  /// Relative scatter of a single test: half the width of the central 68.3 % interval of ln f_j.
  /// This half width is √Σ_jj times the 84.1 % quantile of Student's t distribution with ν degrees
  /// of freedom. For ν = ∞, this scatter equals the standard deviation. The lists hold the
  /// posterior mean and sd of this scatter.
  std::vector<double> scatter = {}, scatter_sd = {};
  Eigen::MatrixXd correlation = {};  ///< posterior mean of the correlation matrix of Σ

  std::vector<double> degrees_of_freedom = {}, probabilities = {};  ///< posterior of ν
  std::vector<double> weights = {};  ///< posterior mean weight of each test, about 1 for most tests
  std::vector<int> outliers = {};    ///< tests (from 0) with a weight below kOutlierWeight

  /// Correlation r_j of consecutive tests, in the order given, per mode. A significant correlation
  /// (more than `kSerialLevel` standard errors) reduces the information about the mean. The
  /// variance of μ_j is then multiplied by inflation_j = (1 + r_j) / (1 - r_j), at most N. Without
  /// significant correlation, inflation_j = 1.
  std::vector<double> serial_correlation = {}, inflation = {};
};

/// Number of standard errors (N^-1/2) beyond which a serial correlation is significant.
inline constexpr double kSerialLevel = 2.0;

/// Infers the mean frequencies and the scatter of repeated tests.
/// \param frequencies_hz tests × modes, > 0; NaN: not identified
/// The results, except `serial_correlation` and `inflation`, do not depend on the order of the
/// tests. Throws std::invalid_argument, with the mode, in three cases: a frequency is not
/// positive; all frequencies of a mode are equal; or a mode was identified, but in fewer than
/// kLeastTests tests, or in a fraction of the tests that is
/// smaller than kLeastShare.
[[nodiscard]] RepeatedTests infer_repeated_tests(const Eigen::MatrixXd& frequencies_hz,
                                                 const RepeatedTestsOptions& options = {});

}  // namespace wheeltap::identification
