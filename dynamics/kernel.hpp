// Interface between simulate.cpp and the time loops, which are compiled once per SIMD width.
// Internal.
#pragma once

#include <cstdint>

namespace wheeltap::dynamics::kernel {

// The loops use only plain arrays. With library code, the linker could select functions with
// AVX-512 instructions for every processor.

struct LawTerm {
  int kind = 0;
  int slot = 0;    ///< slot of the first coefficient; the side (±1) follows the last coefficient
  int memory = 0;  ///< index of the internal state, for a force law with memory
  int dry = -1;    ///< for exact friction: index of the pair of masses; otherwise -1
};

struct LinkTerm {
  int a = 0, b = 0;
  int slot = 0;       ///< slot of the stiffness; the next slot holds the damping
  int pace_slot = 0;  ///< slot of the pace [1/m]: rate of the force laws per unit link velocity
                      ///< (`paces`)
  int law_begin = 0, law_end = 0;
  bool turning = false;  ///< true if the link has a force law with memory (not smooth at ė = 0)
};

struct DriveTerm {
  int mass = 0;  ///< mass on which the force acts; 0: base acceleration
  const double* samples = nullptr;
  int slot = 0;  ///< scale, offset
};

/// One sensor. The predicted value of the sensor is the relative motion + base_scale · base[n] +
/// base_offset.
struct SensorTerm {
  int mass = 0;
  int quantity = 0;              ///< order of the time derivative of the displacement
  const double* base = nullptr;  ///< base motion, one value per sample of the excitation;
                                 ///< null: relative motion
  int base_slot = 0;             ///< scale, offset
  const double* observed = nullptr;
  int slot = 0;  ///< slot of scale and offset of the observed signal
};

/// Input of a simulation for one group of parameter vectors, one vector per SIMD lane.
struct Task {
  int masses = 0, links = 0, laws = 0, drives = 0, sensors = 0, memories = 0;
  int frictions = 0;  ///< number of pairs of masses with exact friction
  const LinkTerm* link = nullptr;
  const LawTerm* law = nullptr;
  const DriveTerm* drive = nullptr;
  const SensorTerm* sensor = nullptr;
  bool serial = false;  ///< true if each link i joins masses i and i + 1 and no other links exist
  int only_law = -1;    ///< the kind of all force laws, if it is the same; otherwise -1
  double step = 0.0;    ///< time between two samples of the excitation [s]
  std::int64_t samples = 0;
  int stride = 1;
  std::int64_t lead_in = 0;  ///< number of initial response samples without residuals
  int substeps = 1;
  bool turning = false;  ///< true if LinkTerm::turning is true for some link
  bool paced = false;    ///< true if the rates of some force law grow with the link's speed
  double pace = 0.0;     ///< limit of the product of a speed-dependent rate and a time step
  int most_steps = 1;    ///< largest number of time steps per lane and sample
  int degree = 0;        ///< degree of the Taylor series, 2 … kMaxDegree
  int halvings = 0;      ///< number of halvings of the time step for the matrix exponential of the
                         ///< exact solution
  double bound = 0.0;    ///< SimulatorOptions::displacement_bound
  int initial_slot = 0;  ///< slot of the initial displacements, then velocities; the slots 0, 1, …
                         ///< hold the masses

  /// The layout is coefficients[slot · W + lane]. All following arrays are 64-byte aligned.
  const double* coefficients = nullptr;
  double* scratch = nullptr;  ///< scratch_size(…) · W doubles
  double* sums = nullptr;     ///< sums of squares, [sensor][lane]; null: store the trajectory
  /// `weights` has the layout [sensor][lane] or is null; `limit` has one entry per lane. If the
  /// weighted sum of squares of a lane exceeds its limit, the lane fails at once.
  const double* weights = nullptr;
  const double* limit = nullptr;
  double* trajectory = nullptr;  ///< [sample of the response][sensor][lane]
  double* failed = nullptr;      ///< [lane]: 0, or the reason of the failure
};

/// Values of `failed`.
inline constexpr double kDiverged = 1.0, kStepsTooLong = 2.0;

inline constexpr int kMaxMasses = 64;
inline constexpr int kMaxMemories = 64;
inline constexpr int kMaxThresholds = 4;   ///< each threshold doubles the number of regimes
inline constexpr int kMaxPolynomials = 8;  ///< largest number of links with polynomial force laws,
                                           ///< for Integrator::series
inline constexpr int kMaxFrictions = 8;    ///< number of pairs of masses with exact friction
inline constexpr int kMaxDegree = 12;

/// Returns the number of vectors of scratch memory that the exact solution needs.
constexpr int scratch_size(int masses, int inputs, int sensors) {
  const int n = 2 * masses;
  return 3 * n * n + masses * (n + inputs) + 4 * n * inputs + sensors * (n + inputs) + inputs + n;
}

/// Returns the number of vectors of scratch memory for the exact solution between switching times.
constexpr int scratch_size(int masses, int inputs, int sensors, int thresholds) {
  const int n = 2 * masses;
  return scratch_size(masses, inputs + 1, sensors) + inputs +
         ((1 << thresholds) + 1) * n * (n + 2 * inputs + 1);
}

struct Kernel {
  int lanes = 1;
  void (*runge_kutta)(const Task&) = nullptr;
  void (*exact)(const Task&) = nullptr;
  void (*piecewise)(const Task&) = nullptr;
  void (*series)(const Task&) = nullptr;
};

extern const Kernel kBaselineKernel;
#ifdef WHEELTAP_X86_KERNELS
extern const Kernel kAvx2Kernel;
extern const Kernel kAvx512Kernel;
#endif

}  // namespace wheeltap::dynamics::kernel
