// Smallest detectable severity of every place, and places that a test confuses.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identification/planning/scenarios.hpp"

namespace wheeltap::identification::planning {

/// Detection of one defect at one place.
struct PlaceDetection {
  int place = 0;
  std::vector<double> severities;       ///< ascending
  std::vector<TestEstimate> detection;  ///< P(detected) at each
  std::vector<TestEstimate> right;      ///< P(detected, count and place right)
  /// Severity at which P(detected) reaches 0.9, by isotonic regression and linear interpolation;
  /// none if the largest severity of the prior does not reach it.
  std::optional<double> smallest;
  /// The same for the upper and lower ends of the 95 % intervals (Wilson) of P(detected).
  std::optional<double> smallest_low, smallest_high;
};

struct DetectabilityOptions {
  int tests = 100;          ///< per place and severity
  double threshold = 0.0;   ///< for the log odds
  double tolerance = 0.05;  ///< [m]
  int threads = 1;
  std::uint64_t seed = 1;
};

/// Simulates tests at every place and quantile of the severity. Four bisections add severities
/// where P(detected) reaches 0.9. If all tests at two successive severities are detected, the
/// function counts all tests at larger severities as detected.
[[nodiscard]] std::vector<PlaceDetection> detect_everywhere(const ScenarioSource& source,
                                                            const PlacePredictions& predictions,
                                                            const PreparedDesign& design,
                                                            const DetectabilityOptions& options);

/// Two regions of places that a test confuses.
struct ConfusedRegions {
  struct Region {
    int kind = 0, stretch = 0;
    double start = 0.0, end = 0.0;  ///< [m]; 0 for points
    std::string name;               ///< "beam, 0.1 to 0.4 m"
  };
  Region first, second;
  int pairs = 0;       ///< confused pairs of places
  bool exact = false;  ///< their predictions are equal: images of a symmetry
};

/// The length within which places of a member cannot be told apart.
struct PlaceResolution {
  std::string name;  ///< member
  double metres = 0.0;
};

struct Confusion {
  std::vector<ConfusedRegions> regions;
  std::vector<PlaceResolution> resolutions;
  std::vector<std::pair<int, int>> pairs;  ///< places of the regions
  std::vector<int> undetectable;           ///< places whose largest damage has no visible effect
};

/// Two places are confused if the largest defect of the prior at one of them is closer than
/// `kDistance` standard errors to some defect at the other. With equal priors, a test then takes at
/// least Φ(-1) = 16 % of such defects for the other. Confused places within `tolerance`, or
/// connected by confused places of one member, count as resolution, the others as regions.
[[nodiscard]] Confusion find_confusion(const PlannedStructure& structure, const NormalTest& test,
                                       double tolerance);
inline constexpr double kDistance = 2.0;

/// A change of the design that separates confused places.
struct Separation {
  std::vector<int> sensors;   ///< additional ones
  int mass = -1;              ///< or this added mass
  int separated = 0, of = 0;  ///< pairs
};
/// The cheapest separation by sensors, and the best single mass: of the changes that separate the
/// most pairs (within 5 %), the cheapest, then the one with the largest distances. Fewer than two
/// sensors carry no shape, so a design with n < 2 sensors gets 2 - n, otherwise 1. `costs`: per
/// candidate; empty: equal. Empty if no change separates a pair.
struct Separations {
  std::optional<Separation> by_sensors, by_mass;
};
[[nodiscard]] Separations find_separations(const PlannedStructure& structure,
                                           const PlacePredictions& predictions,
                                           const TestNoise& noise, const TestDesign& design,
                                           const std::vector<std::pair<int, int>>& pairs,
                                           const std::vector<double>& costs, int threads);

}  // namespace wheeltap::identification::planning
