// The draws of a damage problem as defects.
#pragma once

#include <vector>

#include "identification/damage_problem.hpp"
#include "identification/marginal.hpp"
#include "inference/posterior.hpp"

namespace wheeltap::identification {

inline constexpr double kWorthTelling = 0.05;  ///< counts with less probability are not described

/// Everything the draws say, unpacked once. Refers to both.
class UnpackedDraws {
 public:
  UnpackedDraws(const DamageProblem& problem, const inference::Posterior& posterior)
      : problem_(problem), posterior_(posterior), weights_(model_weights(posterior)) {
    const auto width = static_cast<std::size_t>(posterior.dimension);
    for (const auto& chain : posterior.chains) {
      components_.emplace_back();
      for (std::size_t i = 0; i < chain.model.size(); ++i) {
        components_.back().push_back(
            problem.components(chain.model[i], {chain.theta.data() + i * width, width}));
      }
    }
  }
  [[nodiscard]] const std::vector<DamageProblem::Component>& at(std::size_t chain,
                                                                std::size_t draw) const {
    return components_[chain][draw];
  }
  [[nodiscard]] const inference::Posterior& posterior() const { return posterior_; }
  [[nodiscard]] const DamageProblem& problem() const { return problem_; }
  [[nodiscard]] int model(std::size_t chain, std::size_t draw) const {
    return posterior_.chains[chain].model[draw];
  }
  /// What it counts in averages over models, 1 on average.
  [[nodiscard]] double weight(std::size_t chain, std::size_t draw) const {
    return weights_[static_cast<std::size_t>(model(chain, draw))];
  }
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (std::size_t c = 0; c < components_.size(); ++c) {
      for (std::size_t i = 0; i < components_[c].size(); ++i) visit(c, i);
    }
  }
  [[nodiscard]] const inference::ModelSpace& space() const { return problem_.problem.space; }

 private:
  const DamageProblem& problem_;
  const inference::Posterior& posterior_;
  std::vector<double> weights_;
  std::vector<std::vector<std::vector<DamageProblem::Component>>> components_;
};

}  // namespace wheeltap::identification
