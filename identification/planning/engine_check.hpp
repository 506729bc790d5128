// Comparison of a plan's approximate evidences with the full engine (reversible-jump MCMC).
#pragma once

#include <functional>
#include <vector>

#include "identification/planning/plan.hpp"
#include "inference/options.hpp"

namespace wheeltap::identification::planning {

/// The damage case for one simulated test of a design; it contains the simulated modes and their
/// uncertainty.
[[nodiscard]] DamageCase simulated_case(const PlanCase& plan, const ScenarioSource& source,
                                        const TestDesign& design, const Scenario& scenario);

/// The result of the full engine for one simulated test.
struct EngineOutcome {
  double probability_damaged = 0.0;
  int model = 0;       ///< most probable model
  bool right = false;  ///< true if count and locations are correct by the criteria of TestScorer
  /// Log posterior density (in standard normal coordinates) of the true damage, minus the highest
  /// density that the run found in the true model. A value of several nats means that the search
  /// missed the true damage.
  double truth_gain = 0.0;
};
[[nodiscard]] EngineOutcome identify(const PlanCase& plan, const ScenarioSource& source,
                                     const TestDesign& design, std::uint64_t number,
                                     const inference::Options& options);

/// One simulated test, evaluated by the approximation and by the full engine.
struct CheckedTest {
  std::uint64_t number = 0;
  TestOutcome approximate;
  EngineOutcome engine;
};

/// If `truth_gain` [nats] exceeds this value, the run has missed the true damage.
inline constexpr double kMissed = 3.0;
/// Index of the first checked test; scores and searches use tests with smaller indices.
inline constexpr std::uint64_t kFirstCheck = std::uint64_t{1} << 40;

/// Differences between engine and approximation (engine minus approximation) in the same tests.
/// P(detected) and P(right location) are compared over tests with at least one defect. The root
/// mean square difference of P(at least one defect | y) is computed over all tests. For the
/// standard errors, one test in which engine and approximation differ is added, because a few tests
/// may all agree by chance. Tests in which the engine did not find the true damage count only as
/// `missed`, because they do not test the approximation.
struct EngineCheck {
  std::vector<CheckedTest> tests;
  int damaged = 0;  ///< tests with at least one defect
  int missed = 0;
  TestEstimate detection, right_place;
  double rms_probability = 0.0;
};

/// Runs the engine on `count` new simulated tests, not used to evaluate the design. Quick runs make
/// at least 200 local searches per model, because a model with two damages has many posterior modes
/// (pairs of members). Engine and approximation use the detection threshold in
/// `ScoredDesign::scores`.
[[nodiscard]] EngineCheck check_by_engine(const PlanCase& plan, const PlanModel& model,
                                          const ScoredDesign& design, int count,
                                          const inference::Options& options,
                                          const std::function<void(double)>& progress = {});

}  // namespace wheeltap::identification::planning
