// Goodness of fit: does a model explain the data? Every model is an approximation of the measured
// structure, so even the most probable model may have large residuals. If no model explains the
// data, the report begins with this result.
#pragma once

#include <limits>
#include <string>
#include <variant>
#include <vector>

namespace wheeltap::identification {

namespace misfit {

/// Reason for a misfit: R² of a response is below 1/2, and the residual is not noise.
struct Unexplained {
  std::string channel;
  double r2;
};
/// Reason for a misfit: the residual of a response is autocorrelated (portmanteau test) or exceeds
/// the stated noise (posterior predictive p-value). In addition, the residual is not small: its RMS
/// exceeds `kSmallResidual` times the standard deviation of the response, or three times the
/// residual of a chain of masses with free cubic springs.
struct NotNoise {
  std::string channel;
  double share;          ///< RMS of the residual divided by the standard deviation of the response
  double share_of_free;  ///< the same ratio with free cubic springs; NaN if not computed
  int lag;               ///< lag of the largest autocorrelation
  double autocorrelation;
};
/// Reason for a misfit: the RMS prediction error after the window is more than twice the RMS error
/// within the window.
struct WorseBeyond {
  std::string channel;
  double inside, beyond;  ///< RMS of the residual divided by the standard deviation of the response
  int samples;            ///< number of predicted samples after the window
};
/// Reason for a misfit: predicted and measured frequencies differ by more than the stated noise
/// allows.
struct BeyondNoise {
  double p;                ///< posterior predictive p
  std::vector<int> modes;  ///< numbers of modes whose frequencies deviate by > 3 sd
  bool emulated;           ///< true if an emulator computes the predictions
  /// False if the mean log likelihoods of the Markov chains differ so much that an increase by this
  /// difference would explain the data. Chains that disagree may have missed damages that explain
  /// the frequencies.
  bool chains_agree = true;
};
/// Reason for a misfit: predicted and measured frequencies differ by less than the stated noise
/// implies.
struct WithinNoise {
  double p;   ///< posterior predictive p
  double cv;  ///< stated noise: sd divided by frequency; NaN if it differs between modes
};

using Reason = std::variant<Unexplained, NotNoise, WorseBeyond, BeyondNoise, WithinNoise>;

}  // namespace misfit

/// Significance level of posterior predictive and portmanteau tests. Smaller p reject a model.
inline constexpr double kMisfit = 1e-3;
/// Largest RMS of a small residual, divided by the standard deviation of the response. The text of
/// the report mentions a small residual that is not noise; the heading does not.
inline constexpr double kSmallResidual = 0.05;
/// A residual is not small if it exceeds this multiple of the residual of a chain of masses with
/// free cubic springs.
inline constexpr double kMuchMoreThanFree = 3.0;

/// Goodness of fit of one model: the most probable model that explains the data and has a
/// probability of at least 5 % or, if there is no such model, the most probable model.
struct FitVerdict {
  /// Model whose fit was assessed; -1: no model
  int model = -1;
  double r2 = std::numeric_limits<double>::quiet_NaN();  ///< smallest R² of the responses
  /// Posterior predictive p-value: P(χ² of replicated data > χ² of the data).
  double p = std::numeric_limits<double>::quiet_NaN();
  std::vector<misfit::Reason> why = {};
  /// The most probable model, if it does not explain the data but `model` does; -1: no such model
  int instead_of = -1;
  std::vector<misfit::Reason> why_not = {};  ///< reasons why `instead_of` does not explain the data

  [[nodiscard]] bool ok() const { return why.empty(); }
};

}  // namespace wheeltap::identification
