// Value of the information of a test, given costs.
#pragma once

#include <string>
#include <vector>

#include "identification/planning/test_scores.hpp"

namespace wheeltap::identification::planning {

/// Costs in any one currency.
struct TestCosts {
  double sensor = 0.0;                  ///< per sensor used
  std::vector<double> of_sensors = {};  ///< per candidate, in place of `sensor`
  double hour = 0.0;                    ///< per hour of record
  double added_mass = 0.0;              ///< for a second state with an added mass
  double inspection = 0.0;              ///< after an alarm; it finds any damage
  double missed = 0.0;                  ///< for a damage that is not found
  double false_alarm = 0.0;  ///< for an alarm without damage, in addition to the inspection
};

/// A test that could be made.
struct TestOption {
  std::string name;  ///< "4 sensors, 600 s"
  std::vector<int> sensors;
  double seconds = 0.0;
  bool mass = false;
  TestScores scores = {};
};

/// The decision after a test is to inspect if it raises an alarm. With π = P(at least one damage)
/// and the operating curve P(α) of the test, its expected cost is
///
///   C = c_test + min over α of π (P(α) c_inspection + (1 - P(α)) c_missed)
///                           + (1 - π) α (c_inspection + c_false alarm),
///
/// and without a test C₀ = min(π c_missed, c_inspection + (1 - π) c_false alarm). The saving C₀ - C
/// is the value of the test's information less its costs (Straub 2014, Struct. Saf. 49:75).
struct TestValue {
  double saving = 0.0, mcse = 0.0;
  double test_cost = 0.0;
  double false_alarm = 0.0;  ///< the best α
  double detection = 0.0;    ///< P at it
};
[[nodiscard]] TestValue value_of(const TestOption& option, const TestCosts& costs, double damaged);

/// The best option if one cost changes.
struct CostSensitivity {
  std::string cost;  ///< "missed"
  double factor = 1.0;
  int best = -1;  ///< option; -1: no test pays
  double saving = 0.0;
};
struct ValueFindings {
  double without_test = 0.0;                 ///< C₀
  bool inspects_without = false;             ///< the best decision without a test is to inspect
  std::vector<TestValue> values;             ///< per option
  int best = -1;                             ///< option; -1: no test pays
  std::vector<CostSensitivity> sensitivity;  ///< each cost halved and doubled
};
[[nodiscard]] ValueFindings find_values(const std::vector<TestOption>& options,
                                        const TestCosts& costs, double damaged);

}  // namespace wheeltap::identification::planning
