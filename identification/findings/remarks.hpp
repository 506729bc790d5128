// Remarks on the findings. Each remark is a type with its numbers; apps/ contains the texts.
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

/// The likelihood was NaN or +∞ at `places` of `evaluated` points, which count as impossible.
struct ImpossibleLikelihoods {
  long places, evaluated;
};
/// A method could not compute the evidence of a model.
struct EvidenceFailed {
  EvidenceMethod method;
  std::string model;
  inference::EvidenceWarning why;
};
/// The model probability implied by a method's evidences differs from that of the draws by more
/// than 3 of their combined errors.
struct EvidenceDisagrees {
  EvidenceMethod method;
  std::string model;
  double sampled, sampled_error, implied, implied_error;
};

/// Posteriors that nearly repeat their priors (ParameterFinding::prior_overlap).
struct NearlyPrior {
  struct Parameter {
    std::string model, name;
    double overlap;
  };
  std::vector<Parameter> parameters;
};

// ---- structures ---------------------------------------------------------------------------

/// A material outside the range of real ones: probably a number in another unit.
struct ImplausibleMaterial {
  enum class Property { young, density, speed_of_sound };

  std::string of;  ///< "the beam", "member \"left post\""
  Property property;
  double value, lowest, highest;  ///< SI
  std::string unit = {};          ///< unit in which the number would be plausible; empty: none
  double converted = 0.0;         ///< the value in that unit, converted to SI
};
/// A section whose height exceeds the length of the beam, or far exceeds the length of the member.
struct DeepSection {
  std::string of;
  double height, length;  ///< [m]
};
struct TwinMembers {
  std::string first, second, from, to;
};
/// Nodes joined by neither a member nor a spring.
struct UnusedNodes {
  std::vector<std::string> nodes = {};
};
/// Members that intersect where the model has no common node.
struct CrossingMembers {
  struct Pair {
    std::string first, second;
    std::array<double, 3> at;  ///< [m]
    bool between;  ///< the intersection is inside at least one member; else two nodes coincide
  };
  std::vector<Pair> pairs = {};  ///< the first few
  int count = 0;                 ///< number of such pairs
  int dimension = 3;
};
/// Sensors, numbered from 1, with the same place and direction.
struct SensorsAtOnePlace {
  struct Pair {
    int first, second;
    std::string name;
  };
  std::vector<Pair> pairs = {};
};

// ---- damages ------------------------------------------------------------------------------

/// Measured frequencies outside the range of the prior's damages: `ratio` is the median over the
/// modes of measured to nearest predicted frequency.
struct FrequenciesOutOfReach {
  double ratio;
  double measured, lowest, highest;  ///< first such mode: measured, predicted range [Hz]
  int mode;                          ///< numbered from 1
};
/// The stated noise of every frequency exceeds the effect of the prior's damages, which is at most
/// `effect`.
struct NoiseHidesDamage {
  double cv, effect;  ///< for the mode most sensitive to damage; `effect` relative to its noise
};

/// Mirror images are equally probable; a preference for one side is an effect of the emulator.
struct MirrorImages {
  bool emulated;
};
/// The structure is symmetric: groups of equivalent parts, by name, and members that a symmetry
/// reverses.
struct StructureImages {
  std::vector<std::vector<std::string>> alike;
  std::vector<std::string> turned;
};
/// Mutually exclusive places of damage, most probable first: one of them is damaged, and the data
/// do not determine which one.
struct RivalPlaces {
  struct Place {
    int kind;  ///< index in the case's list
    std::string name;
    double probability;
  };
  std::vector<Place> places = {};
};
/// A model has at least as many unknowns as data, and no simpler model has a notable probability.
struct FittedNotTested {
  std::string model;
  int unknowns, frequencies;
};
/// The neighbour of a place: an end of the beam, a support, a clamp or another defect.
struct Landmark {
  enum class Kind { left_end, right_end, support, clamp, defect };
  Kind kind;
  double at;         ///< [m]
  std::string name;  ///< name of the defect's kind
};
/// A model with at least as many unknowns as data that cannot be excluded against a simpler one;
/// `hidden`: where a further defect of each kind could be.
struct CannotExclude {
  struct Hidden {
    std::string kind;
    Landmark below, above;
    double from, to;  ///< 95 % interval of its location [m]
  };
  std::string model;
  double probability;
  int unknowns, frequencies;
  std::vector<Hidden> hidden;
};
/// The posterior predictive p is below 0.005, although the data count as explained (FitVerdict).
/// `off`: modes (from 1) that deviate by more than 3 sd.
struct NoModelFits {
  std::vector<int> off;
  bool emulated;
};
/// Adjacent damages of a fixed extent act as one longer damage (MergedFinding).
struct NeighbouringDamages {
  int kind;  ///< index in the case's list
};
/// Half the probability or more is at the largest count allowed.
struct LargestCount {
  int kind;  ///< index in the case's list
  double probability;
};
/// A quarter of a kind's severities lie in the prior's upper 2.3 %.
struct SeverityAtBound {
  int kind;
};
/// An emulator for this many damages cannot predict these modes (Q² < 0.9).
struct EmulatorBlind {
  int damages;
  std::vector<int> modes;
};
/// The FE solution would give a different result; see EmulatorCheck.
struct EmulatorMoved {};

// ---- equations of motion ------------------------------------------------------------------

/// A simulated record has parameters that their priors exclude.
struct TruthOutsidePriors {
  struct Parameter {
    std::string name;
    double value;
    std::string prior;  ///< Prior::describe
  };
  std::vector<Parameter> parameters;
};
/// Responses whose measured size is outside the range of the prior's draws in every model.
struct ResponsesOutOfReach {
  struct Channel {
    std::string name;
    double measured, lowest, highest;  ///< root mean squares [SI]
  };
  std::vector<Channel> channels;
};
/// The stated noise is larger than the response itself.
struct NoiseAboveResponse {
  struct Channel {
    std::string name;
    double noise, response;  ///< standard deviation, and RMS about the mean [SI]
  };
  std::vector<Channel> channels;
};
/// The window's spectra differ from the record's by more than three times their scatter.
struct PeculiarWindow {
  struct Channel {
    std::string name;
    double difference_db, scatter_db;
  };
  std::vector<Channel> channels;
};
/// Linear interpolation between samples reduces an excitation's amplitude by this share.
struct LinearExcitation {
  std::string channel;
  double loss;
};
/// Channels with an unknown unit, or one of another dimension; their numbers are used unconverted.
struct UnknownUnits {
  struct Channel {
    std::string name, unit, dimension, known;
  };
  std::vector<Channel> channels;
};
/// Time steps are uneven, but by less than the limit for rejection.
struct UnevenTime {
  signals::Sampling sampling;
};
/// Responses are absolute: the base displacement was integrated from its acceleration.
struct BaseIntegrated {};
/// The most probable model does not explain the record; a less probable one does.
struct MostProbableFails {
  std::string model, other;
  std::vector<misfit::Reason> why;
};
/// The best draw reproduces almost nothing of a response and the residuals are white: the record is
/// mostly noise.
struct MostlyNoise {
  std::string model, channel;
  double r2;
};
/// The window does not start at rest, so the initial state is also inferred.
struct InitialStateInferred {
  double share;  ///< share of the response's RMS in the window's first samples
};

/// With steps a quarter as long, the best draw's response changes by `error` of the noise.
struct StepsTooLong {
  std::string model;
  double error;
  bool fixed;  ///< the case fixes the steps, so the run could not be repeated
};
/// The parameters' means fit the record worse than the best draw: NRMSE of both per channel.
struct MeansDoNotGoTogether {
  struct Channel {
    std::string name;
    double of_means, of_best;
  };
  std::string model;
  std::vector<Channel> channels;
};
/// Residuals differ from the stated noise by these factors.
struct NoiseMisstated {
  struct Channel {
    std::string name;
    double factor;
  };
  std::string model;
  std::vector<Channel> channels;
};
/// Residuals are not white; those of `others`, less probable models, are similar.
struct ColouredResiduals {
  std::string residual_model = {};  ///< name, if the residuals are its innovations; empty: white
  std::string remedy = {};          ///< suggested by the residual model; may be empty

  struct Channel {
    std::string name;
    int lag;  ///< lag of the largest autocorrelation
    double autocorrelation;
    double share;  ///< RMS of residual over RMS of response
    double p_value;
  };
  std::string model;
  std::vector<Channel> channels;
  std::vector<std::string> others = {};
};
/// Parameters scatter between windows by these factors more than each window's interval allows.
struct ScatterBetweenWindows {
  struct Parameter {
    std::string name;
    double factor;
  };
  std::string model;
  int windows;
  std::vector<Parameter> parameters;
};
/// Windows whose fit failed, and parameters for which the normal approximation is inaccurate in
/// many windows.
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

/// In all records, the motion ends before a one-sided law (for example a stop) acts: in `share` of
/// the model's draws the gap never closes.
struct StopNotReached {
  std::string model, law;
  int a, b;      ///< the masses that its link joins
  bool opening;  ///< the side on which the law acts
  double reach;  ///< largest extension to that side in the motion at the model's means [m]
  double share;
};

/// A model error that is equal in all states cancels, so estimated changes do not include it.
struct ChangesTakenForExact {
  double discrepancy;  ///< relative, of frequencies
};
/// A measured mode that may not belong to the structure.
struct SpuriousMode {
  int mode = 0;  ///< measured mode, from 1
  double hz = 0.0, probability = 0.0;
};

}  // namespace remark

/// Reported from this probability on.
inline constexpr double kSpurious = 0.05;

using Remark =
    std::variant<remark::ImpossibleLikelihoods, remark::EvidenceFailed, remark::EvidenceDisagrees,
                 remark::NearlyPrior, remark::ImplausibleMaterial, remark::DeepSection,
                 remark::TwinMembers, remark::UnusedNodes, remark::CrossingMembers,
                 remark::SensorsAtOnePlace, remark::FrequenciesOutOfReach, remark::NoiseHidesDamage,
                 remark::MirrorImages, remark::StructureImages, remark::RivalPlaces,
                 remark::FittedNotTested, remark::CannotExclude, remark::NoModelFits,
                 remark::NeighbouringDamages, remark::LargestCount, remark::SeverityAtBound,
                 remark::EmulatorBlind, remark::EmulatorMoved, remark::TruthOutsidePriors,
                 remark::ResponsesOutOfReach, remark::NoiseAboveResponse, remark::PeculiarWindow,
                 remark::LinearExcitation, remark::UnevenTime, remark::UnknownUnits,
                 remark::BaseIntegrated, remark::MostlyNoise, remark::InitialStateInferred,
                 remark::StepsTooLong, remark::MeansDoNotGoTogether, remark::NoiseMisstated,
                 remark::MostProbableFails, remark::ColouredResiduals, remark::ParameterAtBound,
                 remark::ScatterBetweenWindows, remark::WindowsUnsound,
                 remark::ChangesTakenForExact, remark::SpuriousMode, remark::StopNotReached>;

}  // namespace wheeltap::identification
