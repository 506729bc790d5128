// What a reader of the findings should keep in mind: each a type with its numbers. The words are
// the writers'.
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

/// Ways to a model's evidence that are computed on request, each model on its own.
enum class EvidenceMethod { tmcmc, bridge, laplace };

namespace remark {

// ---- of any run ------------------------------------------------------------------------------

/// The likelihood was NaN or +∞ at `places` of `evaluated`, which count as impossible.
struct ImpossibleLikelihoods {
  long places, evaluated;
};
/// A method found no evidence of a model.
struct EvidenceFailed {
  EvidenceMethod method;
  std::string model;
  inference::EvidenceWarning why;
};
/// A method's evidences imply another probability of a model than the draws do, by more than 3 of
/// their combined errors.
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

// ---- of structures ---------------------------------------------------------------------------

/// A material that no one builds with: most likely a number in another unit.
struct ImplausibleMaterial {
  enum class Property { young, density, speed_of_sound };

  std::string of;  ///< "the beam", "member \"left post\""
  Property property;
  double value, lowest, highest;  ///< SI
  std::string unit = {};          ///< in which the number would be plausible; empty: none known
  double converted = 0.0;         ///< it then is, SI
};
/// A section higher than its beam is long, or far higher than its member.
struct DeepSection {
  std::string of;
  double height, length;  ///< [m]
};
struct TwinMembers {
  std::string first, second, from, to;
};
/// Joined by neither a member nor a spring.
struct UnusedNodes {
  std::vector<std::string> nodes = {};
};
/// Members that meet between their nodes, where the model does not join them.
struct CrossingMembers {
  struct Pair {
    std::string first, second;
    std::array<double, 3> at;  ///< [m]
    bool between;              ///< nodes, of one of them at least; else two nodes are in one place
  };
  std::vector<Pair> pairs = {};  ///< the first few
  int count = 0;                 ///< of all
  int dimension = 3;
};
/// Sensors, numbered from 1, of one place and direction.
struct SensorsAtOnePlace {
  struct Pair {
    int first, second;
    std::string name;
  };
  std::vector<Pair> pairs = {};
};

// ---- of damages ------------------------------------------------------------------------------

/// Measured frequencies that no damage under the prior comes near: `ratio` is the median over the
/// modes of measured to nearest predicted.
struct FrequenciesOutOfReach {
  double ratio;
  double measured, lowest, highest;  ///< of the first of these modes, with what was predicted [Hz]
  int mode;                          ///< from 1
};
/// The stated noise of every frequency exceeds whatever the damages of the prior do to it: at most
/// `effect` of it.
struct NoiseHidesDamage {
  double cv, effect;  ///< of the mode on which damage acts most, in terms of the noise
};

/// Mirror images are equally good: what prefers a side all the same is the emulator.
struct MirrorImages {
  bool emulated;
};
/// The structure is its own image: what is alike, by name, and members that are turned upon
/// themselves.
struct StructureImages {
  std::vector<std::vector<std::string>> alike;
  std::vector<std::string> turned;
};
/// Places that exclude each other, the likeliest first: one of them is damaged, and the data do not
/// say which.
struct RivalPlaces {
  struct Place {
    int kind;  ///< its place in the case's list
    std::string name;
    double probability;
  };
  std::vector<Place> places = {};
};
/// A model with at least as many unknowns as data, and no simpler one that counts.
struct FittedNotTested {
  std::string model;
  int unknowns, frequencies;
};
/// What stands beside a place: an end of the beam, a support, a clamp, another defect.
struct Landmark {
  enum class Kind { left_end, right_end, support, clamp, defect };
  Kind kind;
  double at;         ///< [m]
  std::string name;  ///< of a defect's kind
};
/// A model with at least as many unknowns as data that cannot be excluded beside a simpler one;
/// where a further defect of each kind would hide.
struct CannotExclude {
  struct Hidden {
    std::string kind;
    Landmark below, above;
    double from, to;  ///< its location's 95 % interval [m]
  };
  std::string model;
  double probability;
  int unknowns, frequencies;
  std::vector<Hidden> hidden;
};
/// Posterior predictive p below 0.005, and not so small that nothing was explained (FitVerdict).
/// `off`: modes (from 1) that are off by more than 3 sd.
struct NoModelFits {
  std::vector<int> off;
  bool emulated;
};
/// Adjacent damages of a fixed extent act as one longer damage (MergedFinding).
struct NeighbouringDamages {
  int kind;  ///< its place in the case's list
};
/// Half the probability or more is at the largest count allowed.
struct LargestCount {
  int kind;  ///< its place in the case's list
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
/// By the FE solution the answer would be another; see EmulatorCheck.
struct EmulatorMoved {};

// ---- of equations of motion ------------------------------------------------------------------

/// The record is simulated, with parameters that their priors exclude: no run can find them.
struct TruthOutsidePriors {
  struct Parameter {
    std::string name;
    double value;
    std::string prior;  ///< Prior::describe
  };
  std::vector<Parameter> parameters;
};
/// Responses measured at a size that no draw of the prior comes near, in any model.
struct ResponsesOutOfReach {
  struct Channel {
    std::string name;
    double measured, lowest, highest;  ///< root mean squares [SI]
  };
  std::vector<Channel> channels;
};
/// A stated noise larger than the response itself.
struct NoiseAboveResponse {
  struct Channel {
    std::string name;
    double noise, response;  ///< sd and root mean square about the mean [SI]
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
/// An excitation loses this share of its amplitude by being linear between its samples.
struct LinearExcitation {
  std::string channel;
  double loss;
};
/// Channels in units that are unknown, or of something else, whose numbers are used as they are.
struct UnknownUnits {
  struct Channel {
    std::string name, unit, dimension, known;
  };
  std::vector<Channel> channels;
};
/// Time steps differ by less than what is refused.
struct UnevenTime {
  signals::Sampling sampling;
};
/// Responses are absolute, and the base's displacement was integrated from its acceleration.
struct BaseIntegrated {};
/// The most probable model does not explain the record, and another that is still possible does.
struct MostProbableFails {
  std::string model, other;
  std::vector<misfit::Reason> why;
};
/// A response that the best draw reproduces hardly at all, with residuals that are white: a record
/// of noise.
struct MostlyNoise {
  std::string model, channel;
  double r2;
};
/// The window does not start at rest, so the initial state is unknown too.
struct InitialStateInferred {
  double share;  ///< of the response's RMS, in the window's first samples
};

/// Steps a quarter as long change the best draw's response by `error` of the noise.
struct StepsTooLong {
  std::string model;
  double error;
  bool fixed;  ///< the case says how to integrate: the run could not be repeated with better ones
};
/// The means of the parameters miss the record by more than the best draw does: per channel, NRMSE
/// of both.
struct MeansDoNotGoTogether {
  struct Channel {
    std::string name;
    double of_means, of_best;
  };
  std::string model;
  std::vector<Channel> channels;
};
/// Residuals are larger or smaller than the stated noise, by these factors.
struct NoiseMisstated {
  struct Channel {
    std::string name;
    double factor;
  };
  std::string model;
  std::vector<Channel> channels;
};
/// Residuals are not white; those of `others`, less probable models, are much the same.
struct ColouredResiduals {
  std::string residual_model = {};  ///< its name, if they are its innovations; empty: white
  std::string remedy = {};          ///< that the residual model names, if any

  struct Channel {
    std::string name;
    int lag;  ///< of the largest autocorrelation, and its value
    double autocorrelation;
    double share;  ///< residual over response, root mean squares
    double p_value;
  };
  std::string model;
  std::vector<Channel> channels;
  std::vector<std::string> others = {};
};
/// Between the windows of a record, parameters scatter by more than each window's interval allows
/// for, by these factors.
struct ScatterBetweenWindows {
  struct Parameter {
    std::string name;
    double factor;
  };
  std::string model;
  int windows;
  std::vector<Parameter> parameters;
};
/// Windows that could not be fitted, and parameters along which many a window's likelihood is far
/// from the normal that stands for it.
struct WindowsUnsound {
  std::string model;
  int windows, failed;
  std::vector<std::string> rough;
};
/// A parameter leans on an end of its prior.
struct ParameterAtBound {
  std::string model, parameter, prior;
  bool upper;
};

/// The motion of all records ends before a law of one side begins to act, a stop for example: in
/// `share` of the model's draws it begins beyond.
struct StopNotReached {
  std::string model, law;
  int a, b;      ///< the masses that its link joins
  bool opening;  ///< its side
  double reach;  ///< the largest extension to that side, of the model's motion at its means [m]
  double share;
};

/// The model errs in every state alike, and what it says of changes is trusted all the same.
struct ChangesTakenForExact {
  double discrepancy;  ///< of frequencies, relative
};
/// A measured mode may be none of the structure's.
struct SpuriousMode {
  int mode = 0;  ///< as measured, from 1
  double hz = 0.0, probability = 0.0;
};

}  // namespace remark

/// From this probability on it is said.
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
