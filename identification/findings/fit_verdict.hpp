// Whether the models explain the data at all: what every answer has to begin with where they do
// not. Measured rigs are never among the models; one that is far off can still be the most
// probable of them.
#pragma once

#include <limits>
#include <string>
#include <variant>
#include <vector>

namespace wheeltap::identification {

namespace misfit {

/// R² of a response is below 1/2, and what is left is no noise either.
struct Unexplained {
  std::string channel;
  double r2;
};
/// What is left of a response is correlated (portmanteau) or exceeds the stated noise (predictive
/// p), and too large to be overlooked: above `kSmallResidual` of the response's RMS, or three times
/// what a free cubic chain leaves.
struct NotNoise {
  std::string channel;
  double share;          ///< residual over response, root mean squares
  double share_of_free;  ///< that of the free cubic chain; NaN where it was not asked
  int lag;               ///< of the largest autocorrelation, and its value
  double autocorrelation;
};
/// Beyond its window the model misses the record by more than twice as much as in it.
struct WorseBeyond {
  std::string channel;
  double inside, beyond;  ///< residual over response, root mean squares
  int samples;            ///< predicted
};
/// Frequencies are farther off than the stated noise lets them be.
struct BeyondNoise {
  double p;                ///< posterior predictive
  std::vector<int> modes;  ///< off by more than 3 sd, from 1
  bool emulated;           ///< an emulator predicts
};
/// Frequencies are fitted closer than the stated noise lets them be.
struct WithinNoise {
  double p;   ///< posterior predictive
  double cv;  ///< stated; NaN where it differs from mode to mode
};

using Reason = std::variant<Unexplained, NotNoise, WorseBeyond, BeyondNoise, WithinNoise>;

}  // namespace misfit

/// Posterior predictive p and portmanteau tests below this speak against a model.
inline constexpr double kMisfit = 1e-3;
/// Residuals below this share of a response, if no noise, are told of but head nothing.
inline constexpr double kSmallResidual = 0.05;
/// In terms of the residual that a free cubic chain leaves.
inline constexpr double kMuchMoreThanFree = 3.0;

/// Of the most probable model that explains the data, of those that hold 5 % or more; of the most
/// probable where none of these does.
struct FitVerdict {
  int model = -1;                                        ///< -1: nothing was judged
  double r2 = std::numeric_limits<double>::quiet_NaN();  ///< the least over the responses
  /// Posterior predictive p, of χ²: P(of a replicate > of the data).
  double p = std::numeric_limits<double>::quiet_NaN();
  std::vector<misfit::Reason> why = {};
  int instead_of = -1;  ///< the most probable model, where that fails and this one does not
  std::vector<misfit::Reason> why_not = {};  ///< what speaks against it

  [[nodiscard]] bool ok() const { return why.empty(); }
};

}  // namespace wheeltap::identification
