// Diagnosis of whether a model explains the data. Every model is an approximation of the measured
// structure, so even the most probable model may fit badly; a report begins with this result if no
// model explains the data.
#pragma once

#include <limits>
#include <string>
#include <variant>
#include <vector>

namespace wheeltap::identification {

namespace misfit {

/// The reason that R² of a response is below 1/2 and its residual is not noise.
struct Unexplained {
  std::string channel;
  double r2;
};
/// The residual of a response is autocorrelated (portmanteau test) or exceeds the stated noise
/// (predictive p), and is not small: above `kSmallResidual` of the response's RMS, or above three
/// times the residual of a free cubic chain.
struct NotNoise {
  std::string channel;
  double share;          ///< RMS of residual over RMS of response
  double share_of_free;  ///< the same for the free cubic chain; NaN if not computed
  int lag;               ///< lag of the largest autocorrelation
  double autocorrelation;
};
/// The error of the model after the window is more than twice that within the window.
struct WorseBeyond {
  std::string channel;
  double inside, beyond;  ///< RMS of residual over RMS of response
  int samples;            ///< number predicted
};
/// Frequencies deviate by more than the stated noise allows.
struct BeyondNoise {
  double p;                ///< posterior predictive
  std::vector<int> modes;  ///< deviate by more than 3 sd; numbered from 1
  bool emulated;           ///< predictions are from an emulator
};
/// Frequencies are fitted more closely than the stated noise allows.
struct WithinNoise {
  double p;   ///< posterior predictive
  double cv;  ///< stated; NaN if it differs between modes
};

using Reason = std::variant<Unexplained, NotNoise, WorseBeyond, BeyondNoise, WithinNoise>;

}  // namespace misfit

/// Posterior predictive p and portmanteau p-values below this reject a model.
inline constexpr double kMisfit = 1e-3;
/// Residuals below this share of a response are reported in the text but not in the heading, even
/// if they are not noise.
inline constexpr double kSmallResidual = 0.05;
/// Limit of the residual relative to that of a free cubic chain.
inline constexpr double kMuchMoreThanFree = 3.0;

/// Diagnosis of the most probable model that explains the data, among models of at least 5 %; if no
/// model explains them, of the most probable model.
struct FitVerdict {
  int model = -1;                                        ///< -1: no model was judged
  double r2 = std::numeric_limits<double>::quiet_NaN();  ///< smallest over the responses
  /// Posterior predictive p of χ²: P(replicate > data).
  double p = std::numeric_limits<double>::quiet_NaN();
  std::vector<misfit::Reason> why = {};
  int instead_of = -1;  ///< the most probable model, if it fails and `model` does not
  std::vector<misfit::Reason> why_not = {};  ///< reasons against `instead_of`

  [[nodiscard]] bool ok() const { return why.empty(); }
};

}  // namespace wheeltap::identification
