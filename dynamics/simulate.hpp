// The response of a chain to measured or prescribed excitation, and its misfit to a measured
// response.
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

/// The motion of mass 0. At least one of the two must be there. Without an acceleration [m/s²] it
/// is that of the natural cubic spline through the displacement: linear between samples as every
/// excitation here, and with the displacement as its exact double integral. The displacement [m]
/// (and the spline's velocity) also turns relative motion into absolute. The offset of a
/// displacement moves nothing but the absolute displacements.
struct BaseMotion {
  Signal acceleration = {};
  Signal displacement = {};
};

/// What drives the chain, all signals of equal length. Between samples every signal is linear.
struct Excitation {
  double sample_rate_hz = 0.0;
  std::vector<Force> forces = {};
  std::optional<BaseMotion> base = {};
};

/// What is looked at.
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
  automatic,    ///< exact or piecewise where they apply; series where a law switches or a link
                ///< sticks and slips, or where they are preferred; else, or with a fixed number of
                ///< substeps, Runge-Kutta
  runge_kutta,  ///< the classical fourth-order scheme; with exact friction its steps end where a
                ///< link comes to rest or breaks away
  exact,        ///< the exact discrete solution; only for linear chains
  piecewise,    ///< for chains whose nonlinear laws, at most four, are bilinear or contact: exact
                ///< over a sample in which none of them switches, series over the others
  series  ///< Taylor series in time of degree 7 to 12, in pieces; from switch to switch, whose
          ///< times are found by Newton's method. For bilinear, contact, quadratic and cubic
          ///< laws and exact friction.
};

/// The vector instructions to use. Results are the same to the last bit for all of them.
using base::Instructions;

inline constexpr int kMaxSubsteps = 4096;
/// Of those that follow the motion, in its fastest sample.
inline constexpr int kMaxPacedSubsteps = 4 * kMaxSubsteps;

struct SimulatorOptions {
  Integrator integrator = Integrator::automatic;
  /// For `automatic`: series rather than Runge-Kutta. They lose 1e-9 instead of 1e-5 in a period,
  /// at two to three times the cost.
  bool prefer_series = false;
  /// Runge-Kutta steps between two samples of the excitation; 0: chosen for every parameter vector,
  /// as the next of 1, 2, 3, 4, 6, 8, 12, … 4096 that keeps ω h <= step_limit and γ h <= 1 for the
  /// bounds of stiffest_rates, and γ h <= 5 step_limit where that is less. Laws whose rate grows
  /// with the speed of their link (LawInfo::paced) shorten these steps where the motion asks for
  /// it, so that the product of their rate and a step is at most 1 and 5 step_limit, up to
  /// kMaxPacedSubsteps. A vector that would need more fails. For `series` and `piecewise` these are
  /// the pieces of a sample, with ω h and γ h <= 0.7 (and <= 3.5 step_limit).
  int substeps = 0;
  /// One step of length h shifts a frequency ω by the factor 1 - (ω h)⁴/120 and adds a damping
  /// ratio (ω h)⁵/144: 1.3e-5 and 2.2e-6 at 0.2.
  double step_limit = 0.2;
  /// Of Simulator::refined: at least so many times the steps that the limit, so many times as long,
  /// would choose.
  int refinement = 1;
  /// The extension [m] of each link up to which stiffest_rates considers nonlinear laws; empty: 0.
  std::vector<double> extension = {};
  /// Every `stride`-th sample of the excitation is a sample of the response (for an excitation that
  /// was upsampled by that factor).
  int stride = 1;
  /// A trajectory in which a relative displacement exceeds this [m] has blown up.
  double displacement_bound = 1e6;
  Instructions instructions = Instructions::automatic;
};

/// How an integration ended.
enum class Outcome {
  complete,
  impossible,      ///< parameters that make no sense: a mass <= 0, a gap < 0
  steps_too_long,  ///< there would have to be more of them than may be, or a given number was too
                   ///< few for the scheme to be stable
  diverged         ///< grown beyond the displacement bound, or not finite
};

struct Response {
  Eigen::MatrixXd values;  ///< samples × sensors; empty if failed
  Outcome outcome = Outcome::complete;
  bool failed = false;  ///< outcome other than complete
  int substeps = 0;     ///< steps a sample, where taken; 0 for the exact solution
};

/// Whether Integrator::series can integrate the chain.
[[nodiscard]] bool has_series(const Chain& chain);

/// Integrates one chain for many parameter vectors. Forces and base acceleration are linear between
/// samples (first-order hold); the state starts at the first sample; accelerations are those of the
/// equation of motion at the sample. Immutable: any number of threads may use one.
class Simulator {
 public:
  /// Throws std::invalid_argument for an invalid chain, excitation signals of unequal length or
  /// with values that are not finite, masses that do not exist, an absolute displacement or
  /// velocity of a base-driven chain without base displacement, an exact solution asked of a
  /// nonlinear chain.
  Simulator(Chain chain, Excitation excitation, std::vector<Sensor> sensors,
            InitialState initial = {}, SimulatorOptions options = {});

  [[nodiscard]] const Chain& chain() const;
  [[nodiscard]] const SimulatorOptions& options() const;
  /// The one in use: never `automatic`.
  [[nodiscard]] Integrator integrator() const;
  [[nodiscard]] const std::vector<Sensor>& sensors() const;
  [[nodiscard]] int samples() const;     ///< of the response
  [[nodiscard]] int parameters() const;  ///< entries a parameter vector must have at least
  /// Steps a sample (or pieces) for these parameters; 0 for the exact solution, -1 for infeasible
  /// ones.
  [[nodiscard]] int substeps(std::span<const double> theta) const;

  /// The same with steps a `factor`-th as long, to see what their length does to a response. Throws
  /// std::invalid_argument where fixed sub-steps would become more than kMaxSubsteps.
  [[nodiscard]] Simulator refined(int factor) const;
  /// The same chain under the same excitation, looked at and integrated otherwise.
  [[nodiscard]] Simulator with(std::vector<Sensor> sensors, SimulatorOptions options) const;

  [[nodiscard]] Response simulate(std::span<const double> theta) const;
  /// Several parameter vectors at once, one after the other in `thetas`.
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
  /// samples are integrated and not scored. Throws std::invalid_argument otherwise, and for values
  /// scored that are not finite.
  Misfit(Simulator simulator, std::vector<Signal> observed, int lead_in = 0);

  [[nodiscard]] const Simulator& simulator() const;
  /// The same for the refined simulator (Simulator::refined).
  [[nodiscard]] Misfit refined(int factor) const;
  [[nodiscard]] int channels() const;
  [[nodiscard]] int samples() const;     ///< scored, of each channel
  [[nodiscard]] int parameters() const;  ///< entries a parameter vector must have at least

  /// S_c = Σ_n r_c(n)² of `sets` parameter vectors, one after the other in `thetas` (all of equal
  /// length), written to out[set · channels() + c]; +∞ for a vector whose trajectory fails, so that
  /// a Gaussian log-likelihood becomes -∞. Vectors with the same number of sub-steps advance
  /// together in SIMD lanes; a vector's result does not depend on its company. Allocates nothing
  /// after the first call of a thread.
  void sums_of_squares(std::span<const double> thetas, int sets, std::span<double> out) const;

  /// The same, but +∞ also for a vector whose Σ_c weights[set · channels() + c] S_c exceeds
  /// limits[set]: its integration ends where that is known, so that hopeless vectors cost little.
  void sums_of_squares_within(std::span<const double> thetas, int sets,
                              std::span<const double> weights, std::span<const double> limits,
                              std::span<double> out) const;

  /// The sums of one vector, or false, and `out` undefined, if the trajectory fails or
  /// Σ_c weights[c] S_c exceeds `limit`. `weights` (>= 0) and `out` have one entry a channel.
  [[nodiscard]] bool sums_of_squares_within(std::span<const double> theta,
                                            std::span<const double> weights, double limit,
                                            std::span<double> out) const;

  /// The residuals themselves, out[c · samples() + n]. Returns false, and leaves `out` undefined,
  /// if the trajectory fails.
  [[nodiscard]] bool residuals(std::span<const double> theta, std::span<double> out) const;
  /// Those of `sets` vectors, one after the other in `thetas` and in `out`; done[set] is 0 where
  /// the trajectory fails, and its part of `out` undefined. They advance as in sums_of_squares.
  void residuals(std::span<const double> thetas, int sets, std::span<double> out,
                 std::span<char> done) const;
  /// Whether a residual depends on entry `parameter` of the parameter vector.
  [[nodiscard]] bool depends_on(int parameter) const;

 private:
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

}  // namespace wheeltap::dynamics
