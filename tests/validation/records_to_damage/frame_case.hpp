// A random plane frame with twelve sensors, healthy and damaged: the cases for Wheeltap, and the
// truth.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/eigen.hpp"

namespace wheeltap::coverage {

/// One storey of one or two bays of steel, clamped feet. Unknown: Young's moduli of the posts and
/// of the girders, ln E ~ N(ln 210 GPa, 0.05²). With probability 3/4 one element, anywhere along
/// the members, has lost r ~ U(0, 0.8) of its stiffness. Truths are drawn from these priors, so
/// that a correct posterior is calibrated.
struct FrameCase {
  int number = 0;
  std::string name;
  nlohmann::json damage =
      {};  ///< the case, its data "from" healthy/modes.json and damaged/modes.json
  nlohmann::json healthy = {};  ///< the case of `wheeltap modal`; its record is healthy.csv
  nlohmann::json damaged = {};

  double posts_young = 0.0, girders_young = 0.0;
  bool is_damaged = false;
  double location = 0.0;  ///< on the line of all members, one after another [m]
  int member = 0;
  double along = 0.0;  ///< from the member's first node [m]
  double reduction = 0.0;
  double damping = 0.0;  ///< damping ratio of every mode, U(0.5 %, 2 %)
  /// Elastic frequencies within the band, healthy and damaged [Hz].
  std::vector<double> healthy_hz = {}, damaged_hz = {};

  /// All modes of each state that count below twice the sampling rate: frequencies, and shapes at
  /// the sensors (sensors × modes, mass-normalised).
  struct State {
    Eigen::VectorXd frequencies_hz;
    Eigen::MatrixXd shapes;
  };
  State state_healthy = {}, state_damaged = {};
};

inline constexpr double kSampleRate = 200.0;  // [Hz]
inline constexpr int kSamples = 120'000;      // ten minutes
inline constexpr int kSensors = 12;

[[nodiscard]] FrameCase frame_case(std::uint64_t seed, int number);

}  // namespace wheeltap::coverage
