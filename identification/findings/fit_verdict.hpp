// Diagnosis of whether a model explains the data. Every model is an approximation of the measured
// structure, so even the most probable model may have large residuals. If no model explains the
// data, the report begins with this result.
#pragma once

#include <limits>
#include <string>
#include <variant>
#include <vector>

namespace wheeltap::identification {

namespace misfit {

/// Reason of a misfit: a response has R² below 1/2, and its residual is not noise.
struct Unexplained {
  std::string channel;
  double r2;
};
/// Reason of a misfit: the residual of a response is autocorrelated (portmanteau test) or exceeds
/// the stated noise (predictive p). The residual is also not small: it exceeds `kSmallResidual`
/// times the response's RMS, or three times the residual of a chain of masses with free cubic
/// springs.
struct NotNoise {
  std::string channel;
  double share;          ///< RMS of the residual divided by RMS of the response
  double share_of_free;  ///< RMS ratio for free cubic springs; NaN if not computed
  int lag;               ///< lag of the largest autocorrelation
  double autocorrelation;
};
/// Reason of a misfit: the prediction error after the window is more than twice the error within
/// the window.
struct WorseBeyond {
  std::string channel;
  double inside, beyond;  ///< RMS of residual divided by RMS of response
  int samples;            ///< number of predicted samples after the window
};
/// Reason of a misfit: predicted and measured frequencies differ by more than the stated noise
/// allows.
struct BeyondNoise {
  double p;                ///< posterior predictive p
  std::vector<int> modes;  ///< modes (from 1) whose frequencies deviate by more than 3 sd
  bool emulated;           ///< true if an emulator computes the predictions
  /// False if the log likelihoods of the Markov chains differ by more than the misfit. The chains
  /// may then have missed damages that explain the frequencies.
  bool chains_agree = true;
};
/// Reason of a misfit: predicted and measured frequencies differ by less than the stated noise
/// implies.
struct WithinNoise {
  double p;   ///< posterior predictive p
  double cv;  ///< stated coefficient of variation; NaN if it differs between modes
};

using Reason = std::variant<Unexplained, NotNoise, WorseBeyond, BeyondNoise, WithinNoise>;

}  // namespace misfit

/// Limit of posterior predictive p and portmanteau p-values. Smaller values reject a model.
inline constexpr double kMisfit = 1e-3;
/// Upper limit of a small residual, divided by the response. The text of the report mentions
/// smaller residuals that are not noise; its heading does not.
inline constexpr double kSmallResidual = 0.05;
/// Limit of a residual, divided by the residual of a chain of masses with free cubic springs.
inline constexpr double kMuchMoreThanFree = 3.0;

/// Diagnosis of the most probable model that explains the data and has a probability of at least 5
/// %. If there is no such model: diagnosis of the most probable model.
struct FitVerdict {
  /// Diagnosed model; -1: no model was diagnosed
  int model = -1;
  double r2 = std::numeric_limits<double>::quiet_NaN();  ///< smallest R² of the responses
  /// Posterior predictive p of χ²: P(replicate > data).
  double p = std::numeric_limits<double>::quiet_NaN();
  std::vector<misfit::Reason> why = {};
  /// The most probable model, if only the less probable `model` explains the data
  int instead_of = -1;
  std::vector<misfit::Reason> why_not = {};  ///< reasons why `instead_of` does not explain the data

  [[nodiscard]] bool ok() const { return why.empty(); }
};

}  // namespace wheeltap::identification
