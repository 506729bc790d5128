// Value of the information that a test gives, for given costs.
#pragma once

#include <string>
#include <vector>

#include "identification/planning/test_scores.hpp"

namespace wheeltap::identification::planning {

/// Costs, all in the same currency.
struct TestCosts {
  double sensor = 0.0;                  ///< cost per sensor used
  std::vector<double> of_sensors = {};  ///< cost of a sensor at each candidate; replaces `sensor`
  double hour = 0.0;                    ///< cost per hour of record
  double added_mass = 0.0;              ///< cost of a second configuration with an added mass
  double inspection = 0.0;              ///< cost of an inspection, which finds any damage
  double missed = 0.0;                  ///< cost of damage that is not found
  double false_alarm = 0.0;             ///< cost of a false alarm, not including the inspection
};

/// A possible test, with its estimated performance.
struct TestOption {
  std::string name;  ///< "4 sensors, 600 s"
  std::vector<int> sensors;
  double seconds = 0.0;
  bool mass = false;
  TestScores scores = {};
};

/// The decision rule after a test: inspect if the test raises an alarm. Let π = P(at least one
/// damage), and P(α) = P(alarm | damage) at the false-alarm probability α. The expected cost is
///
///   C = c_test + min over α of π (P(α) c_inspection + (1 - P(α)) c_missed)
///                           + (1 - π) α (c_inspection + c_false alarm).
///
/// The expected cost without a test is C₀ = min(π c_missed, c_inspection + (1 - π) c_false alarm).
/// The saving C₀ - C is the value of the information minus the cost of the test (Straub 2014,
/// Struct. Saf. 49:75).
/// One half of the simulated tests determines α, and the other half gives an estimate of C. The
/// saving is the mean of this estimate and the estimate with the halves exchanged. If the same
/// tests determined both α and C, the estimated saving would be too large.
struct TestValue {
  double saving = 0.0, mcse = 0.0;
  double test_cost = 0.0;
  double false_alarm = 0.0;  ///< at the chosen threshold
  double detection = 0.0;    ///< at the chosen threshold
};
[[nodiscard]] TestValue value_of(const TestOption& option, const TestCosts& costs, double damaged);

/// The best option after a change of one cost.
struct CostSensitivity {
  std::string cost;  ///< "missed"
  double factor = 1.0;
  int best = -1;  ///< index of the option; -1: no test reduces the expected cost
  double saving = 0.0;
};
struct ValueFindings {
  double without_test = 0.0;  ///< C₀
  /// True if, without a test, inspection is the best decision
  bool inspects_without = false;
  std::vector<TestValue> values;  ///< one per option
  int best = -1;                  ///< index of the option; -1: no test reduces the expected cost
  std::vector<CostSensitivity> sensitivity;  ///< best option with each cost halved, and doubled
};
[[nodiscard]] ValueFindings find_values(const std::vector<TestOption>& options,
                                        const TestCosts& costs, double damaged);

}  // namespace wheeltap::identification::planning
