// Smallest detectable defect at every location, and locations that a test cannot distinguish.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identification/planning/scenarios.hpp"

namespace wheeltap::identification::planning {

/// Probability of detection of one defect at one location.
struct PlaceDetection {
  int place = 0;
  std::vector<double> severities;       ///< ascending
  std::vector<TestEstimate> detection;  ///< P(detected) at each severity
  /// P(detected, and count and location correct) at each severity
  std::vector<TestEstimate> right;
  /// Severity at which P(detected) reaches 0.9, by isotonic regression and linear interpolation;
  /// empty if P(detected) is below 0.9 at the largest severity of the prior.
  std::optional<double> smallest;
  /// Values of `smallest` for the upper and for the lower bounds of the 95 % confidence intervals
  /// (Wilson) of P(detected).
  std::optional<double> smallest_low, smallest_high;
};

struct DetectabilityOptions {
  int tests = 100;          ///< number of tests per location and severity
  double threshold = 0.0;   ///< log odds of damage above which a test detects damage
  double tolerance = 0.05;  ///< largest error of a correct location [m]
  int threads = 1;
  std::uint64_t seed = 1;
};

/// Simulates tests at every location and quantile of the severity. Four bisections add severities
/// near P(detected) = 0.9.
[[nodiscard]] std::vector<PlaceDetection> detect_everywhere(const ScenarioSource& source,
                                                            const PlacePredictions& predictions,
                                                            const PreparedDesign& design,
                                                            const DetectabilityOptions& options);

/// Two regions of a structure. The test cannot distinguish a damage in one region from a damage in
/// the other region.
struct ConfusedRegions {
  struct Region {
    int kind = 0, stretch = 0;
    double start = 0.0, end = 0.0;  ///< interval [m]; 0 for points
    std::string name;               ///< "beam, 0.1 to 0.4 m"
  };
  Region first, second;
  int pairs = 0;       ///< number of indistinguishable pairs of locations
  bool exact = false;  ///< true if predictions are equal because of a symmetry
};

/// The length within which a test cannot distinguish locations on a member.
struct PlaceResolution {
  std::string name;  ///< name of the member
  double metres = 0.0;
};

struct Confusion {
  std::vector<ConfusedRegions> regions;
  std::vector<PlaceResolution> resolutions;
  std::vector<std::pair<int, int>> pairs;  ///< indistinguishable pairs of locations in the regions
  std::vector<int> undetectable;           ///< locations with undetectable largest defect
};

/// A test cannot distinguish two locations if the largest defect of the prior at one location gives
/// mean data within `kDistance` standard errors of the mean data of a defect at the other location.
/// If such locations have equal priors, a test assigns at least Φ(-1) = 16 % of these defects to
/// the other location. Indistinguishable locations give the resolution of a member if they are
/// within `tolerance`, or connected by indistinguishable locations of this member. All other
/// indistinguishable locations form regions.
[[nodiscard]] Confusion find_confusion(const PlannedStructure& structure, const NormalTest& test,
                                       double tolerance);
inline constexpr double kDistance = 2.0;

/// A change of the design that makes indistinguishable locations distinguishable.
struct Separation {
  std::vector<int> sensors;   ///< additional sensors
  int mass = -1;              ///< index of the added mass; -1: additional sensors
  int separated = 0, of = 0;  ///< number of pairs that become distinguishable, of examined pairs
};
/// The cheapest additional sensors, and the best single added mass. Among the changes that
/// distinguish the most pairs (within 5 %), the cheapest is chosen. At equal cost, the change with
/// the largest distances between data is chosen. A design with n < 2 sensors, which measure no
/// shape, gets 2 - n additional sensors; other designs get one. `costs`: one per candidate; empty:
/// equal costs. `by_sensors` or `by_mass` is empty if no change of this type distinguishes a pair.
/// Pairs of additional sensors use at most 32 candidates: those with the lowest costs and, at equal
/// costs, the largest Σ φ² over the modes.
struct Separations {
  std::optional<Separation> by_sensors, by_mass;
};
[[nodiscard]] Separations find_separations(const PlannedStructure& structure,
                                           const PlacePredictions& predictions,
                                           const TestNoise& noise, const TestDesign& design,
                                           const std::vector<std::pair<int, int>>& pairs,
                                           const std::vector<double>& costs, int threads);

}  // namespace wheeltap::identification::planning
