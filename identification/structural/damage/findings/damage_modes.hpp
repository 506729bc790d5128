// Contribution of each measured mode to the damage identification.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "identification/structural/damage/damage_problem.hpp"
#include "identification/structural/damage/findings/damage_findings.hpp"
#include "inference/diagnosis/posterior.hpp"

namespace wheeltap::identification {

/// Accumulates MACs, and the effect of omitting each measured mode, from draws that are passed one
/// by one. The problem must outlive the object.
class SingleModes {
 public:
  explicit SingleModes(const DamageProblem& problem);
  /// Adds a draw of `model` with weight `weight`. `log_densities` has one entry per mode; entries
  /// of unmeasured modes are ignored.
  void pass(int model, double weight, const std::vector<double>& log_densities);
  /// Adds a draw x with its scored modes, for a problem with matched modes (`by_modes`).
  void pass(int model, double weight, std::span<const double> x,
            const ModeObservation::Scored& scored);
  /// Writes the results. `winner` is the most probable model.
  void write(int winner, FitFinding& out) const;

 private:
  const DamageProblem& problem_;
  std::vector<int> models_;
  std::vector<double> weights_;
  std::vector<std::vector<double>> densities_, macs_;  // values of each mode at each draw
  bool may_be_spurious_ = false, comparable_ = true;
};

/// Returns a function that replicates the measured frequencies [Hz] at a draw (chain, draw) of the
/// posterior: f_m(θ) + s_m(θ) e, with e standard normal (from `seed`) and s_m the standard
/// deviation of the likelihood's noise model. Call the function in the order of the draws. The
/// problem and the posterior must outlive the returned function.
[[nodiscard]] std::function<std::vector<double>(std::size_t, std::size_t)> frequency_replicates(
    const DamageProblem& problem, const inference::Posterior& posterior, std::uint64_t seed);

/// Measured and computed shapes at the best draw, for each state with shapes. The problem must have
/// matched modes (`by_modes`).
[[nodiscard]] std::vector<ShapesBeside> best_shapes(const DamageProblem& problem,
                                                    const inference::Posterior& posterior);

}  // namespace wheeltap::identification
