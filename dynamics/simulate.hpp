// Response of a chain to measured or prescribed excitation, and its misfit to a measured response.
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
enum class Frame { absolute, relative };  ///< relative to the base

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
/// not given, it is that of the natural cubic spline through the displacement. It is then linear
/// between samples like every excitation, and the displacement is its exact double integral. The
/// displacement [m] and the velocity of the spline also convert relative to absolute motion. The
/// offset of a displacement affects only absolute displacements.
struct BaseMotion {
  Signal acceleration = {};
  Signal displacement = {};
};

/// Excitation of the chain: all signals have equal lengths and are linear between samples.
struct Excitation {
  double sample_rate_hz = 0.0;
  std::vector<Force> forces = {};
  std::optional<BaseMotion> base = {};
};

/// An observed quantity of one mass.
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
  /// Chooses the exact solution or `piecewise` if applicable. Chooses series if a law switches, a
  /// link sticks and slips, or prefer_series is set. Otherwise, or if the number of substeps is
  /// fixed, chooses Runge-Kutta.
  automatic,
  /// The classical fourth-order scheme; steps end where a link with exact friction comes to rest or
  /// breaks away.
  runge_kutta,
  exact,  ///< exact discrete solution of linear chains
  /// For chains with at most four nonlinear laws, all bilinear or contact: exact for samples
  /// without a switch, series for the others.
  piecewise,
  /// Taylor series in time of degree 7 to 12, in pieces between the switching times, which Newton's
  /// method finds. For bilinear, contact, quadratic and cubic laws and exact friction.
  series
};

/// The vector instructions to use; results are bitwise equal for all.
using base::Instructions;

inline constexpr int kMaxSubsteps = 4096;
/// Largest number of steps in one sample if the steps adapt to the motion.
inline constexpr int kMaxPacedSubsteps = 4 * kMaxSubsteps;

struct SimulatorOptions {
  Integrator integrator = Integrator::automatic;
  /// For `automatic`: use series instead of Runge-Kutta. The error per period is 1e-9 instead of
  /// 1e-5, at two to three times the cost.
  bool prefer_series = false;
  /// Number of Runge-Kutta steps between two samples of the excitation. 0: chosen for every
  /// parameter vector, as the smallest of 1, 2, 3, 4, 6, 8, 12, … 4096 with ω h <= step_limit and γ
  /// h <= min(1, 5 step_limit), where ω and γ are the bounds of stiffest_rates. For laws whose rate
  /// grows with the speed of their link (LawInfo::paced), these steps shorten with the motion, up
  /// to kMaxPacedSubsteps, so that the product of their rate and a step is at most 1 and at most 5
  /// step_limit. A parameter vector that needs more steps fails. For `series` and `piecewise`, this
  /// is the number of pieces per sample, with ω h and γ h <= 0.7 (and <= 3.5 step_limit).
  int substeps = 0;
  /// One step of length h shifts a frequency ω by the factor 1 - (ω h)⁴/120 and adds a damping
  /// ratio (ω h)⁵/144: 1.3e-5 and 2.2e-6 at 0.2.
  double step_limit = 0.2;
  /// Set by Simulator::refined: use at least `refinement` times the steps for a step limit
  /// `refinement` times as large.
  int refinement = 1;
  /// The extension [m] of each link up to which stiffest_rates considers nonlinear laws; empty: 0.
  std::vector<double> extension = {};
  /// Every `stride`-th sample of the excitation is a sample of the response. Use this for an
  /// excitation that was upsampled by this factor.
  int stride = 1;
  /// A trajectory with a larger relative displacement [m] counts as diverged.
  double displacement_bound = 1e6;
  Instructions instructions = Instructions::automatic;
};

/// Outcome of an integration.
enum class Outcome {
  complete,
  impossible,  ///< infeasible parameters: a mass <= 0, a gap < 0
  /// The maximum number of steps is exceeded, or the given number of steps is too small for
  /// stability.
  steps_too_long,
  diverged  ///< the displacement bound is exceeded, or a value is not finite
};

struct Response {
  Eigen::MatrixXd values;  ///< samples × sensors; empty if failed
  Outcome outcome = Outcome::complete;
  bool failed = false;  ///< outcome other than complete
  int substeps = 0;     ///< steps per sample, where taken; 0 for the exact solution
};

/// True if Integrator::series can integrate the chain.
[[nodiscard]] bool has_series(const Chain& chain);

/// Integrates one chain for many parameter vectors. Forces and base acceleration are linear between
/// samples (first-order hold); the initial state applies at the first sample. Accelerations follow
/// from the equation of motion at the sample. The object is immutable, and any number of threads
/// may share it.
class Simulator {
 public:
  /// Throws std::invalid_argument for an invalid chain, masses that do not exist, an exact solution
  /// of a nonlinear chain, and excitation signals of unequal length or with values that are not
  /// finite. Also throws it for a sensor of absolute displacement or velocity if the base
  /// acceleration is given without the base displacement.
  Simulator(Chain chain, Excitation excitation, std::vector<Sensor> sensors,
            InitialState initial = {}, SimulatorOptions options = {});

  [[nodiscard]] const Chain& chain() const;
  [[nodiscard]] const SimulatorOptions& options() const;
  /// The integrator in use; never `automatic`.
  [[nodiscard]] Integrator integrator() const;
  [[nodiscard]] const std::vector<Sensor>& sensors() const;
  [[nodiscard]] int samples() const;     ///< number in the response
  [[nodiscard]] int parameters() const;  ///< minimum length of a parameter vector
  /// Number of steps (or pieces) per sample for these parameters; 0 for the exact solution, -1 for
  /// infeasible parameters.
  [[nodiscard]] int substeps(std::span<const double> theta) const;

  /// This simulator with steps shorter by `factor`, to estimate the truncation error. Throws
  /// std::invalid_argument if fixed substeps would exceed kMaxSubsteps.
  [[nodiscard]] Simulator refined(int factor) const;
  /// A simulator of the same chain and excitation with other sensors and options.
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

/// Residuals r = (scale · observed + offset) - predicted of a simulator's sensors.
class Misfit {
 public:
  /// `observed[c]` belongs to sensor c and has as many samples as the response. The first `lead_in`
  /// samples are integrated but not scored. Throws std::invalid_argument for other numbers of
  /// samples, and for scored values that are not finite.
  Misfit(Simulator simulator, std::vector<Signal> observed, int lead_in = 0);

  [[nodiscard]] const Simulator& simulator() const;
  /// The misfit of the refined simulator (Simulator::refined) to the same data.
  [[nodiscard]] Misfit refined(int factor) const;
  [[nodiscard]] int channels() const;
  [[nodiscard]] int samples() const;     ///< scored samples of each channel
  [[nodiscard]] int parameters() const;  ///< minimum length of a parameter vector

  /// S_c = Σ_n r_c(n)² of `sets` parameter vectors, stored one after the other in `thetas` (all of
  /// equal length), written to out[set · channels() + c]. +∞ for a vector whose trajectory fails,
  /// so that a Gaussian log-likelihood is -∞. Vectors with the same number of substeps advance
  /// together in SIMD lanes; the result of a vector does not depend on the others. Allocates only
  /// in the first call of a thread.
  void sums_of_squares(std::span<const double> thetas, int sets, std::span<double> out) const;

  /// Computes the sums of squares, with +∞ also for a vector whose Σ_c weights[set · channels() +
  /// c] S_c exceeds limits[set]. The integration of such a vector ends at once, so that vectors
  /// with a large misfit need little time.
  void sums_of_squares_within(std::span<const double> thetas, int sets,
                              std::span<const double> weights, std::span<const double> limits,
                              std::span<double> out) const;

  /// The sums of one vector. Returns false, with `out` undefined, if the trajectory fails or Σ_c
  /// weights[c] S_c exceeds `limit`. `weights` (>= 0) and `out` have one entry per channel.
  [[nodiscard]] bool sums_of_squares_within(std::span<const double> theta,
                                            std::span<const double> weights, double limit,
                                            std::span<double> out) const;

  /// The residuals, out[c · samples() + n]. Returns false, with `out` undefined, if the trajectory
  /// fails.
  [[nodiscard]] bool residuals(std::span<const double> theta, std::span<double> out) const;
  /// The residuals of `sets` vectors, one after the other in `thetas` and in `out`; done[set] is 0
  /// for a failed trajectory, and its part of `out` undefined. Vectors share lanes as in
  /// sums_of_squares.
  void residuals(std::span<const double> thetas, int sets, std::span<double> out,
                 std::span<char> done) const;
  /// True if a residual depends on entry `parameter` of the parameter vector.
  [[nodiscard]] bool depends_on(int parameter) const;

 private:
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

}  // namespace wheeltap::dynamics
