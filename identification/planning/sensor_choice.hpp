// Choice of sensors by the probability that the test identifies number and locations of damages
// correctly, and by classical criteria for comparison.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "identification/planning/scenarios.hpp"

namespace wheeltap::identification::planning {

struct ChoiceOptions {
  int choose = 8;
  int threads = 1;
  double tolerance = 0.05;
  int first_scenarios = 128;  ///< number of scenarios at the start of a comparison
  int most_scenarios = 4096;  ///< number of scenarios at the end of a comparison
  int keep = 10;              ///< number of designs in the result
  int exhaustive = 1000;      ///< up to this number of designs, all are compared
  std::function<void(double fraction)> progress = {};
};

/// Returns the location score H of one simulated test. The choice of sensors maximises the mean of
/// H. With S = P(true count, and all locations true within the tolerance | y),
///
///   H = S² / (S² + (1 - S)²).
///
/// If S > 1/2, the most probable count and sites are correct, and the median locations differ from
/// the true locations by at most the tolerance. H is a smooth approximation of the indicator of
/// this event. For equal precision, the mean of H requires fewer simulated tests than the frequency
/// of this event.
[[nodiscard]] double location_score(const TestOutcome& outcome);

/// A design with its mean location score in tests with at least one defect.
struct RankedDesign {
  TestDesign design;
  TestEstimate score;
};

struct SensorChoice {
  std::vector<RankedDesign> best;  ///< sorted, best design first
  bool exhaustive = false;         ///< true if all designs were compared
  long compared = 0;               ///< number of designs that were scored
  int scenarios = 0;               ///< the largest number of scenarios of one comparison
  std::vector<RankedDesign> path;  ///< designs of the greedy search with 2, 3, … sensors
};

/// Maximises the mean location score of damaged structures. All designs receive the same simulated
/// tests, so differences between designs are estimated with little noise. A comparison begins with
/// `first_scenarios` tests (scenarios). Designs that are worse than the best design by more than
/// three standard errors of the difference are removed. For the remaining designs, the number of
/// scenarios is doubled, up to `most_scenarios`. If there are at most `exhaustive` designs, all
/// designs are compared. For more designs, a greedy search begins with the best pair of sensors (of
/// all pairs, but at most 120) and adds one sensor at a time. Three designs are then improved: the
/// greedy design, and the layouts by effective independence and by kinetic energy. The search
/// removes the least useful sensor and adds the best other sensor, until the design no longer
/// improves. Finally, single sensors of the best of these designs are exchanged, until no exchange
/// improves the design. Throws std::invalid_argument for more sensors than candidates.
[[nodiscard]] SensorChoice choose_sensors(const ScenarioSource& source,
                                          const PlacePredictions& predictions,
                                          const TestNoise& noise, const ChoiceOptions& options);

/// Effective independence (Kammer 1991, J. Guid. Control Dyn. 14:251): the candidate with the
/// smallest diagonal entry of Φ (ΦᵀΦ)⁻¹ Φᵀ is removed until `count` sensors remain. With fewer
/// sensors than modes, all diagonal entries from the pseudo-inverse are equal. The sensor that
/// contributes least to the determinant of Φ Φᵀ is then removed.
[[nodiscard]] std::vector<int> effective_independence(const Eigen::MatrixXd& shapes, int count);

/// Returns the `count` sensors with the largest Σ φ² over the modes, with shapes of unit length.
[[nodiscard]] std::vector<int> kinetic_energy(const Eigen::MatrixXd& shapes, int count);

/// Draws random sensor layouts, reproducible by the seed.
[[nodiscard]] std::vector<std::vector<int>> random_layouts(int candidates, int count, int layouts,
                                                           std::uint64_t seed);

/// The number of layouts of `choose` sensors among `candidates` locations, at most 1e18.
[[nodiscard]] double layout_count(int candidates, int choose);

}  // namespace wheeltap::identification::planning
