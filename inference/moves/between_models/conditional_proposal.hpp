// Component proposals from mixtures fitted to pilot samples.
#pragma once

#include <memory>
#include <vector>

#include "base/eigen.hpp"
#include "inference/moves/between_models/component_proposal.hpp"
#include "inference/moves/mixture_jump.hpp"

namespace wheeltap::inference {

/// The pilot mixture of the model with one more component, Σ_l w_l N(z; μ_l, Σ_l), conditioned on
/// the current set of components. With z_I the coordinates of the set and J those of component j,
///
///   q(c) = ε φ(c) + (1 - ε) Σ_{j,l} p(j, l | z_I) N(c; μ_J + Σ_JI Σ_II⁻¹ (z_I - μ_I),
///                                                      Σ_JJ - Σ_JI Σ_II⁻¹ Σ_IJ),
///   p(j, l | z_I) ∝ w_l N(z_I; μ_I, Σ_II).
///
/// The conditional mixtures are computed once per pilot and shared by all threads.
class ConditionalMixtures {
 public:
  ConditionalMixtures(const ModelSpace& space, const PilotFit& fit, int kind);

  /// The l-th normal density of one model's mixture, conditional on the set without component j.
  struct Conditional {
    double log_weight;  ///< ln w_l - ln |L_I|
    int first;          ///< coordinates [first, first + width) belong to component j
    Eigen::VectorXd mean_rest;
    Eigen::MatrixXd inverse_rest;  ///< L_I⁻¹, lower
    Eigen::VectorXd mean_own;
    Eigen::MatrixXd regression;  ///< Σ_JI Σ_II⁻¹
    Eigen::MatrixXd factor;      ///< Cholesky factor of the conditional covariance
    Eigen::MatrixXd inverse_factor;
    double log_determinant;  ///< log determinant of `factor`
  };
  [[nodiscard]] const std::vector<Conditional>& of_model(int m) const {
    return conditionals_[static_cast<std::size_t>(m)];
  }

 private:
  std::vector<std::vector<Conditional>> conditionals_;
};

class ConditionalProposal : public ComponentProposal {
 public:
  ConditionalProposal(std::shared_ptr<const ConditionalMixtures> mixtures, const ModelSpace& space,
                      int kind);
  void condition(const State& context, int kind, int skip, double beta) override;
  void draw(base::Random& random, std::span<double> z) override;
  [[nodiscard]] double log_density_ratio(std::span<const double> z) const override;

 private:
  static constexpr double kDefensive = 0.1;    ///< weight ε of the defensive component
  static constexpr double kNegligible = 1e-5;  ///< terms with a smaller p(j, l | z_I) are dropped

  struct Term {
    double probability;
    Eigen::VectorXd mean;
    const ConditionalMixtures::Conditional* conditional;
  };
  std::shared_ptr<const ConditionalMixtures> mixtures_;
  const ModelSpace* space_;
  Eigen::Index width_;
  Eigen::VectorXd rest_, scratch_;
  std::vector<double> logs_;
  std::vector<Term> terms_;
  std::size_t used_ = 0;  ///< number of terms in use; the vectors keep their memory
};

}  // namespace wheeltap::inference
