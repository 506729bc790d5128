// A plan of a modal test: what designs would detect, which sensors to use, and what more is worth.
//
// Data flow: case -> modes of the structure with one defect at every place (exact reanalysis) ->
// normal data of a design -> evidences of simulated tests -> scores -> choice of sensors ->
// findings.
#pragma once

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
  int choose = 0;  ///< sensors; fewer than 2: frequencies alone
  double false_alarm = 0.05;
  double tolerance = 0.05;                  ///< [m]
  std::vector<double> record_lengths = {};  ///< further ones [s]
  std::optional<TestCosts> costs = {};
  std::vector<std::vector<int>> layouts = {};  ///< from the user, to compare
};

struct PlanOptions {
  int scenarios = 100'000;  ///< for the ten best designs
  std::uint64_t seed = 1;
  int threads = 1;
  int tests_per_place = 100;
  std::function<void(const char* stage, double fraction)> progress = {};
};

/// A design with its scores.
struct ScoredDesign {
  std::string name;  ///< criterion or variation: "effective independence", "9 modes"
  TestDesign design = {};
  double seconds = 0.0;
  int modes = 0;
  TestScores scores = {};
};

struct PlanFindings {
  std::vector<double> frequencies_hz;  ///< measured modes of the intact structure
  std::vector<double> frequency_cov;
  double shape_sd = 0.0;
  std::vector<int> without_shapes;    ///< modes (from 0) so close that only frequencies are used
  double probability_damaged = 0.0;   ///< prior
  std::vector<ScoredDesign> designs;  ///< chosen by expected information, best first
  std::vector<ScoredDesign> others;   ///< other criteria and layouts of the user
  ScoredDesign frequencies_alone;
  SensorChoice search;
  int scenarios = 0, variation_scenarios = 0;
  std::vector<ScoredDesign> by_sensors;                    ///< first n sensors of the greedy path
  std::vector<ScoredDesign> by_length, by_modes, by_mass;  ///< variations of the best design
  std::vector<PlaceDetection> places;                      ///< for the best design
  Confusion confusion, confusion_alone;                    ///< best design, and frequencies alone
  Separations separations, separations_alone;
  /// Root mean square difference, in standard errors per datum, between two simulated defects and
  /// the model of NormalTest: median and 90 % quantile.
  double interaction_median = 0.0, interaction_high = 0.0;
  std::vector<TestOption> options;  ///< with costs
  std::optional<ValueFindings> value;
};

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

/// Throws InvalidInput for a case that allows no plan: more than two defects at once, no intact
/// structure among the counts, no damage.
[[nodiscard]] PlanFindings make_plan(const PlanCase& plan, const PlanModel& model,
                                     const PlanOptions& options);

}  // namespace wheeltap::identification::planning
