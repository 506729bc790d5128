// Simulation of the response of a chain to measured or prescribed excitation; misfit of this
// response to a measured one.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/eigen.hpp"
#include "base/simd.hpp"
#include "dynamics/chain.hpp"

namespace wheeltap::dynamics {

enum class Quantity { displacement, velocity, acceleration };
enum class Frame { absolute, relative };  ///< `relative`: relative to the base

/// A sampled signal, value = scale · sample + offset.
struct Signal {
  std::vector<double> samples = {};
  Coefficient scale = 1.0;
  Coefficient offset = 0.0;
};

/// A force on a mass [N].
struct Force {
  int mass = 1;
  Signal signal = {};
};

/// Motion of the base (mass 0): acceleration, displacement or both. If the acceleration [m/s²] is
/// not given, the acceleration is the second derivative of the natural cubic spline through the
/// displacement. This acceleration is linear between samples, like every excitation. The
/// displacement is the exact double integral of this acceleration. The displacement [m] and the
/// velocity of the spline are also used to convert relative to absolute motion. The offset of the
/// displacement signal affects only predicted absolute displacements.
struct BaseMotion {
  Signal acceleration = {};
  Signal displacement = {};
};

/// Excitation of the chain. All signals have equal lengths and are linear between samples.
struct Excitation {
  double sample_rate_hz = 0.0;
  std::vector<Force> forces = {};
  std::optional<BaseMotion> base = {};
};

/// A sensor: an observed quantity of one mass.
struct Sensor {
  int mass = 1;
  Quantity quantity = Quantity::displacement;
  Frame frame = Frame::absolute;
};

/// Relative displacement [m] and velocity [m/s] of every mass at the first sample; empty: zero.
struct InitialState {
  std::vector<Coefficient> displacement = {};
  std::vector<Coefficient> velocity = {};
};

enum class Integrator {
  /// Selects `runge_kutta` for a fixed number of substeps. For 0 substeps, selects `exact` or
  /// `piecewise` if the chain allows it. Otherwise, selects `series` if a force law switches, a
  /// link sticks and slips, or prefer_series is set; in all other cases, `runge_kutta`.
  automatic,
  /// The classical fourth-order Runge-Kutta scheme. A step ends when a link with exact friction
  /// comes to rest or breaks away.
  runge_kutta,
  exact,  ///< exact discrete solution of linear chains
  /// For chains with at most four nonlinear force laws, all bilinear or contact. Uses the exact
  /// solution in sample intervals without a switch, and Taylor series in the others.
  piecewise,
  /// Taylor series in time of degree 7 to 12 between switching times; Newton's method finds the
  /// switching times. Supports bilinear, contact, quadratic and cubic laws and exact friction.
  series
};

/// The SIMD instructions to use; the results are bitwise equal for all SIMD instructions.
using base::Instructions;

inline constexpr int kMaxSubsteps = 4096;
/// Largest number of time steps per sample if the time steps adapt to the motion.
inline constexpr int kMaxPacedSubsteps = 4 * kMaxSubsteps;

struct SimulatorOptions {
  Integrator integrator = Integrator::automatic;
  /// If true, Integrator::automatic selects `series` instead of `runge_kutta`. The relative error
  /// per period is 1e-9 instead of 1e-5, and the run time is two to three times as long.
  bool prefer_series = false;
  /// Number of Runge-Kutta steps between two samples of the excitation. If the number is 0, the
  /// simulator selects the number for every parameter vector. The selected number is the smallest
  /// of 1, 2, 3, 4, 6, 8, 12, … 4096 with ω h <= step_limit and γ h <= min(1, 5 step_limit), where
  /// ω and γ are the upper bounds that stiffest_rates returns. For force laws whose rate grows with
  /// |ė| (LawInfo::paced), the steps are shorter at high velocities: the product of the rate and a
  /// time step is at most 1 and at most 5 step_limit. The number of these steps per sample is at
  /// most kMaxPacedSubsteps. If a parameter vector needs more steps, its simulation fails. For
  /// `series` and `piecewise`, this option is the number of series expansions per sample. A number
  /// selected by the simulator limits ω h and γ h to the smaller of 0.7 and 3.5 step_limit.
  int substeps = 0;
  /// Limit of ω h, with the bound ω of the natural frequencies [rad/s] and the time step h [s]. A
  /// time step of this length multiplies a frequency ω by 1 - (ω h)⁴/120 and adds the numerical
  /// damping ratio (ω h)⁵/144. For ω h = 0.2, these errors are 1.3e-5 and 2.2e-6.
  double step_limit = 0.2;
  /// Factor set by Simulator::refined. The step limit of the original simulator was `refinement`
  /// times as large. The refined simulator makes at least `refinement` times as many steps as the
  /// original simulator.
  int refinement = 1;
  /// Largest extension [m] of each link for which stiffest_rates considers nonlinear force laws. If
  /// the list is empty, the extensions are 0.
  std::vector<double> extension = {};
  /// Every `stride`-th sample of the excitation is also a sample of the response. Set this option
  /// for an excitation that was upsampled by the factor `stride`.
  int stride = 1;
  /// Limit of displacements relative to the base [m]. Larger displacements count as divergence.
  double displacement_bound = 1e6;
  Instructions instructions = Instructions::automatic;
};

/// Outcome of an integration.
enum class Outcome {
  complete,
  impossible,  ///< infeasible parameters, for example a mass <= 0 or a gap < 0
  /// The simulation needs more than the maximum number of steps, or the fixed number of steps is
  /// too small for numerical stability.
  steps_too_long,
  diverged  ///< the displacement bound is exceeded, or a value is not finite
};

struct Response {
  Eigen::MatrixXd values;  ///< predicted signals, samples × sensors; empty if failed
  Outcome outcome = Outcome::complete;
  bool failed = false;  ///< true for any outcome other than complete
  int substeps = 0;     ///< number of steps per sample; 0 for the exact solution
};

/// True if Integrator::series can integrate the chain.
[[nodiscard]] bool has_series(const Chain& chain);

/// A simulator of one chain for many parameter vectors. Forces and base acceleration are linear
/// between samples (first-order hold). The initial state applies at the first sample. Accelerations
/// follow from the equation of motion at each sample. The simulator is immutable, and any number of
/// threads may share it.
class Simulator {
 public:
  /// Throws std::invalid_argument for an invalid chain, masses that do not exist, the exact
  /// integrator with a nonlinear chain, and excitation signals of unequal length or with values
  /// that are not finite. Also throws std::invalid_argument for a sensor of absolute displacement
  /// or velocity if the base acceleration is given without the base displacement.
  Simulator(Chain chain, Excitation excitation, std::vector<Sensor> sensors,
            InitialState initial = {}, SimulatorOptions options = {});

  [[nodiscard]] const Chain& chain() const;
  [[nodiscard]] const SimulatorOptions& options() const;
  /// The integrator in use; never `automatic`.
  [[nodiscard]] Integrator integrator() const;
  [[nodiscard]] const std::vector<Sensor>& sensors() const;
  [[nodiscard]] int samples() const;     ///< number of samples of the response
  [[nodiscard]] int parameters() const;  ///< minimum length of a parameter vector
  /// Number of steps (or series expansions) per sample for these parameters; 0 for the exact
  /// solution, -1 for infeasible parameters.
  [[nodiscard]] int substeps(std::span<const double> theta) const;

  /// Returns a copy of this simulator with time steps divided by `factor`, to estimate the
  /// truncation error. Throws std::invalid_argument if fixed substeps would exceed
  /// kMaxSubsteps.
  [[nodiscard]] Simulator refined(int factor) const;
  /// Returns a simulator of the same chain and excitation with other sensors and options.
  [[nodiscard]] Simulator with(std::vector<Sensor> sensors, SimulatorOptions options) const;

  [[nodiscard]] Response simulate(std::span<const double> theta) const;
  /// Simulates several parameter vectors, stored one after the other in `thetas`.
  [[nodiscard]] std::vector<Response> simulate_batch(std::span<const double> thetas,
                                                     int sets) const;

 private:
  friend class Misfit;
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

/// The misfit of a simulator to observed signals: the residuals of all sensors, r = (scale ·
/// observed + offset) - predicted.
class Misfit {
 public:
  /// `observed[c]` is the signal of sensor c and has the same number of samples as the response.
  /// The first `lead_in` samples are simulated, but do not contribute to the residuals. Throws
  /// std::invalid_argument for signals with another number of samples, and for observed values
  /// after `lead_in` that are not finite.
  Misfit(Simulator simulator, std::vector<Signal> observed, int lead_in = 0);

  [[nodiscard]] const Simulator& simulator() const;
  /// Returns a Misfit with the same data and the refined simulator (Simulator::refined).
  [[nodiscard]] Misfit refined(int factor) const;
  [[nodiscard]] int channels() const;
  [[nodiscard]] int samples() const;     ///< number of residuals per channel
  [[nodiscard]] int parameters() const;  ///< minimum length of a parameter vector

  /// Computes the sums of squares S_c = Σ_n r_c(n)² for `sets` parameter vectors of equal length,
  /// stored one after the other in `thetas`. The sums are written to out[set · channels() + c]. The
  /// sum is +∞ for a parameter vector whose trajectory fails, so that a Gaussian log-likelihood is
  /// -∞. Parameter vectors with the same number of substeps are integrated together in SIMD lanes;
  /// the result for a vector does not depend on the other vectors. This function allocates memory
  /// only in the first call of a thread.
  void sums_of_squares(std::span<const double> thetas, int sets, std::span<double> out) const;

  /// Computes the sums of squares like sums_of_squares, but stops the integration of a parameter
  /// vector when Σ_c weights[set · channels() + c] S_c exceeds limits[set]. The sums of this vector
  /// are then +∞. Parameter vectors with a large misfit therefore need little time.
  void sums_of_squares_within(std::span<const double> thetas, int sets,
                              std::span<const double> weights, std::span<const double> limits,
                              std::span<double> out) const;

  /// Computes the sums of squares of one parameter vector. Returns false, with `out` undefined, if
  /// the trajectory fails or Σ_c weights[c] S_c exceeds `limit`. `weights` (>= 0) and `out` have
  /// one entry per channel.
  [[nodiscard]] bool sums_of_squares_within(std::span<const double> theta,
                                            std::span<const double> weights, double limit,
                                            std::span<double> out) const;

  /// Computes the residuals of one parameter vector, out[c · samples() + n]. Returns false, with
  /// `out` undefined, if the trajectory fails.
  [[nodiscard]] bool residuals(std::span<const double> theta, std::span<double> out) const;
  /// Computes the residuals of `sets` parameter vectors, stored one after the other in `thetas` and
  /// in `out`. If the trajectory of a parameter vector fails, done[set] is 0, and the residuals of
  /// this vector in `out` are undefined. Like sums_of_squares, this function integrates several
  /// vectors in SIMD lanes.
  void residuals(std::span<const double> thetas, int sets, std::span<double> out,
                 std::span<char> done) const;
  /// True if a residual depends on entry `parameter` of the parameter vector.
  [[nodiscard]] bool depends_on(int parameter) const;

 private:
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

}  // namespace wheeltap::dynamics
