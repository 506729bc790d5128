// Choice of sensors by expected information, beside classical criteria.
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
  int first_scenarios = 256;  ///< with which a comparison begins
  int most_scenarios = 4096;  ///< at which it ends
  int keep = 10;              ///< designs in the result
  int exhaustive = 1000;      ///< all designs are compared if there are at most so many
  std::function<void(double fraction)> progress = {};
};

/// A design with its estimated information [nats].
struct RankedDesign {
  TestDesign design;
  TestEstimate information;
};

struct SensorChoice {
  std::vector<RankedDesign> best;  ///< best first
  bool exhaustive = false;         ///< all designs were compared
  long compared = 0;               ///< designs that were scored
  int scenarios = 0;               ///< the largest number of scenarios of one comparison
  std::vector<RankedDesign> path;  ///< the greedy path: 2, 3, … sensors
};

/// Maximises the expected information about count and place. All designs receive the same simulated
/// tests, so differences between designs are estimated with little noise. A comparison begins with
/// `first_scenarios`; designs whose information is lower than the best by more than three standard
/// errors of the difference leave, and the number of scenarios doubles for the others, up to
/// `most_scenarios`. The best of all pairs of sensors (shapes need two), or of 120 of them, comes
/// first; then sensors are added one at a time. If there are at most `exhaustive` designs, all are
/// compared; otherwise the best of this design and the layouts by effective independence and
/// kinetic energy is improved by exchanges of one sensor until none improves it. Throws
/// std::invalid_argument for more sensors than candidates.
[[nodiscard]] SensorChoice choose_sensors(const ScenarioSource& source,
                                          const PlacePredictions& predictions,
                                          const TestNoise& noise, const ChoiceOptions& options);

/// Effective independence (Kammer 1991, J. Guid. Control Dyn. 14:251): of the candidates, the
/// sensor with the smallest diagonal entry of Φ (ΦᵀΦ)⁻¹ Φᵀ leaves until `count` remain. With fewer
/// sensors than modes, the pseudo-inverse is used and the entries are ties; then the smallest
/// contribution to the determinant of Φ Φᵀ leaves.
[[nodiscard]] std::vector<int> effective_independence(const Eigen::MatrixXd& shapes, int count);

/// The `count` sensors with the largest Σ over modes of φ², of shapes scaled to unit length.
[[nodiscard]] std::vector<int> kinetic_energy(const Eigen::MatrixXd& shapes, int count);

/// Reproducible random layouts.
[[nodiscard]] std::vector<std::vector<int>> random_layouts(int candidates, int count, int layouts,
                                                           std::uint64_t seed);

/// The number of layouts of `choose` among `candidates`, at most 1e18.
[[nodiscard]] double layout_count(int candidates, int choose);

}  // namespace wheeltap::identification::planning
