// Force laws of a chain's links, as curves.
#pragma once

#include <optional>
#include <vector>

#include "identification/sid/sid_problem.hpp"
#include "inference/engine/reversible_jump.hpp"

namespace wheeltap::identification {

/// The posterior of a link's static tension [N] (dynamics/link_tension.hpp) under one model, over
/// the extensions [m] of the motion at the posterior mean.
struct LinkCurve {
  int a = 0, b = 0;  ///< masses that it joins
  std::vector<double> extension;
  std::vector<double> q2_5, q50, q97_5;  ///< quantiles of the tension
};

/// One curve per link of a drawn model, except links with the same law in every draw. Empty if the
/// model's response fails at the posterior mean. At most 400 draws, evenly spread over the chains.
[[nodiscard]] std::optional<std::vector<LinkCurve>> link_laws(const SidProblem& problem,
                                                              const inference::Posterior& posterior,
                                                              int model);

/// A link's law averaged over the models: computed from weighted draws of all models, each with the
/// laws of its model.
struct LinkLaw {
  LinkCurve at_rest;  ///< over the extensions at the posterior mean of the most probable model
  /// The tension at zero extension [N] over the rates [m/s] of that motion; laws with memory
  /// contribute nothing.
  std::vector<double> rate, q2_5, q50, q97_5;
  /// Force-state map (Masri & Caughey 1979, J. Appl. Mech. 46:433) of a link between the ground and
  /// a mass without other links: the tension Σ F - m ÿ from the measured motion, with m at its
  /// posterior mean, over extension and rate. Extension, rate and acceleration are measured values,
  /// or finite differences of measured values with the longest step that the frequency of the
  /// motion allows (half a radian). Other values are those of the model. Empty for other links; at
  /// most 500 points.
  struct Point {
    double extension = 0.0, rate = 0.0, tension = 0.0;
  };
  std::vector<Point> map;
};

/// Averaged laws of the links with these indices. At most 400 draws. Empty if the response of the
/// most probable drawn model, `shown`, fails at its posterior mean.
[[nodiscard]] std::vector<LinkLaw> averaged_laws(const SidProblem& problem,
                                                 const inference::Posterior& posterior, int shown,
                                                 const std::vector<int>& links);

}  // namespace wheeltap::identification
