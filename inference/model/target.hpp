// The posterior over models and their parameters, with separate prior and likelihood.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "base/random.hpp"
#include "inference/model/model_space.hpp"

namespace wheeltap::inference {

/// The result of one evaluation of a likelihood. The caller owns the object and reuses it,
/// so that evaluations do not allocate memory.
struct Evaluation {
  double log_likelihood = -std::numeric_limits<double>::infinity();
  /// The predicted observables, or empty. Predicted observables are recorded for posterior
  /// predictive checks and for the convergence diagnosis of the responses.
  std::vector<double> prediction = {};
  /// Standardised residuals (observed - predicted) / sd, or empty. If given, the residuals must
  /// satisfy ln p(data | ·) = c - ½ Σ residual² with a constant c that does not depend on the
  /// number of components. Births are then proposed at locations where a new component reduces the
  /// residuals.
  std::vector<double> residuals = {};
  /// The common factor of all noise standard deviations if this factor is a parameter; 1 for known
  /// noise. The product residual · noise_scale therefore does not depend on this factor.
  double noise_scale = 1.0;

  /// Resets the values, but keeps the allocated memory.
  void clear() {
    log_likelihood = -std::numeric_limits<double>::infinity();
    prediction.clear();
    residuals.clear();
    noise_scale = 1.0;
  }
};

/// The likelihood of a problem's data. One object serves one thread. The object may keep scratch
/// memory if its results do not depend on earlier calls.
class Likelihood {
 public:
  virtual ~Likelihood() = default;

  /// ln p(data | model, x) with all normalising constants; -∞ if the likelihood is zero. NaN and +∞
  /// are floating-point faults, which count as -∞; if they are frequent, Target ends the run with
  /// an error that names the model and the parameters. x has the layout of Model.
  virtual double log_likelihood(int model, std::span<const double> x) = 0;

  /// Like log_likelihood, but the caller needs only values of at least `floor`. The
  /// likelihood may return -∞ as soon as it detects that the value is smaller (early rejection:
  /// Solonen et al. 2012, section 2).
  virtual double log_likelihood_above(double /*floor*/, int model, std::span<const double> x) {
    return log_likelihood(model, x);
  }

  /// Like log_likelihood_above, but writes all results of the likelihood at x to `out`, replacing
  /// its content.
  virtual void evaluate(double floor, int model, std::span<const double> x, Evaluation& out) {
    out.clear();
    out.log_likelihood = log_likelihood_above(floor, model, x);
  }
  /// Returns the results of `evaluate` without a floor.
  [[nodiscard]] Evaluation evaluation(int model, std::span<const double> x) {
    Evaluation out;
    evaluate(-std::numeric_limits<double>::infinity(), model, x, out);
    return out;
  }

  /// Evaluates several parameter vectors of one model, stored one after the other in `xs`. A
  /// likelihood can override this function to share work between the vectors.
  virtual void log_likelihoods(int model, std::span<const double> xs, std::span<double> out) {
    const std::size_t d = xs.size() / out.size();
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = log_likelihood(model, xs.subspan(i * d, d));
  }

  /// Evaluates several parameter vectors with early rejection: for vector i, the caller needs only
  /// values of at least floors[i].
  virtual void log_likelihoods_above(std::span<const double> /*floors*/, int model,
                                     std::span<const double> xs, std::span<double> out) {
    log_likelihoods(model, xs, out);
  }

  /// Optional: writes ∂ ln p(data | model, x)/∂x_i to out[i], in the units of 1/x_i, for any x with
  /// a positive likelihood, even if x was not evaluated before. Returns false, with `out`
  /// undefined, if there is no gradient. Searches and proposals use the gradient; acceptance ratios
  /// do not depend on the gradient. If the likelihood is a step function of x_i, the derivative is
  /// zero. The function should then write a difference quotient over one step or more.
  virtual bool gradient(int /*model*/, std::span<const double> /*x*/, std::span<double> /*out*/) {
    return false;
  }

  /// Optional: the Gauss-Newton approximation of ln p(data | model, ·) about an x with a positive
  /// likelihood: a quadratic function based on the first derivatives of the residuals (Nocedal &
  /// Wright 2006, section 10.3). With steps s,
  ///
  ///   gradient[i] = s_i ∂ ln p/∂x_i,   information[i d + j] = s_i s_j I_ij,
  ///
  /// where I is a positive semidefinite approximation of -∇² ln p. Derivatives may be computed as
  /// differences from x_i to x_i + s_i. Returns false, with undefined output, if there is no such
  /// approximation. Only searches use this approximation. One call counts as d + 1 likelihood
  /// evaluations, or as two with exact derivatives.
  virtual bool gauss_newton(int /*model*/, std::span<const double> /*x*/,
                            std::span<const double> /*steps*/, std::span<double> /*gradient*/,
                            std::span<double> /*information*/) {
    return false;
  }
  /// True if `gradient` and `gauss_newton` give exact derivatives, each in about the time of two
  /// evaluations.
  [[nodiscard]] virtual bool has_exact_derivatives() const { return false; }
};

/// Creates one likelihood per thread; never null.
using LikelihoodFactory = std::function<std::unique_ptr<Likelihood>()>;

/// A factor of the prior that the independent priors of the space cannot express (for example that
/// change points are order statistics). The factor must be normalised: ∫ exp(log_factor) ∏ p(x_i)
/// dx = 1 in every model. Tempering does not change this factor. NaN and +∞ end the run at once,
/// because a density cannot have these values.
using LogPriorFactor = std::function<double(int model, std::span<const double> x)>;

/// The map x → 2·center - x, applied to one parameter of each component of a kind. The likelihood
/// is (nearly) invariant under this map. An example is the mirror image of a location in a
/// symmetric structure.
struct Reflection {
  int kind = 0;       ///< index into ModelSpace::kinds()
  int parameter = 0;  ///< index into ComponentKind::parameters
  double center = 0.0;
};

class Move;

/// A user-defined MCMC move, e.g. a Transformation that uses special properties of the problem. The
/// engine creates the move for each chain and temperature at the start of every round.
struct NamedMove {
  std::string name;
  std::function<std::unique_ptr<Move>()> make;
  /// Largest factor by which the engine may increase the fraction of MCMC steps that use this move.
  /// The fraction increases if, at equal run time, the move changes the model more often than the
  /// engine's own moves.
  double most = 1.0;
};

/// Input of the engine.
struct Problem {
  ModelSpace space;
  LikelihoodFactory likelihood;
  LogPriorFactor log_prior_factor = nullptr;  ///< optional
  std::vector<Reflection> reflections{};      ///< optional: symmetries to propose
  /// Optional: moves in addition to the engine's own moves
  std::vector<NamedMove> moves{};
  /// Optional: a cheap approximation of `likelihood`, finite wherever `likelihood` is finite. Each
  /// proposal is first accepted or rejected with the approximation (delayed acceptance, Christen &
  /// Fox 2005). The sampled posterior remains the posterior of `likelihood`.
  LikelihoodFactory screen = nullptr;
  /// Optional, for long records: the number of samples, and the same problem with only the first
  /// samples of the record. The engine then searches for posterior modes on records of increasing
  /// length. Each search starts from the posterior mode for the shorter record. The posterior for
  /// the whole record can have too many posterior modes for a direct search.
  long samples = 0;
  std::function<std::shared_ptr<const Problem>(long first)> shortened = nullptr;
  /// True if an evaluation takes about a hundred times as long as an MCMC step, for example if it
  /// computes the modes of a large FE model. The engine then begins with fewer tuning steps and
  /// draws.
  bool costly = false;
};

/// State of a chain: a model and its parameters in standard normal coordinates, and the values of
/// the target at these coordinates.
struct State {
  int model = 0;
  std::vector<double> z;  ///< standard normal coordinates, in the layout of Model
  std::vector<double> x;  ///< the physical parameters of z
  double log_likelihood = -std::numeric_limits<double>::infinity();
  /// Log likelihood by the approximation. The value equals log_likelihood if the problem has no
  /// approximation.
  double log_screen = -std::numeric_limits<double>::infinity();
  double log_prior_factor = 0.0;
  std::vector<double> prediction;
  std::vector<double> residuals;
  double noise_scale = 1.0;
  bool screened = false;   ///< true: x, log_screen and residuals belong to z
  bool evaluated = false;  ///< true: log_likelihood and prediction also belong to z
};

/// Thrown if a model's likelihood is zero at every draw from its prior, or is too often NaN or +∞.
/// The message names the model and the parameter values.
class LikelihoodError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The posterior density of one problem, for one thread. The log density with respect to dz is
///
///   ln π(m, z) = ln P(m) + Σ_kinds ln k! + Σ ln φ(z_i) + ln prior factor + ln p(data | m, x(z)).
///
/// A log likelihood of NaN or +∞ counts as -∞ and is recorded. Throws LikelihoodError in two cases:
/// if all of the first 20 values of the likelihood or of its approximation are NaN or +∞, or if
/// more than 1 % of at least 1000 values are.
class Target {
 public:
  /// `prior_only` replaces the likelihood by 1. Throws std::invalid_argument if a factory of the
  /// problem is missing or returns null.
  Target(const Problem& problem, bool prior_only);

  /// Number of values that one likelihood has returned, and number of invalid values among them.
  struct Tally {
    long values = 0;
    long impossible = 0;  ///< number of values of NaN or +∞
  };
  /// The complete state of a target between two calls. If another target of the same problem
  /// receives this state, both targets give identical results.
  struct Memory {
    std::vector<double> bias;       ///< bias of each model (set_model_bias)
    std::vector<double> log_model;  ///< bias + ln P(m) + Σ ln k! - (d/2) ln 2π
    long evaluations = 0;
    long full_evaluations = 0;
    Tally proper{}, stand_in{};
  };
  [[nodiscard]] const Memory& memory() const { return memory_; }
  void set_memory(Memory memory) { memory_ = std::move(memory); }
  /// Packs only the counts for the target of the same problem on another rank, or unpacks these
  /// counts (base/parcel.hpp).
  template <class Parcel>
  void carry(Parcel& parcel) {
    parcel(memory_.evaluations, memory_.full_evaluations, memory_.proper.values,
           memory_.proper.impossible, memory_.stand_in.values, memory_.stand_in.impossible);
  }

  /// Computes all members of `state` that follow from model and z. The log likelihood of an
  /// infinite z is -∞. If the problem has an approximation, the residuals are those of the
  /// approximation.
  void evaluate(State& state);

  /// Evaluates several states of one model, without predictions and residuals. If `floors` are
  /// given, one per state, a log likelihood below its floor may be -∞.
  void evaluate(std::span<State> states, std::span<const double> floors = {});

  /// Computes the members of `state` that moves may use: all members or, if the problem has an
  /// approximation, all except the full likelihood and its prediction.
  void screen(State& state);
  /// Like `screen`, for a caller that needs only states with beta · log_screen + log_prior >=
  /// `level`. For all other states, log_screen may be -∞.
  void screen_above(double level, double beta, State& state);
  /// Computes those members of a screened state that `screen` does not compute.
  void complete(State& state);
  [[nodiscard]] bool has_screen() const { return screen_ != nullptr; }
  /// Likelihood::has_exact_derivatives.
  [[nodiscard]] bool has_exact_derivatives() const {
    return likelihood_ && likelihood_->has_exact_derivatives();
  }

  /// Log of the prior density of z, multiplied by the prior factor of the problem. Requires an
  /// evaluated state.
  [[nodiscard]] double log_prior(const State& state) const;
  /// Log density of the prior with respect to dx, for output.
  [[nodiscard]] double log_prior_physical(const State& state) const;

  /// ∂ ln π/∂z_i of an evaluated state, by the chain rule: ∂ ln p(data | x)/∂x_i · φ(z_i)/p(x_i) -
  /// z_i. Returns false, with `dz` undefined, if the posterior density of the state is zero, the
  /// likelihood has no finite gradient, or the problem has an approximation or a prior factor. The
  /// caller then uses differences. A gradient counts as one evaluation.
  bool gradient(const State& state, std::span<double> dz);

  /// ∂ ln π/∂z_i and a positive definite approximation of -∂² ln π/∂z_i ∂z_j (row by row) by
  /// Likelihood::gauss_newton with differences over dz, one step per coordinate. Returns false,
  /// with undefined output, if the posterior density at z is zero, if the problem has components,
  /// an approximation or a prior factor, or if the likelihood has no Gauss-Newton approximation at
  /// z. The function sets `state.x`, but not the log densities.
  bool gauss_newton(State& state, std::span<const double> dz, std::span<double> gradient,
                    std::span<double> information);

  /// Draws model and parameters from the prior; the prior factor is ignored. The state is not
  /// evaluated.
  void draw_prior(base::Random& random, State& state) const;
  /// Draws the parameters of one model from the prior. The state is not evaluated.
  void draw_prior(int model, base::Random& random, State& state) const;

  /// Sorts the components of each kind by their first parameter. Returns true if the components
  /// were sorted already.
  bool sort_components(State& state) const;
  [[nodiscard]] bool is_sorted(const State& state) const;

  /// Sets the constants that are added to the log prior of each model. During warm-up, the
  /// constants change the probabilities with which models are visited. log_prior_physical omits the
  /// constants.
  void set_model_bias(const std::vector<double>& bias);

  [[nodiscard]] const Problem& problem() const { return *problem_; }
  [[nodiscard]] const ModelSpace& space() const { return problem_->space; }
  /// Number of evaluations of the likelihood, or of its approximation if the problem has one.
  [[nodiscard]] long evaluations() const { return memory_.evaluations; }
  /// Number of evaluations of the full likelihood if the problem has an approximation; otherwise 0.
  [[nodiscard]] long full_evaluations() const { return memory_.full_evaluations; }
  /// Number of values so far that are NaN or +∞: values of the likelihood and of its approximation
  /// together.
  [[nodiscard]] long impossible() const {
    return memory_.proper.impossible + memory_.stand_in.impossible;
  }

 private:
  /// Computes x and the prior factor; false if the prior density of the state is zero.
  bool locate(State& state) const;
  /// Fills in `evaluation_`; returns the checked log likelihood.
  double call(Likelihood& likelihood, Tally& tally, const State& state, double floor);
  double checked(double log_likelihood, Tally& tally, const State& state) const;

  const Problem* problem_;
  std::unique_ptr<Likelihood> likelihood_;
  std::unique_ptr<Likelihood> screen_;
  Memory memory_;
  Evaluation evaluation_;  // scratch memory
  std::vector<double> batch_x_, batch_values_, batch_floors_;
};

}  // namespace wheeltap::inference
