// Remarks on the findings. Each remark is a type with numbers as members; apps/ contains the
// sentences of the remarks.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "identification/findings/fit_verdict.hpp"
#include "inference/model/evidence_warning.hpp"
#include "signals/record.hpp"

namespace wheeltap::identification {

/// Methods that compute the evidence of each model separately, on request.
enum class EvidenceMethod { tmcmc, bridge, laplace };

namespace remark {

// ---- all runs -----------------------------------------------------------------------------

/// For `places` of the `evaluated` parameter vectors, the likelihood was NaN or +∞. The likelihood
/// of these parameter vectors is set to zero.
struct ImpossibleLikelihoods {
  long places, evaluated;
};
/// A method could not compute the evidence of a model.
struct EvidenceFailed {
  EvidenceMethod method;
  std::string model;
  inference::EvidenceWarning why;
};
/// The probability of a model from a method's evidences and its probability from the draws differ
/// by more than 3 combined standard errors.
struct EvidenceDisagrees {
  EvidenceMethod method;
  std::string model;
  double sampled, sampled_error, implied, implied_error;
};

/// Parameters whose posteriors are nearly equal to their priors (ParameterFinding::prior_overlap).
struct NearlyPrior {
  struct Parameter {
    std::string model, name;
    double overlap;
  };
  std::vector<Parameter> parameters;
};

/// Parameters whose standard deviation depends on rare outlying draws: the relative Monte Carlo
/// standard error of the standard deviation exceeds kUncertainSpread.
struct UncertainSpread {
  struct Parameter {
    std::string model, name;
    double error;  ///< relative Monte Carlo standard error of the standard deviation
  };
  std::vector<Parameter> parameters;
};

// ---- structures ---------------------------------------------------------------------------

/// A material property outside the range of real materials. The unit is probably wrong.
struct ImplausibleMaterial {
  enum class Property { young, density, speed_of_sound };

  std::string of;  ///< part of the structure: "the beam", "member \"left post\""
  Property property;
  double value, lowest, highest;  ///< value and its plausible range in SI units
  std::string unit = {};          ///< unit in which the number would be plausible; empty: none
  double converted = 0.0;         ///< the number interpreted in `unit`, converted to SI units
};
/// A section whose depth exceeds the beam's length, or three times the member's length.
struct DeepSection {
  std::string of;
  double height, length;  ///< [m]
};
struct TwinMembers {
  std::string first, second, from, to;
};
/// Nodes to which no member and no spring is attached.
struct UnusedNodes {
  std::vector<std::string> nodes = {};
};
/// Members that intersect where the model has no common node.
struct CrossingMembers {
  struct Pair {
    std::string first, second;
    std::array<double, 3> at;  ///< [m]
    /// True if the intersection is inside at least one member. False if two nodes coincide.
    bool between;
  };
  std::vector<Pair> pairs = {};  ///< the first intersecting pairs
  int count = 0;                 ///< number of intersecting pairs
  int dimension = 3;
};
/// Sensors (numbered from 1) with the same location and the same direction.
struct SensorsAtOnePlace {
  struct Pair {
    int first, second;
    std::string name;
  };
  std::vector<Pair> pairs = {};
};

// ---- damages ------------------------------------------------------------------------------

/// Measured frequencies outside the range predicted for prior draws. `ratio` is the measured
/// frequency divided by the nearest predicted frequency: the median over modes outside their range.
struct FrequenciesOutOfReach {
  double ratio;
  /// Measured frequency of mode `mode`, and its predicted range [Hz]
  double measured, lowest, highest;
  int mode;  ///< first mode outside its range, numbered from 1
};
/// The stated noise of every frequency exceeds twice the range of its predictions for prior draws.
/// `effect` is the largest ratio of range to noise.
struct NoiseHidesDamage {
  /// Coefficient of variation of the noise; largest ratio of a range to the noise of its mode
  double cv, effect;
};

/// A damage and its mirror image have equal exact probabilities. Only the error of an emulator can
/// make the computed probabilities differ.
struct MirrorImages {
  bool emulated;
};
/// The structure is symmetric. `alike` names the groups of equivalent parts; `turned` names the
/// members whose two ends a symmetry exchanges.
struct StructureImages {
  std::vector<std::vector<std::string>> alike;
  std::vector<std::string> turned;
};
/// Mutually exclusive locations of damage, the most probable first. One of these locations is
/// damaged, but the data do not determine which one.
struct RivalPlaces {
  struct Place {
    int kind;  ///< index of the kind of defect in the case
    std::string name;
    double probability;
  };
  std::vector<Place> places = {};
};
/// The intact structure fits the data if all its frequencies are multiplied by one factor.
struct CommonFactor {
  double factor;
  double p;         ///< p of the χ² test of this fit
  int frequencies;  ///< number of measured frequencies
};
/// A model has at least as many unknowns as data, and every simpler model is improbable.
struct FittedNotTested {
  std::string model;
  int unknowns, frequencies;
};
/// The neighbour of a location: an end of the beam, a support, a clamp or another defect.
struct Landmark {
  enum class Kind { left_end, right_end, support, clamp, defect };
  Kind kind;
  double at;         ///< [m]
  std::string name;  ///< name of the kind of defect
};
/// A model with at least as many unknowns as data. The data can neither confirm nor exclude this
/// model. `hidden` gives possible locations of a further defect of each kind.
struct CannotExclude {
  struct Hidden {
    std::string kind;
    Landmark below, above;
    double from, to;  ///< 95 % credible interval of the location [m]
  };
  std::string model;
  double probability;
  int unknowns, frequencies;
  std::vector<Hidden> hidden;
};
/// The posterior predictive p is below 0.005, although FitVerdict counts the data as explained.
/// `off` lists the modes (from 1) whose frequencies deviate by more than 3 sd.
struct NoModelFits {
  std::vector<int> off;
  bool emulated;
};
/// Adjacent damages of fixed extent act like one longer damage (MergedFinding).
struct NeighbouringDamages {
  int kind;  ///< index of the kind of defect in the case
};
/// The largest allowed number of defects has a probability above one half.
struct LargestCount {
  int kind;  ///< index of the kind of defect in the case
  double probability;
  bool untested;  ///< true if a model has at least as many unknowns as data
};
/// The posterior of the severity of a defect kind piles up at the upper bound of its prior
/// (prior_bound.hpp).
struct SeverityAtBound {
  int kind;
};
/// The emulator for `damages` damages does not predict the frequencies of `modes` (Q² < 0.9).
struct EmulatorBlind {
  int damages;
  std::vector<int> modes;
};
/// With the FE model instead of the emulator, the result would differ; see EmulatorCheck.
struct EmulatorMoved {};

// ---- equations of motion ------------------------------------------------------------------

/// The priors exclude the true values of parameters of a simulated record.
struct TruthOutsidePriors {
  struct Parameter {
    std::string name;
    double value;
    std::string prior;  ///< Prior::describe
  };
  std::vector<Parameter> parameters;
};
/// Responses whose measured RMS differs by more than a factor of 30 from that of every prior draw.
struct ResponsesOutOfReach {
  struct Channel {
    std::string name;
    double measured, lowest, highest;  ///< RMS, and range of RMS over prior draws [SI]
  };
  std::vector<Channel> channels;
};
/// The stated noise of a response exceeds the RMS of the response about its mean.
struct NoiseAboveResponse {
  struct Channel {
    std::string name;
    double noise, response;  ///< standard deviation, and RMS about the mean [SI]
  };
  std::vector<Channel> channels;
};
/// The spectra of the window and of the record differ by more than three times the difference that
/// random variability explains.
struct PeculiarWindow {
  struct Channel {
    std::string name;
    double difference_db, scatter_db;
  };
  std::vector<Channel> channels;
};
/// Linear interpolation between samples lowers an excitation's amplitude by the fraction `loss`.
struct LinearExcitation {
  std::string channel;
  double loss;
};
/// Channels with an unknown unit or a unit of another physical dimension. The samples of these
/// channels are used without conversion.
struct UnknownUnits {
  struct Channel {
    std::string name, unit, dimension, known;
  };
  std::vector<Channel> channels;
};
/// Time steps are non-uniform, but the deviation is below the limit for rejection.
struct UnevenTime {
  signals::Sampling sampling;
};
/// The responses are absolute. The base displacement was therefore integrated from the base
/// acceleration.
struct BaseIntegrated {};
/// The most probable model does not explain the record, but a less probable model does.
struct MostProbableFails {
  std::string model, other;
  std::vector<misfit::Reason> why;
};
/// The best draw explains almost none of a response, and its residuals are white: the record of
/// this response is mostly noise.
struct MostlyNoise {
  std::string model, channel;
  double r2;
};
/// The structure is not at rest at the start of the window, so the initial state is also inferred.
struct InitialStateInferred {
  double share;  ///< RMS of the first samples of the window, divided by the RMS of the response
};

/// If the time step is divided by four, the response at the best draw changes by `error` times the
/// standard deviation of the noise (norm over all samples).
struct StepsTooLong {
  std::string model;
  double error;
  bool fixed;  ///< true if the case fixes the time steps, so that the run was not repeated
};
/// The posterior means of the parameters fit the record worse than the best draw does. Each channel
/// has an NRMSE for the posterior means and one for the best draw.
struct MeansDoNotGoTogether {
  struct Channel {
    std::string name;
    double of_means, of_best;
  };
  std::string model;
  std::vector<Channel> channels;
};
/// The stated noise sd of a channel is wrong: the RMS of the residuals is `factor` times this sd.
struct NoiseMisstated {
  struct Channel {
    std::string name;
    double factor;
  };
  std::string model;
  std::vector<Channel> channels;
};
/// The residuals of `model` are not white. The less probable models `others` have similar
/// residuals.
struct ColouredResiduals {
  /// Residual model whose innovations are tested; empty for white residuals
  std::string residual_model = {};
  std::string remedy = {};  ///< advice of the residual model; may be empty

  struct Channel {
    std::string name;
    int lag;  ///< lag of the largest autocorrelation
    double autocorrelation;
    double share;  ///< RMS of the residual divided by RMS of the response
    double p_value;
  };
  std::string model;
  std::vector<Channel> channels;
  std::vector<std::string> others = {};
};
/// The credible intervals in the windows imply a standard deviation of the estimates between
/// windows. The actual standard deviation is `factor` times the implied value.
struct ScatterBetweenWindows {
  struct Parameter {
    std::string name;
    double factor;
  };
  std::string model;
  int windows;
  std::vector<Parameter> parameters;
};
/// Number of windows whose fit failed, and parameters for which the normal approximation is
/// inaccurate in many windows.
struct WindowsUnsound {
  std::string model;
  int windows, failed;
  std::vector<std::string> rough;
};
/// The posterior of a parameter piles up at a bound of its prior.
struct ParameterAtBound {
  std::string model, parameter, prior;
  bool upper;
};

/// A one-sided force law (for example of a stop) produces no force in the predicted motion of any
/// record. In the fraction `share` of the model's draws, the gap of this force law never closes.
struct StopNotReached {
  std::string model, law;
  int a, b;      ///< masses at the ends of the link
  bool opening;  ///< true if the force law acts in extension, false if in compression
  /// Largest displacement of the link towards the stop, at the model's posterior means [m]
  double reach;
  double share;
};

/// The analysis assumes that the model error is the same in all states, so that this error cancels
/// in changes. Estimated changes between states therefore do not include the model error.
struct ChangesTakenForExact {
  /// Relative standard deviation of the model error of a frequency.
  double discrepancy;
};
/// A measured mode that may not belong to the structure.
struct SpuriousMode {
  int mode = 0;  ///< number of the measured mode, from 1
  double hz = 0.0, probability = 0.0;
};

}  // namespace remark

/// Smallest probability at which a spurious mode is reported.
inline constexpr double kSpurious = 0.05;

/// Smallest relative Monte Carlo error of a standard deviation that is reported.
inline constexpr double kUncertainSpread = 0.15;

/// All types of remarks.
using RemarkVariant = std::variant<
    remark::ImpossibleLikelihoods, remark::EvidenceFailed, remark::EvidenceDisagrees,
    remark::NearlyPrior, remark::UncertainSpread, remark::ImplausibleMaterial, remark::DeepSection,
    remark::TwinMembers, remark::UnusedNodes, remark::CrossingMembers, remark::SensorsAtOnePlace,
    remark::FrequenciesOutOfReach, remark::NoiseHidesDamage, remark::MirrorImages,
    remark::StructureImages, remark::RivalPlaces, remark::CommonFactor, remark::FittedNotTested,
    remark::CannotExclude, remark::NoModelFits, remark::NeighbouringDamages, remark::LargestCount,
    remark::SeverityAtBound, remark::EmulatorBlind, remark::EmulatorMoved,
    remark::TruthOutsidePriors, remark::ResponsesOutOfReach, remark::NoiseAboveResponse,
    remark::PeculiarWindow, remark::LinearExcitation, remark::UnevenTime, remark::UnknownUnits,
    remark::BaseIntegrated, remark::MostlyNoise, remark::InitialStateInferred, remark::StepsTooLong,
    remark::MeansDoNotGoTogether, remark::NoiseMisstated, remark::MostProbableFails,
    remark::ColouredResiduals, remark::ParameterAtBound, remark::ScatterBetweenWindows,
    remark::WindowsUnsound, remark::ChangesTakenForExact, remark::SpuriousMode,
    remark::StopNotReached>;

/// A remark on a result. std::visit, std::get_if and std::holds_alternative accept a Remark as
/// they accept the variant. Copies, moves and the destructor are compiled once, in remarks.cpp,
/// because their compilation takes seconds.
struct Remark : RemarkVariant {
  using RemarkVariant::RemarkVariant;
  Remark(const Remark& other);
  Remark(Remark&& other) noexcept;
  Remark& operator=(const Remark& other);
  Remark& operator=(Remark&& other) noexcept;
  ~Remark();
};

}  // namespace wheeltap::identification
