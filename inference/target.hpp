// The posterior over models and their parameters, prior and likelihood kept apart.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "inference/model_space.hpp"

namespace wheeltap::inference {

/// The data's side of a problem. One object serves one thread; it may keep scratch memory.
class Likelihood {
 public:
  virtual ~Likelihood() = default;

  /// ln p(data | model, x), every normaliser included; -∞ where x is impossible. NaN is a fault, and the
  /// sampler reports it with the model and the parameters. x is laid out as in Model.
  virtual double log_likelihood(int model, std::span<const double> x) = 0;

  /// The predicted observables of the last call to log_likelihood, or empty: recorded for posterior
  /// predictive checks and convergence of the responses.
  [[nodiscard]] virtual std::span<const double> prediction() const { return {}; }

  /// Standardised residuals (observed - predicted) / sd of the last call, or empty. Where they are given,
  /// ln p(data | ·) = c - ½ Σ residual², up to a c that adding a component does not change, and births
  /// can be proposed where they explain the residual.
  [[nodiscard]] virtual std::span<const double> residuals() const { return {}; }
};

/// Makes one likelihood a thread.
using LikelihoodFactory = std::function<std::unique_ptr<Likelihood>()>;

/// A factor of the prior that the independent priors of the space cannot express (for example that
/// change points are order statistics). It must be normalised: ∫ exp(log_factor) ∏ p(x_i) dx = 1 in
/// every model. It is never tempered.
using LogPriorFactor = std::function<double(int model, std::span<const double> x)>;

/// x → 2·center - x of one parameter of one kind's components, e.g. the mirror image of a location in a
/// symmetric structure: a map under which the likelihood is (nearly) unchanged.
struct Reflection {
  int kind = 0;       ///< index into ModelSpace::kinds()
  int parameter = 0;  ///< index into ComponentKind::parameters
  double center = 0.0;
};

/// Everything the engine asks of its user.
struct Problem {
  ModelSpace space;
  LikelihoodFactory likelihood;
  LogPriorFactor log_prior_factor = nullptr;  ///< optional
  std::vector<Reflection> reflections;        ///< optional: symmetries worth proposing
};

}  // namespace wheeltap::inference
