// The draws of a damage problem as defects.
#pragma once

#include <cstddef>
#include <span>
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
      OfChain& of = chains_.emplace_back();
      of.begins.reserve(chain.size() + 1);
      for (std::size_t i = 0; i < chain.size(); ++i) {
        const auto present =
            problem.components(chain.model[i], {chain.theta.data() + i * width, width});
        of.components.insert(of.components.end(), present.begin(), present.end());
        of.begins.push_back(of.components.size());
      }
    }
  }
  [[nodiscard]] std::span<const DamageProblem::Component> at(std::size_t chain,
                                                             std::size_t draw) const {
    const OfChain& of = chains_[chain];
    return std::span(of.components).subspan(of.begins[draw], of.begins[draw + 1] - of.begins[draw]);
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
    for (std::size_t c = 0; c < chains_.size(); ++c) {
      for (std::size_t i = 0; i + 1 < chains_[c].begins.size(); ++i) visit(c, i);
    }
  }
  [[nodiscard]] const inference::ModelSpace& space() const { return problem_.problem.space; }

 private:
  struct OfChain {
    std::vector<DamageProblem::Component> components;  // of one draw after another
    std::vector<std::size_t> begins = {0};             // of each draw, and the end
  };

  const DamageProblem& problem_;
  const inference::Posterior& posterior_;
  std::vector<double> weights_;
  std::vector<OfChain> chains_;
};

}  // namespace wheeltap::identification
