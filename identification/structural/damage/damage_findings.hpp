// What a damage run found: how many, where on the beam and how bad, and what the data cannot say.
#pragma once

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "identification/findings/findings.hpp"
#include "identification/structural/damage/baseline_findings.hpp"
#include "identification/structural/damage/damage_problem.hpp"
#include "identification/structural/damage/emulator_check.hpp"
#include "identification/structural/damage/merged_damages.hpp"
#include "identification/structural/drawn_modes.hpp"
#include "identification/structural/likelihood/mode_contributions.hpp"

namespace wheeltap::identification {

/// A stretch of beam, or of one member, that holds a tenth of a defect or more.
struct Place {
  int stretch = 0;  ///< of the kind's line: which member, joint, storey
  double from, to;  ///< [m]
  double expected;  ///< number of defects
  Marginal location;
  std::optional<Marginal> severity;     ///< where it is not known
  std::optional<Marginal> extent = {};  ///< [m], where it is not known
};

/// Where the defects of one kind are.
struct KindFinding {
  std::vector<double> expected;                    ///< number of defects in each element
  std::map<int, std::vector<double>> given_count;  ///< the same where there are so many (> 0)
  std::vector<Place> places;
};

/// A beam that is its own mirror image, or a structure that is its own image: frequencies cannot
/// tell x from L - x, or what is alike.
struct SymmetryFinding {
  struct Chain {
    double left, right;  ///< expected number of defects before and beyond their images on the line
    double mcse_of_difference;
  };
  double center;  ///< [m], of a beam
  bool emulated;  ///< an emulator takes part in the likelihood
  std::vector<Chain> chains;
  std::vector<std::vector<std::string>> alike = {};  ///< of a structure; as SiteSymmetries
  std::vector<std::string> turned = {};
};

struct FitFinding {
  struct Mode {
    double observed, sd;           ///< [Hz]; NaN where not measured, or where the noise is inferred
    double mean, q2_5, q97_5;      ///< predicted [Hz]
    double standardised_residual;  ///< posterior mean; NaN where not measured
    std::string state = {};        ///< where there are several
    int mode = 0;                  ///< as measured in its state, from 1
    std::optional<Marginal> mac = {};  ///< of its shape and the model's, over the draws
    /// What the posterior would lose without this mode: KL(posterior ‖ without) [nats], and the
    /// probability that the most probable model would have. `reliable`: the draws can be reweighted
    /// so. NaN where it was not measured.
    double information = std::numeric_limits<double>::quiet_NaN();
    double probability_without = std::numeric_limits<double>::quiet_NaN();
    bool reliable = true;
  };
  std::vector<Mode> modes;
  std::vector<ShapesBeside> shapes = {};  ///< of each state with shapes, at the best draw
  /// P(χ² of a replicate > χ² of the data), both about the model: small where nothing fits.
  double posterior_predictive_p = 0.0;
};

struct EmulatorFinding {
  struct Mode {
    double rmse, max_error, q2, relative_rmse;
    double noise;                         ///< sd [Hz]; NaN: not known
    std::optional<double> leave_one_out;  ///< RMSE
    std::optional<emulator::StandardisedResiduals> standardised;
  };
  struct Count {
    std::string kind;  ///< "multilinear in r, 10 sites x 4 levels"
    long runs;
    std::vector<Mode> modes;
    std::vector<int> blind;  ///< modes (from 1) that it cannot predict
    int worst_mode = 0;      ///< by RMSE in terms of the noise; 0 where that is not known
    double rmse_to_noise = 0.0, largest_to_noise = 0.0;
  };
  std::vector<Count> counts;  ///< entry i for i + 1 damages
  // Of a run:
  bool exact = false;
  bool error_in_likelihood = true;
  long training_calls = 0, validation_calls = 0, likelihood_calls = 0;
  std::optional<EmulatorCheck> check;
};

struct DamageFindings : Findings {
  std::vector<KindFinding> kinds;
  /// For a symmetric beam, one entry a model: locations counted from the nearer end, and the
  /// components ordered by that, since the plain estimates average over mirror images.
  std::vector<std::vector<ParameterFinding>> folded;
  std::vector<MergedFinding> merged;  ///< of kinds whose damages cover a fixed length
  std::optional<SymmetryFinding> symmetry;
  std::optional<FitFinding> fit;
  std::optional<EmulatorFinding> emulator;
  std::optional<BaselineFindings> baseline;    ///< where there are states
  std::optional<DrawnModes> drawn_modes = {};  ///< of the intact structure, for figures

  /// Of one kind; nullptr where there is nothing to merge.
  [[nodiscard]] const MergedFinding* merged_of(int kind) const {
    const auto found = std::ranges::find(merged, kind, &MergedFinding::kind);
    return found == merged.end() ? nullptr : &*found;
  }
  /// Estimates of a model's defects to be shown: folded where there are any.
  [[nodiscard]] const std::vector<ParameterFinding>& shown(std::size_t model) const {
    return !folded.empty() && !folded[model].empty() ? folded[model] : models[model].parameters;
  }
};

/// Errors of an emulator on held-out FE runs, per count and mode. `noise` [Hz] is the measurement's
/// sd of each mode, empty where not known.
[[nodiscard]] EmulatorFinding emulator_finding(const FrequencyEmulator& emulator,
                                               const std::vector<double>& noise);
/// The measurement's sd [Hz] of each mode: the data's, or cv times `intact` where there are none
/// yet; empty where neither is known.
[[nodiscard]] std::vector<double> measurement_noise(const DamageCase& damage_case,
                                                    std::span<const double> intact);

/// Variances [Hz²] of the emulator's error at one draw after another, one a mode; empty where none
/// takes part in the likelihood. A slow emulator is asked at every 50th draw and where a model is
/// new, and what it said last of a model stands for those between. Refers to the problem.
class EmulatorVariances {
 public:
  explicit EmulatorVariances(const DamageProblem& problem);
  /// Of the next draw; good until the one after.
  [[nodiscard]] std::span<const double> next(int model, std::span<const double> x);

 private:
  std::optional<StructuralPredictor> predictor_;
  long stride_, visited_ = 0;
  Prediction predicted_;
  std::vector<std::vector<double>> last_;  // of each model
};

/// `posterior` must have at least 4 draws a chain, all chains the same.
[[nodiscard]] DamageFindings damage_findings(const DamageProblem& problem,
                                             const inference::Posterior& posterior,
                                             const std::vector<MethodEvidence>& evidence,
                                             std::uint64_t seed);

}  // namespace wheeltap::identification
