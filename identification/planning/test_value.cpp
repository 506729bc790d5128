#include "identification/planning/test_value.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/index.hpp"

namespace wheeltap::identification::planning {
namespace {

double cost_without(const TestCosts& c, double damaged) {
  return std::min(damaged * c.missed, c.inspection + (1.0 - damaged) * c.false_alarm);
}

int best_of(const std::vector<TestValue>& values) {
  const auto best = std::ranges::max_element(values, {}, &TestValue::saving);
  return best == values.end() || best->saving <= 0.0 ? -1 : static_cast<int>(best - values.begin());
}

std::vector<TestValue> values_of(const std::vector<TestOption>& options, const TestCosts& costs,
                                 double damaged) {
  std::vector<TestValue> out;
  for (const TestOption& option : options) out.push_back(value_of(option, costs, damaged));
  return out;
}

}  // namespace

TestValue value_of(const TestOption& option, const TestCosts& c, double damaged) {
  TestValue out;
  for (const int s : option.sensors)
    out.test_cost += c.of_sensors.empty() ? c.sensor : c.of_sensors[index(s)];
  // Frequencies need one sensor; an added mass needs a second record.
  if (option.sensors.empty())
    out.test_cost += c.of_sensors.empty() ? c.sensor : std::ranges::min(c.of_sensors);
  out.test_cost += c.hour * option.seconds / 3600.0 * (option.mass ? 2.0 : 1.0) +
                   (option.mass ? c.added_mass : 0.0);
  const double alarm_cost = (1.0 - damaged) * (c.inspection + c.false_alarm);
  const double detection_gain = damaged * (c.missed - c.inspection);
  const auto cost_of = [&](const TestScores::Operating& o) {
    return damaged * c.missed - detection_gain * o.detection + alarm_cost * o.false_alarm;
  };
  double cost = 0.0, variance = 0.0;
  for (const auto& half : option.scores.halves) {
    // A test that never raises an alarm.
    TestScores::HeldOut best;
    for (const TestScores::HeldOut& one : half)
      if (cost_of(one.chosen) < cost_of(best.chosen)) best = one;
    cost += 0.5 * cost_of(best.tested);
    out.false_alarm += 0.5 * best.tested.false_alarm;
    out.detection += 0.5 * best.tested.detection;
    variance += 0.25 * (detection_gain * detection_gain * best.variance.detection +
                        alarm_cost * alarm_cost * best.variance.false_alarm);
  }
  out.saving = cost_without(c, damaged) - cost - out.test_cost;
  out.mcse = std::sqrt(variance);
  return out;
}

ValueFindings find_values(const std::vector<TestOption>& options, const TestCosts& costs,
                          double damaged) {
  ValueFindings out;
  out.without_test = cost_without(costs, damaged);
  out.inspects_without =
      costs.inspection + (1.0 - damaged) * costs.false_alarm < damaged * costs.missed;
  out.values = values_of(options, costs, damaged);
  out.best = best_of(out.values);
  const std::array<std::pair<const char*, double TestCosts::*>, 6> parts = {
      {{"sensor", &TestCosts::sensor},
       {"hour", &TestCosts::hour},
       {"added_mass", &TestCosts::added_mass},
       {"inspection", &TestCosts::inspection},
       {"missed_damage", &TestCosts::missed},
       {"false_alarm", &TestCosts::false_alarm}}};
  for (const auto& [name, part] : parts)
    for (const double factor : {0.5, 2.0}) {
      if (costs.*part == 0.0 && (part != &TestCosts::sensor || costs.of_sensors.empty())) continue;
      TestCosts changed = costs;
      changed.*part *= factor;
      if (part == &TestCosts::sensor)
        for (double& cost : changed.of_sensors) cost *= factor;
      const std::vector<TestValue> values = values_of(options, changed, damaged);
      const int best = best_of(values);
      out.sensitivity.push_back({.cost = name,
                                 .factor = factor,
                                 .best = best,
                                 .saving = best < 0 ? 0.0 : values[index(best)].saving});
    }
  return out;
}

}  // namespace wheeltap::identification::planning
