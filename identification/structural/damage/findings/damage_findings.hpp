// Results of a damage identification: number, locations and severities of defects; fit to data.
#pragma once

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "identification/findings/findings.hpp"
#include "identification/structural/damage/damage_problem.hpp"
#include "identification/structural/damage/findings/baseline_findings.hpp"
#include "identification/structural/damage/findings/emulator_check.hpp"
#include "identification/structural/damage/findings/merged_damages.hpp"
#include "identification/structural/drawn_modes.hpp"
#include "identification/structural/likelihood/mode_contributions.hpp"

namespace wheeltap::identification {

/// A segment of a beam or member in which the expected number of defects is at least 0.1.
struct Place {
  int stretch = 0;  ///< index of the member, joint or storey in the kind's line
  double from, to;  ///< [m]
  double expected;  ///< expected number of defects
  Marginal location;
  std::optional<Marginal> severity;     ///< marginal of the severity, if the severity is unknown
  std::optional<Marginal> extent = {};  ///< marginal of the extent [m], if the extent is unknown
};

/// Posterior locations of the defects of one kind.
struct KindFinding {
  std::vector<double> expected;                    ///< expected number of defects in each cell
  std::map<int, std::vector<double>> given_count;  ///< `expected`, given each number of defects > 0
  std::vector<Place> places;
};

/// Effects of the symmetry of a beam or structure: frequencies cannot distinguish x from L - x, or
/// equivalent parts.
struct SymmetryFinding {
  struct Chain {
    double left, right;  ///< defects that precede or follow their mirror images: expected numbers
    double mcse_of_difference;
  };
  double center;  ///< [m], for a beam
  bool emulated;  ///< true if the likelihood uses an emulator
  std::vector<Chain> chains;
  std::vector<std::vector<std::string>> alike = {};  ///< for a structure, as in SiteSymmetries
  std::vector<std::string> turned = {};
};

struct FitFinding {
  struct Mode {
    double observed, sd;               ///< [Hz]; NaN: not measured, or noise inferred
    double mean, q2_5, q97_5;          ///< predicted frequency [Hz]
    double standardised_residual;      ///< posterior mean of the residual; NaN if not measured
    std::string state = {};            ///< empty for a single state
    int mode = 0;                      ///< number of the measured mode in its state, from 1
    std::optional<Marginal> mac = {};  ///< MAC of measured and computed shape, over the draws
    /// Effect of omitting this mode: KL(posterior ‖ posterior without the mode) [nats], and the
    /// resulting probability of the most probable model. `reliable` is true if the effective sample
    /// size suffices. Both numbers are NaN for an unmeasured mode.
    double information = std::numeric_limits<double>::quiet_NaN();
    double probability_without = std::numeric_limits<double>::quiet_NaN();
    bool reliable = true;
  };
  std::vector<Mode> modes;
  std::vector<ShapesBeside> shapes = {};  ///< shapes at the best draw, for each state with measured
                                          ///< shapes
  /// P(χ² of replicated data > χ² of the data); small if no model fits.
  double posterior_predictive_p = 0.0;
};

struct EmulatorFinding {
  struct Mode {
    double rmse, max_error, q2, relative_rmse;
    double noise;                         ///< sd of the measurement [Hz]; NaN if unknown
    std::optional<double> leave_one_out;  ///< RMSE
    std::optional<emulator::StandardisedResiduals> standardised;
  };
  struct Count {
    std::string kind;  ///< "multilinear in r, 10 sites x 4 levels"
    long runs;
    std::vector<Mode> modes;
    std::vector<int> blind;  ///< numbers (from 1) of modes that the emulator cannot predict
    int worst_mode = 0;      ///< mode with the largest RMSE divided by the noise sd; 0 if the noise
                             ///< is unknown
    double rmse_to_noise = 0.0, largest_to_noise = 0.0;
  };
  std::vector<Count> counts;  ///< entry i for i + 1 damages
  // Values for a finished run:
  bool exact = false;
  bool error_in_likelihood = true;
  long training_calls = 0, validation_calls = 0, likelihood_calls = 0;
  std::optional<EmulatorCheck> check;
};

struct DamageFindings : Findings {
  std::vector<KindFinding> kinds;
  /// For a symmetric beam, one entry per model: locations are measured from the nearer end, and
  /// components are sorted by this distance. Otherwise, means would average over mirror images.
  std::vector<std::vector<ParameterFinding>> folded;
  std::vector<MergedFinding> merged;  ///< merged damages, for kinds whose damages cover a fixed
                                      ///< length
  std::optional<SymmetryFinding> symmetry;
  std::optional<FitFinding> fit;
  std::optional<EmulatorFinding> emulator;
  std::optional<BaselineFindings> baseline;    ///< findings on the intact structure
  std::optional<DrawnModes> drawn_modes = {};  ///< modes of the intact structure, for figures

  /// The merged damages of a kind; nullptr if there are none.
  [[nodiscard]] const MergedFinding* merged_of(int kind) const {
    const auto found = std::ranges::find(merged, kind, &MergedFinding::kind);
    return found == merged.end() ? nullptr : &*found;
  }
  /// Returns the estimates of a model's defects for the output: `folded` if available.
  [[nodiscard]] const std::vector<ParameterFinding>& shown(std::size_t model) const {
    return !folded.empty() && !folded[model].empty() ? folded[model] : models[model].parameters;
  }
};

/// Errors of an emulator on holdout FE runs, for each number of damages and each mode. `noise` is
/// the measurement sd [Hz] of each mode, or empty if unknown.
[[nodiscard]] EmulatorFinding emulator_finding(const FrequencyEmulator& emulator,
                                               const std::vector<double>& noise);
/// Measurement sd [Hz] of each mode: the sd of the data or, if there are no data yet, cv times
/// `intact`; empty if both are unknown.
[[nodiscard]] std::vector<double> measurement_noise(const DamageCase& damage_case,
                                                    std::span<const double> intact);

/// Error variances [Hz²] of the emulator for consecutive draws, one per mode; empty if the
/// likelihood uses no emulator. A slow emulator is evaluated at every 50th draw and at the first
/// draw of each model. For all other draws, the last result for the same model is used. The problem
/// must outlive this object.
class EmulatorVariances {
 public:
  explicit EmulatorVariances(const DamageProblem& problem);
  /// Variances for the next draw; valid until the next call.
  [[nodiscard]] std::span<const double> next(int model, std::span<const double> x);

 private:
  std::optional<StructuralPredictor> predictor_;
  long stride_, visited_ = 0;
  Prediction predicted_;
  std::vector<std::vector<double>> last_;  // per model
};

/// Computes the findings. `posterior` must have at least 4 draws per chain and chains of equal
/// length.
[[nodiscard]] DamageFindings damage_findings(const DamageProblem& problem,
                                             const inference::Posterior& posterior,
                                             const std::vector<MethodEvidence>& evidence,
                                             std::uint64_t seed);

}  // namespace wheeltap::identification
