// Draws of a damage problem as lists of defects.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "identification/findings/marginal.hpp"
#include "identification/structural/damage/damage_problem.hpp"
#include "inference/diagnosis/posterior.hpp"

namespace wheeltap::identification {

/// The report omits numbers of defects with a probability below this value
inline constexpr double kWorthReporting = 0.05;

/// Converts draws to lists of defects. Both arguments must outlive the object. Not thread-safe.
class UnpackedDraws {
 public:
  UnpackedDraws(const DamageProblem& problem, const inference::Posterior& posterior)
      : problem_(problem), posterior_(posterior), weights_(model_weights(posterior)) {}

  /// The defects of a draw; valid until the next call.
  [[nodiscard]] std::span<const DamageProblem::Component> at(std::size_t chain,
                                                             std::size_t draw) const {
    const auto width = static_cast<std::size_t>(posterior_.dimension);
    const std::span theta(posterior_.chains[chain].theta);
    problem_.components(model(chain, draw), theta.subspan(draw * width, width), components_);
    return components_;
  }
  [[nodiscard]] const inference::Posterior& posterior() const { return posterior_; }
  [[nodiscard]] const DamageProblem& problem() const { return problem_; }
  [[nodiscard]] int model(std::size_t chain, std::size_t draw) const {
    return posterior_.chains[chain].model[draw];
  }
  /// Weight of the draw in averages over models; the average weight is 1.
  [[nodiscard]] double weight(std::size_t chain, std::size_t draw) const {
    return weights_[static_cast<std::size_t>(model(chain, draw))];
  }
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (std::size_t c = 0; c < posterior_.chains.size(); ++c) {
      for (std::size_t i = 0; i < posterior_.chains[c].size(); ++i) visit(c, i);
      posterior_.chains[c].let_go();
    }
  }
  [[nodiscard]] const inference::ModelSpace& space() const { return problem_.problem.space; }

 private:
  const DamageProblem& problem_;
  const inference::Posterior& posterior_;
  std::vector<double> weights_;
  mutable std::vector<DamageProblem::Component> components_;  // defects of the last unpacked draw
};

}  // namespace wheeltap::identification
