// Results of a model update: information in the modes about each parameter, fit, predictions.
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "identification/findings/findings.hpp"
#include "identification/findings/prior_bound.hpp"
#include "identification/findings/solutions.hpp"
#include "identification/structural/updating/mode_numbering.hpp"
#include "identification/structural/updating/update_problem.hpp"

namespace wheeltap::identification {

/// Change from prior to posterior of one parameter, in its standard normal coordinate z, for which
/// every prior has variance 1.
struct Contraction {
  std::string name;
  double contraction = 0.0;  ///< 1 - Var(z | data)
  double shift = 0.0;        ///< mean of z: shift of the posterior in prior sd
  using Bound = PriorBound;
  Bound bound = Bound::none;  ///< bound of the prior at which the draws pile up

  /// True if the posterior is practically equal to the prior.
  [[nodiscard]] bool at_prior() const;
};

/// Two parameters that the data cannot distinguish; `correlation` is the correlation of the
/// coordinates z of both parameters in a solution.
struct Entangled {
  std::string a, b;
  double correlation = 0.0;
};

/// A combination of coordinates z about which the data contain little information: an eigenvector
/// of Cov(z | data) with a contraction below `kUntouched`.
struct UntouchedDirection {
  double contraction = 0.0;
  std::vector<std::pair<std::string, double>> weights = {};  ///< largest weights, |w| >= 0.3
};
inline constexpr double kUntouched = 0.05;
inline constexpr double kEntangled = 0.95;

/// A measured mode compared with the posterior.
struct ModeFinding {
  int mode = 0;                           ///< number of the measured mode, from 1
  double measured_hz = 0.0, sd_hz = 0.0;  ///< NaN if only a shape was measured
  Marginal frequency_hz = {};             ///< frequency of the computed mode
  double residual = 0.0;                  ///< residual divided by its sd: mean over the draws
  int computed = 0;                       ///< computed mode that draws match most often, from 1
  double matched = 1.0;                   ///< fraction of the draws with the match `computed`
  /// Probability that the mode is spurious, if modes may be spurious
  double spurious = 0.0;
  bool has_shape = false;
  Marginal mac = {};              ///< MAC of measured and computed shape over the draws
  double shape_chi_square = 0.0;  ///< χ² of the shape, mean over the draws
  int shape_freedoms = 0;
  double shape_p = 1.0;  ///< p-value of the shape, mean over the draws
  /// Effect of omitting this mode: KL(posterior ‖ posterior without the mode) [nats], and the
  /// parameter that would change most, with its change in posterior sd. `reliable` is true if the
  /// effective sample size suffices.
  double information = 0.0;
  std::string moves = {};
  double moved = 0.0;
  bool reliable = true;
  std::string state = {};  ///< empty for a single state
  int mode_of_state = 0;   ///< number of the mode in this state, from 1

  /// False for a gap (ModalData).
  [[nodiscard]] bool is_measured() const { return !std::isnan(measured_hz) || has_shape; }
  /// True if the mode deviates by more than the stated standard deviations allow: its frequency by
  /// more than 3 sd, or its shape with p below 1e-3. False for spurious modes.
  [[nodiscard]] bool is_off() const;
};

/// The prediction of a mode that was not used for the update.
struct PredictedMode {
  int mode = 0;  ///< number of the elastic mode, from 1
  Marginal frequency_hz = {};
  double low_hz = 0.0, high_hz = 0.0;      ///< 95 % prediction interval (noise and discrepancy)
  std::optional<double> measured_hz = {};  ///< measured frequency of the predicted mode
  std::string state = {};  ///< if there are several states; `mode` is then the number in that state

  [[nodiscard]] bool misses() const {
    return measured_hz && (*measured_hz < low_hz || *measured_hz > high_hz);
  }
  /// True if the prediction interval is wider than half of the frequency and therefore useless.
  [[nodiscard]] bool useless() const { return high_hz - low_hz > 0.5 * frequency_hz.q50; }
};

struct UpdateFit {
  double p = 1.0;  ///< posterior predictive p-value: P(χ² of replicated data > χ² of data)
  /// p-value of χ² at the best draw, with the degrees of freedom reduced by the number of
  /// parameters; 1 if no degrees of freedom are left.
  double best_p = 1.0;
  /// R² of the frequencies, with posterior mean predictions; NaN for fewer than 2 modes
  double r2 = 0.0;
  std::vector<int> off;     ///< modes for which is_off() is true
  std::vector<int> missed;  ///< held-out modes outside their prediction interval

  [[nodiscard]] bool ok() const;
};

struct UpdateFindings : Findings {
  std::vector<Contraction> contractions;
  std::vector<Entangled> entangled;
  std::vector<UntouchedDirection> untouched;
  /// Separate regions of the posterior, most probable first; empty if there is only one region.
  std::vector<Solution> solutions;
  std::vector<ModeFinding> modes;
  std::optional<NumberingFinding> numbering;  ///< check of the mode numbers, for data without
                                              ///< shapes; empty if there was no check
  Eigen::MatrixXd mac;  ///< measured × computed modes, at the best draw; empty without shapes
  /// Modes × sensors, at the best draw, scaled to the measured shapes; NaN if not measured.
  Eigen::MatrixXd best_shapes;
  std::vector<double> best_draw;
  std::vector<PredictedMode> predictions;
  UpdateFit fit;
  int numbers = 0;   ///< number of measured values
  long in_full = 0;  ///< number of `examined` draws that needed the full problem
  int examined = 0;
};

/// Computes the findings. The run must have at least 4 draws per chain and chains of equal length.
[[nodiscard]] UpdateFindings update_findings(const UpdateProblem& problem,
                                             const inference::Posterior& posterior,
                                             const std::vector<MethodEvidence>& evidence,
                                             std::uint64_t seed);

}  // namespace wheeltap::identification
