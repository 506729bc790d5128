// Simulated tests: damage drawn from the prior, exact modes of the damaged structure, and scores of
// designs.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "identification/planning/test_design.hpp"
#include "identification/planning/test_scores.hpp"

namespace wheeltap::identification::planning {

/// One simulated structure, and the noise of its test.
struct Scenario {
  TestTruth truth;
  std::vector<PlacedDefect> defects;
  int draw = -1;  ///< index of the draw of unknown coefficients; -1: all are known
  TestModes modes;
  TestNumbers numbers;
};

/// Draws true damages from the priors, and the noise of the tests. The seed and the index of a draw
/// determine its values. Draw n has the model with index n modulo the number of models.
class ScenarioSource {
 public:
  ScenarioSource(const PlannedStructure& structure, std::uint64_t seed);

  [[nodiscard]] const PlannedStructure& structure() const { return structure_; }
  [[nodiscard]] const std::vector<NormalModel>& models() const { return models_; }
  [[nodiscard]] std::uint64_t seed() const { return seed_; }
  [[nodiscard]] Scenario draw(std::uint64_t number, PlannedStructure::Solver& solver) const;
  /// Draws the scenarios first … first + count - 1, in parallel.
  [[nodiscard]] std::vector<Scenario> draw(std::uint64_t first, int count, int threads) const;
  /// The intervals of all locations in the structure, as input of TestScorer.
  [[nodiscard]] std::vector<PlaceSpan> spans() const;

 private:
  const PlannedStructure& structure_;
  std::uint64_t seed_;
  std::vector<NormalModel> models_;
};

/// A design with its TestData and its NormalTest.
struct PreparedDesign {
  TestData data;
  NormalTest test;
};
[[nodiscard]] PreparedDesign prepare(const PlannedStructure& structure,
                                     const PlacePredictions& predictions, const TestNoise& noise,
                                     const TestDesign& design);

/// The outcomes of simulated tests of a design. True damage and random numbers are the same for all
/// designs.
[[nodiscard]] std::vector<TestOutcome> simulate_tests(const ScenarioSource& source,
                                                      const PreparedDesign& design,
                                                      std::span<const Scenario> scenarios,
                                                      double tolerance);

struct ScoringOptions {
  int scenarios = 100'000;
  double false_alarm = 0.05;
  double tolerance = 0.05;  ///< largest error of a correct location [m]
  int threads = 1;
  std::function<void(double fraction)> progress = {};
};

/// Evaluates all designs with the same scenarios; `first` is the index of the first scenario.
[[nodiscard]] std::vector<TestScores> score_designs(
    const ScenarioSource& source, const PlacePredictions& predictions, const TestNoise& noise,
    const std::vector<TestDesign>& designs, const ScoringOptions& options, std::uint64_t first = 0);

}  // namespace wheeltap::identification::planning
