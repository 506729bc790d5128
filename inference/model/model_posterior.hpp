// The posterior of one model alone.
#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "inference/model/evidence_warning.hpp"
#include "inference/model/target.hpp"

namespace wheeltap::inference {

/// Evidence of one model:
///
///   ln Z = ln ∫ p(data | model, x) p(x | model) dx.
struct Evidence {
  double log_evidence = 0.0;
  /// Standard error of ln Z. The error is 0 if ln Z is exact, and NaN if the method failed or gives
  /// no error (Laplace). If the method failed, ln Z is also NaN, and a warning gives the reason.
  double standard_error = 0.0;
  long likelihood_evaluations = 0;
  std::vector<EvidenceWarning> warnings{};
};

/// Placeholder for the evidence by a method that was not run or failed.
inline const Evidence kNoEvidence{.log_evidence = std::numeric_limits<double>::quiet_NaN(),
                                  .standard_error = std::numeric_limits<double>::quiet_NaN()};

/// The log posterior in standard normal coordinates, for one thread:
///
///   ln π(z) = ln p₀(z) + ln prior factor + ln likelihood,
///   p₀(z) = ∏_kinds k! · ∏ φ(z_i)   if the components are sorted by first coordinate, else 0.
///
/// p₀ is the prior of the unordered set, and integrates to 1.
class ModelPosterior {
 public:
  struct Value {
    double log_prior = 0.0;  ///< ln p₀ + ln prior factor
    double log_base = 0.0;   ///< ln p₀ alone
    double log_likelihood = 0.0;
    [[nodiscard]] double log_posterior() const { return log_prior + log_likelihood; }
    /// ln prior factor + ln likelihood: the log posterior minus ln p₀; -∞ if the components are not
    /// in order.
    double log_gain = 0.0;
  };

  /// Throws std::invalid_argument for a model outside the space. `problem` must outlive this
  /// object.
  ModelPosterior(const Problem& problem, int model);

  /// Evaluates the log posterior at z. All values are -∞ if z is not finite or its components are
  /// not in order. Throws LikelihoodError under the conditions of Target.
  Value operator()(std::span<const double> z);
  /// Evaluates the log posterior at z for a caller that needs only values with log_base + beta ·
  /// log_gain >= `level`. If this sum is below `level`, the function may return -∞.
  Value above(double level, double beta, std::span<const double> z);
  /// Evaluates the log posterior at several z, stored one after the other. Values of
  /// log_posterior() below `level` may be returned as -∞.
  void evaluate(std::span<const double> zs, std::span<Value> out,
                double level = -std::numeric_limits<double>::infinity());
  /// The physical parameters at the last z whose components were in order and that was not
  /// evaluated in a batch.
  [[nodiscard]] std::span<const double> x() const { return state_.x; }

  /// Sorts the exchangeable components of z.
  void order(std::span<double> z);
  /// ∂ ln π/∂z at z, whose components may be in any order; false if the gradient is not available
  /// (Target::gradient). The function also evaluates the log posterior at z.
  bool gradient(std::span<const double> z, std::span<double> out);
  [[nodiscard]] bool has_exact_derivatives() const { return target_.has_exact_derivatives(); }

  /// Target::gauss_newton at z.
  bool gauss_newton(std::span<const double> z, std::span<const double> dz,
                    std::span<double> gradient, std::span<double> information);

  /// Draws from p₀.
  void draw_prior(base::Random& random, std::span<double> z);

  [[nodiscard]] int dimension() const { return static_cast<int>(state_.z.size()); }
  [[nodiscard]] long evaluations() const { return target_.evaluations(); }
  template <class Parcel>
  void carry(Parcel& parcel) {
    target_.carry(parcel);
  }
  [[nodiscard]] const std::string& name() const { return target_.space()[state_.model].name; }

 private:
  Target target_;
  State state_;
  std::vector<State> states_;  ///< states for the evaluation of several z
  double constant_ = 0.0;
  bool has_sets_ = false;  ///< true if the model has more than one component of some kind
};

}  // namespace wheeltap::inference
