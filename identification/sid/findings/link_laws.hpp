// The laws of a chain's links as curves: what a system identification found, drawn.
#pragma once

#include <optional>
#include <vector>

#include "identification/sid/sid_problem.hpp"
#include "inference/engine/reversible_jump.hpp"

namespace wheeltap::identification {

/// The tension at rest [N] (dynamics/link_tension.hpp) that a model's draws give a link, over the
/// extensions [m] that it goes through at the posterior mean.
struct LinkCurve {
  int a = 0, b = 0;  ///< the masses it joins
  std::vector<double> extension;
  std::vector<double> q2_5, q50, q97_5;  ///< of the tension
};

/// One a link of a drawn model, but for links that no draw can move; none where the model's
/// response fails at the posterior mean. At most 400 draws, evenly spread over the chains.
[[nodiscard]] std::optional<std::vector<LinkCurve>> link_laws(const SidProblem& problem,
                                                              const inference::Posterior& posterior,
                                                              int model);

/// A link's law whatever the model: draws of all models by what they count, each with its own laws.
struct LinkLaw {
  LinkCurve at_rest;  ///< over the extensions of the most probable model's posterior mean
  /// At the extension 0 [N] over the rates [m/s] of that motion. Laws with memory count nothing.
  std::vector<double> rate, q2_5, q50, q97_5;
  /// Masri & Caughey's map (1979, J. Appl. Mech. 46:433) of a link between the ground and a mass
  /// that no other link holds: the tension Σ F - m ÿ that its measured motion asks for, the mass at
  /// its posterior mean, beside its extension and rate. Each of the three is measured, or the
  /// difference of what is, over steps as long as the motion's frequency allows (half a radian);
  /// what a sensor cannot give by differences is the model's. Empty for other links; at most 500
  /// points.
  struct Point {
    double extension = 0.0, rate = 0.0, tension = 0.0;
  };
  std::vector<Point> map;
};

/// Of the links of these indices. At most 400 draws; empty where the response of the most probable
/// model (`shown`, drawn) fails at its posterior mean.
[[nodiscard]] std::vector<LinkLaw> averaged_laws(const SidProblem& problem,
                                                 const inference::Posterior& posterior, int shown,
                                                 const std::vector<int>& links);

}  // namespace wheeltap::identification
