#include "apps/results/measured/repeats_summary.hpp"

#include <cmath>

#include "identification/structural/repeated_tests.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

Report finite_list(const std::vector<double>& values) {
  Report out = Report::array();
  for (const double x : values) out.push_back(finite(x));
  return out;
}

Report one_report(const RepeatedTests& tests) {
  Report sd = Report::array(), outliers = Report::array(), independent = Report::array(),
         degrees = Report::array();
  for (std::size_t j = 0; j < tests.frequencies_hz.size(); ++j) {
    const auto at = static_cast<Eigen::Index>(j);
    const bool known = tests.identified[j] > 0;
    sd.push_back(known ? Report(std::sqrt(tests.covariance_hz2(at, at))) : Report());
    independent.push_back(known ? Report(tests.identified[j] / tests.inflation[j]) : Report(0));
  }
  for (const int t : tests.outliers) outliers.push_back(t + 1);
  for (std::size_t n = 0; n < tests.probabilities.size(); ++n)
    degrees.push_back(
        {{"value", finite(tests.degrees_of_freedom[n])}, {"probability", tests.probabilities[n]}});
  return {{"tests", tests.tests},
          {"identified", tests.identified},
          {"mean_hz", finite_list(tests.frequencies_hz)},
          {"mean_sd_hz", sd},
          {"scatter", finite_list(tests.scatter)},
          {"scatter_sd", finite_list(tests.scatter_sd)},
          {"correlation", rows_of(tests.correlation)},
          {"degrees_of_freedom", degrees},
          {"outliers", outliers},
          {"weights", tests.weights},
          {"serial_correlation", finite_list(tests.serial_correlation)},
          {"independent_tests", independent}};
}

}  // namespace

Report repeats_report(const ModalData* data, const ObservedStates* states) {
  if (states == nullptr)
    return data != nullptr && data->repeats ? one_report(*data->repeats) : Report();
  Report list = Report::array();
  for (const ObservedState& state : states->list) {
    if (!state.data.repeats) continue;
    list.push_back({{"state", state.name}});
    list.back().update(one_report(*state.data.repeats));
  }
  if (list.empty()) return {};
  if (states->list.size() == 1) return list[0];
  Report scatter = Report::array(), identified = Report::array();
  for (const Report& one : list) {
    for (const Report& x : one["scatter"]) scatter.push_back(x);
    for (const Report& x : one["identified"]) identified.push_back(x);
  }
  return {{"scatter", scatter}, {"identified", identified}, {"states", list}};
}

}  // namespace wheeltap::apps
