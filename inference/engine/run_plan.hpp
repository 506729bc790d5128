// What a run will take in likelihood calls, as far as that can be planned before it begins.
#pragma once

#include "inference/model/target.hpp"
#include "inference/options.hpp"

namespace wheeltap::inference {

/// Likelihood calls of each stage, all chains together. A run that has not converged after its
/// draws goes on and takes more.
struct RunPlan {
  double explore = 0.0;  ///< climbs, annealing or tempering, and weighing what they found
  double tune = 0.0;     ///< settling included
  double sample = 0.0;
  double evidence = 0.0;
  /// Calls on the whole record that the calls of `explore` amount to: where data are a record, most
  /// of these are on its first samples. Else the same number.
  double explore_on_all_data = 0.0;

  [[nodiscard]] double calls() const { return explore + tune + sample + evidence; }
};

/// What Options::quick stands for: some 16 climbs a model, a thousand draws from the normals about
/// their modes, 4 x 300 draws.
[[nodiscard]] Options as_a_look(Options options);

[[nodiscard]] RunPlan plan_of(const Problem& problem, const Options& options);

/// The first part of it, for the monitor of a run on its way: what follows tempering over sets of
/// components.
[[nodiscard]] double planned_searches(const Problem& problem, const Options& options);

}  // namespace wheeltap::inference
