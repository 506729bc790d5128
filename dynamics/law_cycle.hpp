// Response of a law to a prescribed motion: its curve or hysteresis loop.
#pragma once

#include <vector>

#include "dynamics/laws.hpp"

namespace wheeltap::dynamics {

/// Extension of a link, e(t) = A sin(2π t / T).
struct Cycle {
  double amplitude = 0.01;  ///< A [m]
  double period = 1.0;      ///< T [s]
  int before = 2;           ///< preceding cycles, for a law with memory to become steady
  int points = 240;         ///< in the returned cycle, both ends included
};

struct CyclePoint {
  double extension = 0.0;  ///< [m]
  double rate = 0.0;       ///< [m/s]
  double tension = 0.0;    ///< [N]
};

/// T along the last cycle, for a law whose coefficients are all constant. The state of a law with
/// memory is integrated by the classical Runge-Kutta scheme with 20 steps per point.
[[nodiscard]] std::vector<CyclePoint> law_cycle(const Law& law, const Cycle& cycle);

}  // namespace wheeltap::dynamics
