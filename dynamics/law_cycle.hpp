// What a law answers to a motion that is given: the curve or loop by which it is known.
#pragma once

#include <vector>

#include "dynamics/laws.hpp"

namespace wheeltap::dynamics {

/// A link's extension moved as e(t) = A sin(2π t / T).
struct Cycle {
  double amplitude = 0.01;  ///< A [m]
  double period = 1.0;      ///< T [s]
  int before = 2;           ///< cycles that are run first, for a law with memory to settle
  int points = 240;         ///< of the cycle that is returned, both ends included
};

struct CyclePoint {
  double extension = 0.0;  ///< [m]
  double rate = 0.0;       ///< [m/s]
  double tension = 0.0;    ///< [N]
};

/// T along the last cycle, for a law whose coefficients are all known. The state of a law with
/// memory follows by the classical Runge-Kutta step, 20 of them a point.
[[nodiscard]] std::vector<CyclePoint> law_cycle(const Law& law, const Cycle& cycle);

}  // namespace wheeltap::dynamics
