// What each measured mode says of damage.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "identification/structural/damage/damage_findings.hpp"
#include "identification/structural/damage/damage_problem.hpp"
#include "inference/diagnosis/posterior.hpp"

namespace wheeltap::identification {

/// What the posterior would be without each mode, and MACs, from draws that are passed one by one.
/// Refers to the problem.
class SingleModes {
 public:
  explicit SingleModes(const DamageProblem& problem);
  /// A draw of `model` that counts `weight`; `log_densities`: of each mode, those not measured are
  /// ignored.
  void pass(int model, double weight, const std::vector<double>& log_densities);
  /// A draw of a problem `by_modes`, whose score at x is `scored`.
  void pass(int model, double weight, std::span<const double> x,
            const ModeObservation::Scored& scored);
  /// `winner`: the most probable model.
  void tell(int winner, FitFinding& out) const;

 private:
  const DamageProblem& problem_;
  std::vector<int> models_;
  std::vector<double> weights_;
  std::vector<std::vector<double>> densities_, macs_;  // of a mode, at each draw
  bool doubted_ = false, told_ = true;
};

/// Replicates [Hz] of the measured frequencies at a draw (chain, draw) of the posterior, which are
/// asked for in order: f_m(θ) + s_m(θ) e, e standard normal of `seed`, s_m the standard deviation
/// of the likelihood's own noise model. Refers to the problem and the posterior.
[[nodiscard]] std::function<std::vector<double>(std::size_t, std::size_t)> frequency_replicates(
    const DamageProblem& problem, const inference::Posterior& posterior, std::uint64_t seed);

/// Measured shapes beside those of the best draw, of each state that has some; of problems
/// `by_modes`.
[[nodiscard]] std::vector<ShapesBeside> best_shapes(const DamageProblem& problem,
                                                    const inference::Posterior& posterior);

}  // namespace wheeltap::identification
