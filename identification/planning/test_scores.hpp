// Probability of detection, probability of the right location, and expected information, estimated
// from simulated tests.
#pragma once

#include <array>
#include <vector>

#include "identification/planning/normal_test.hpp"

namespace wheeltap::identification::planning {

/// Interval that one location of a NormalTest represents, in metres from the start of its site; a
/// point if both ends are 0.
struct PlaceSpan {
  int site = 0;
  double start = 0.0, end = 0.0;
};

/// The true defects of a simulated test.
struct TestTruth {
  struct Defect {
    int place = 0;
    double at = 0.0;  ///< distance from the start of the site [m]
    double severity = 0.0;
  };
  int model = 0;
  std::vector<Defect> defects = {};  ///< sorted by kind, then by location
};

/// The outcome of one simulated test.
struct TestOutcome {
  int model = 0;          ///< true model
  double log_odds = 0.0;  ///< ln P(at least one defect | y) / P(none | y)
  /// ln q(count, location | y) / p(count, location) for the true defects, with q = (1 - ε) p(… | y)
  /// + ε p(…) and ε = kFloor. For any q, the mean of this score is a lower bound of the expected
  /// information (Barber & Agakov 2003, NIPS 16). With exact evidences, this bound is too low by at
  /// most -ln(1 - ε). The floor ε limits the effect of tests with inaccurate evidences.
  double information = 0.0;
  bool right = false;  ///< true if the most probable count and all locations are right
  /// P(true number of defects, and every location true within the tolerance | y).
  double located = 0.0;
};

/// Compares the results of a NormalTest with the true defects. The count is right if the most
/// probable model is the true model. The locations are right if the most probable sites of the
/// defects are the true sites, and, given these sites, the posterior median of each location is
/// within `tolerance` [m] of the true location.
class TestScorer {
 public:
  TestScorer(const NormalTest& test, std::vector<PlaceSpan> spans, double tolerance)
      : test_(test), spans_(std::move(spans)), tolerance_(tolerance) {}

  static constexpr double kFloor = 1e-4;

  [[nodiscard]] TestOutcome score(const TestTruth& truth, const NormalTest::Measured& measured,
                                  const NormalTest::Answer& answer) const;

 private:
  [[nodiscard]] double information(const TestTruth& truth, const NormalTest::Measured& measured,
                                   const NormalTest::Answer& answer) const;
  [[nodiscard]] bool is_right(const TestTruth& truth, const NormalTest::Answer& answer) const;
  [[nodiscard]] bool is_near(const std::vector<double>& weights,
                             const TestTruth::Defect& defect) const;
  [[nodiscard]] double within_tolerance(int place, const TestTruth::Defect& defect) const;
  [[nodiscard]] double located(const TestTruth& truth, const NormalTest::Answer& answer) const;

  const NormalTest& test_;
  std::vector<PlaceSpan> spans_;
  double tolerance_;
};

/// A Monte Carlo estimate and its standard error.
struct TestEstimate {
  double value = 0.0, mcse = 0.0;
};

struct TestScores {
  TestEstimate information;  ///< expected information [nats], with the prior probabilities of the
                             ///< models as weights
  TestEstimate detection;    ///< P(detected | at least one defect)
  TestEstimate right_place;  ///< P(detected, number and locations right | at least one defect)
  double threshold = 0.0;    ///< log odds of damage above which a test detects damage
  std::vector<TestEstimate> detection_by_model;  ///< P(detected | model); NaN if intact
  /// P(detected | at least one defect) as a function of the false-alarm probability, ascending.
  struct Operating {
    double false_alarm = 0.0, detection = 0.0;
  };
  std::vector<Operating> operating;
  /// A threshold from one half of the tests, and probabilities at this threshold in the same half
  /// (`chosen`) and in the other half (`tested`), with variances. The probabilities in the other
  /// half are not biased by the choice of the threshold.
  struct HeldOut {
    Operating chosen, tested, variance;
  };
  /// Thresholds chosen from each half of the tests; both lists are empty if a half has no tests
  /// of one of the models.
  std::array<std::vector<HeldOut>, 2> halves;
};

/// Computes the scores of a design from tests that were simulated for each model with a positive
/// prior. A test detects damage if its log odds exceed the (1 - `false_alarm`) quantile of the log
/// odds of intact tests. The standard errors include the error of the threshold. Let P = R(α) be
/// the detection probability at the false-alarm probability α. Then
///
///   se² = P (1 - P) / N + R'(α)² α (1 - α) / N_intact.
///
/// Throws std::invalid_argument if there are no tests of the undamaged structure.
[[nodiscard]] TestScores summarise(const std::vector<TestOutcome>& outcomes,
                                   const std::vector<NormalModel>& models, double false_alarm);

}  // namespace wheeltap::identification::planning
