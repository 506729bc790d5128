// What the modes of a structure say of its parameters, and what they do not.
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

/// Of one parameter, in its standard normal coordinate z, in which every prior has variance 1.
struct Contraction {
  std::string name;
  double contraction = 0.0;  ///< 1 - Var(z | data)
  double shift = 0.0;        ///< mean of z: how many prior sd the posterior has moved
  using Bound = PriorBound;
  Bound bound = Bound::none;  ///< of its prior, at which the draws pile up

  /// The data leave it at the prior.
  [[nodiscard]] bool at_prior() const;
};

/// Two parameters that cannot be told apart: their correlation, of z, within one solution.
struct Entangled {
  std::string a, b;
  double correlation = 0.0;
};

/// A combination of parameters' z of which the data say next to nothing: an eigenvector of
/// Cov(z | data) whose contraction is below `kUntouched`.
struct UntouchedDirection {
  double contraction = 0.0;
  std::vector<std::pair<std::string, double>> weights = {};  ///< the largest, of |w| >= 0.3
};
inline constexpr double kUntouched = 0.05;
inline constexpr double kEntangled = 0.95;

/// A measured mode against the posterior.
struct ModeFinding {
  int mode = 0;                           ///< as measured, from 1
  double measured_hz = 0.0, sd_hz = 0.0;  ///< NaN where only a shape was measured
  Marginal frequency_hz = {};             ///< of the computed one
  double residual = 0.0;                  ///< of the frequency, in sd: mean over the draws
  int computed = 0;                       ///< the computed mode it is matched to most, from 1
  double matched = 1.0;                   ///< share of the draws in which it is that one
  double spurious = 0.0;  ///< P that it is none of the structure's, where modes are doubted
  bool has_shape = false;
  Marginal mac = {};              ///< over the draws
  double shape_chi_square = 0.0;  ///< mean over the draws
  int shape_freedoms = 0;
  double shape_p = 1.0;  ///< of a replicate, mean over the draws
  /// What the posterior would lose without this mode: KL(posterior ‖ without) [nats], the parameter
  /// that would move most, and by how many posterior sd. `reliable`: the draws can be reweighted
  /// so.
  double information = 0.0;
  std::string moves = {};
  double moved = 0.0;
  bool reliable = true;
  std::string state = {};  ///< where there are several
  int mode_of_state = 0;   ///< as measured in it, from 1

  /// A gap (ModalData) is none.
  [[nodiscard]] bool is_measured() const { return !std::isnan(measured_hz) || has_shape; }
  /// Off by more than the stated scatter allows: 3 sd, or p below 1e-3; spurious ones are not.
  [[nodiscard]] bool is_off() const;
};

/// A mode that was not used.
struct PredictedMode {
  int mode = 0;  ///< elastic, computed, from 1
  Marginal frequency_hz = {};
  double low_hz = 0.0, high_hz = 0.0;  ///< 95 % of a measurement, noise and discrepancy included
  std::optional<double> measured_hz = {};  ///< held out
  std::string state = {};                  ///< where it is one of a state's: `mode` is then its own

  [[nodiscard]] bool misses() const {
    return measured_hz && (*measured_hz < low_hz || *measured_hz > high_hz);
  }
  /// A band that says nothing: wider than half of the frequency.
  [[nodiscard]] bool useless() const { return high_hz - low_hz > 0.5 * frequency_hz.q50; }
};

struct UpdateFit {
  double p = 1.0;  ///< posterior predictive, of χ²: P(of a replicate > of the data)
  double best_p =
      1.0;          ///< of the best draw's χ², with one freedom a parameter less; 1 if none left
  double r2 = 0.0;  ///< of the frequencies, at the posterior mean of each; NaN of fewer than 2
  std::vector<int> off;     ///< modes
  std::vector<int> missed;  ///< held-out modes outside their band

  [[nodiscard]] bool ok() const;
};

struct UpdateFindings : Findings {
  std::vector<Contraction> contractions;
  std::vector<Entangled> entangled;
  std::vector<UntouchedDirection> untouched;
  /// Separate regions of the posterior, the most probable first; empty where there is one.
  std::vector<Solution> solutions;
  std::vector<ModeFinding> modes;
  std::optional<NumberingFinding> numbering;  ///< of data without shapes, where it was judged
  Eigen::MatrixXd mac;  ///< measured × computed modes, at the best draw; empty without shapes
  /// Modes × sensors, at the best draw, scaled to the measured ones; NaN where not measured.
  Eigen::MatrixXd best_shapes;
  std::vector<double> best_draw;
  std::vector<PredictedMode> predictions;
  UpdateFit fit;
  int numbers = 0;   ///< measured
  long in_full = 0;  ///< of `examined` draws, those that the basis had no answer for
  int examined = 0;
};

/// The run must have at least 4 draws a chain, all chains of the same length.
[[nodiscard]] UpdateFindings update_findings(const UpdateProblem& problem,
                                             const inference::Posterior& posterior,
                                             const std::vector<MethodEvidence>& evidence,
                                             std::uint64_t seed);

}  // namespace wheeltap::identification
