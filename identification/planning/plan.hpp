// A plan of a modal test: detectable damage for each design, choice of sensors, and value of
// further sensors, modes or records.
//
// Data flow: case -> modes of the structure with one defect at every location (exact reanalysis) ->
// normal data of a design -> evidences of simulated tests -> scores -> choice of sensors ->
// findings.
#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "identification/planning/detectability.hpp"
#include "identification/planning/sensor_choice.hpp"
#include "identification/planning/test_value.hpp"

namespace wheeltap::identification::planning {

struct PlanCase {
  DamageCase damage_case = {};
  PlannedStructureOptions structure = {};
  TestNoise noise = {};
  int choose = 0;  ///< number of sensors; fewer than 2: frequencies only
  double false_alarm = 0.05;
  double tolerance = 0.05;                  ///< largest error of a correct location [m]
  std::vector<double> record_lengths = {};  ///< further record lengths to compare [s]
  std::optional<TestCosts> costs = {};
  std::vector<std::vector<int>> layouts = {};  ///< the user's sensor layouts, for comparison
};

struct PlanOptions {
  int scenarios = 100'000;  ///< number of simulated tests for each of the ten best designs
  std::uint64_t seed = 1;
  int threads = 1;
  int tests_per_place = 100;
  std::function<void(const char* stage, double fraction)> progress = {};
};

/// A test design with its estimated performance.
struct ScoredDesign {
  std::string name;  ///< criterion or variation: "effective independence", "9 modes"
  TestDesign design = {};
  double seconds = 0.0;
  int modes = 0;
  TestScores scores = {};
};

struct PlanFindings {
  std::vector<double> frequencies_hz;  ///< frequencies of the measured modes, intact structure
  std::vector<double> frequency_cov;
  double shape_sd = 0.0;  ///< sd of shape entries: median over the modes
  /// Median sd of shape entries if the largest entry at the sensors of the best design is 1.
  double measured_shape_sd = 0.0;
  std::vector<int> without_shapes;   ///< close modes (from 0): only frequencies are used
  double probability_damaged = 0.0;  ///< prior probability of at least one defect
  /// Designs that the search found, sorted by P(right count and location), best first. A classical
  /// layout that is better than all designs found by the search is first in the list.
  std::vector<ScoredDesign> designs;
  std::vector<ScoredDesign> others;  ///< designs by other criteria, and the user's layouts
  ScoredDesign frequencies_alone;
  SensorChoice search;
  int scenarios = 0, variation_scenarios = 0;
  std::vector<ScoredDesign> by_sensors;                    ///< greedy designs by number of sensors
  std::vector<ScoredDesign> by_length, by_modes, by_mass;  ///< variations of the best design
  /// Probabilities of detection at each location, for the best design
  std::vector<PlaceDetection> places;
  /// Locations that the test cannot distinguish, and changes of the test that distinguish them. For
  /// the best design; with suffix `alone`: for a test that measures frequencies only
  Confusion confusion, confusion_alone;
  Separations separations, separations_alone;
  /// Root mean square error per datum, in standard errors, of the mean data that NormalTest assumes
  /// for two simulated defects: median and 90 % quantile.
  double interaction_median = 0.0, interaction_high = 0.0;
  /// Root mean square difference per datum, in standard errors, between the effect of the unknown
  /// coefficients and its linear approximation: median and 90 % quantile.
  double unknown_median = 0.0, unknown_high = 0.0;
  std::vector<TestOption> options;  ///< tests that are compared, if the case has costs
  std::optional<ValueFindings> value;
};

/// Smallest number of simulated tests for a design that is compared with the recommended design.
inline constexpr int kFewestVariationTests = 1000;
inline constexpr int kMostVariationTests = 5000;  ///< the largest number
/// Number of simulated tests for each variation of the recommended design.
[[nodiscard]] constexpr int variation_tests(int scenarios) {
  return std::clamp(scenarios / 10, kFewestVariationTests, kMostVariationTests);
}

struct PlanCheck {
  double largest_cov = 0.0;  ///< largest relative standard deviation of a measured frequency
  int models = 0;            ///< number of defect counts with a positive prior probability
};
/// Checks a case without simulating tests. Throws InvalidInput as PlanModel does.
[[nodiscard]] PlanCheck check_plan(const PlanCase& plan);

/// The structure, its predictions and the source of simulated tests that a plan uses.
class PlanModel {
 public:
  /// Throws InvalidInput.
  PlanModel(const PlanCase& plan, const PlanOptions& options);

  [[nodiscard]] const PlannedStructure& structure() const { return structure_; }
  [[nodiscard]] const PlacePredictions& predictions() const { return predictions_; }
  [[nodiscard]] const ScenarioSource& source() const { return source_; }

 private:
  PlannedStructure structure_;
  PlacePredictions predictions_;
  ScenarioSource source_;
};

/// Estimates the processor time of make_plan [s] from the measured times of the construction of one
/// PlanModel and of some simulated tests. Throws InvalidInput as PlanModel does.
[[nodiscard]] double estimate_seconds(const PlanCase& plan, const PlanOptions& options);

/// Chooses sensors for the case, from fewer locations and severities than PlanModel uses.
[[nodiscard]] SensorChoice search_sensors(const PlanCase& plan, const PlanOptions& options);

/// Makes the plan. Throws InvalidInput for a case with more than two simultaneous defects, and for
/// models that do not include the intact structure, or include no other model.
[[nodiscard]] PlanFindings make_plan(const PlanCase& plan, const PlanModel& model,
                                     const PlanOptions& options);

}  // namespace wheeltap::identification::planning
