// Tension of a force law under a prescribed extension: the curve or hysteresis loop of the force
// law.
#pragma once

#include <vector>

#include "dynamics/laws.hpp"

namespace wheeltap::dynamics {

/// A prescribed extension of a link, e(t) = A sin(2π t / T).
struct Cycle {
  double amplitude = 0.01;  ///< A [m]
  double period = 1.0;      ///< T [s]
  int before = 2;           ///< number of preceding cycles, after which a force law with memory has
                            ///< reached a steady cycle
  int points = 240;         ///< number of points of the returned cycle, both ends included
};

struct CyclePoint {
  double extension = 0.0;  ///< [m]
  double rate = 0.0;       ///< [m/s]
  double tension = 0.0;    ///< [N]
};

/// Computes the tension along the last cycle, for a force law with constant coefficients. The state
/// of a force law with memory is integrated by the classical Runge-Kutta scheme with 20 steps per
/// point.
[[nodiscard]] std::vector<CyclePoint> law_cycle(const Law& law, const Cycle& cycle);

}  // namespace wheeltap::dynamics
