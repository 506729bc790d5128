// Curves of force against extension and rate for the links of a chain of masses.
#pragma once

#include <optional>
#include <vector>

#include "identification/sid/sid_problem.hpp"
#include "inference/engine/reversible_jump.hpp"

namespace wheeltap::identification {

/// The posterior of a link's static tension [N] (dynamics/link_tension.hpp) under one model, at the
/// extensions [m] that occur in the motion predicted at the posterior mean.
struct LinkCurve {
  int a = 0, b = 0;  ///< masses at the ends of the link
  std::vector<double> extension;
  std::vector<double> q2_5, q50, q97_5;  ///< quantiles of the tension
};

/// Computes one curve per link of a model with draws. Links whose force law is the same in every
/// draw are omitted. The curves use at most 400 draws, evenly spread over the Markov chains. The
/// result is empty if the simulation of the model fails at the posterior mean.
[[nodiscard]] std::optional<std::vector<LinkCurve>> link_laws(const SidProblem& problem,
                                                              const inference::Posterior& posterior,
                                                              int model);

/// Force law of a link, averaged over the models: the average of the weighted draws of all models,
/// each evaluated with the force laws of its model.
struct LinkLaw {
  /// Static tension for the extensions that occur in the motion at the posterior mean of the most
  /// probable model.
  LinkCurve at_rest;
  /// The tension at zero extension [N] against the rates [m/s] that occur at the posterior mean.
  /// Force laws with memory do not contribute to this tension.
  std::vector<double> rate, q2_5, q50, q97_5;
  /// Force-state map (Masri & Caughey 1979, J. Appl. Mech. 46:433) of a link between the ground and
  /// a mass without other links; empty for other links. The map gives the measured tension Σ F - m
  /// ÿ against extension and rate at up to 500 points; m is the posterior mean of the mass.
  /// Extension, rate and acceleration are measured values or finite differences of measured values.
  /// The step of the differences is the longest that the frequency of the motion allows (half a
  /// radian). Quantities without measured values come from the model.
  struct Point {
    double extension = 0.0, rate = 0.0, tension = 0.0;
  };
  std::vector<Point> map;
};

/// Averaged force laws of the links with the given indices, from at most 400 draws. `shown` is the
/// most probable model with draws. The result is empty if the simulation of this model fails at
/// its posterior mean.
[[nodiscard]] std::vector<LinkLaw> averaged_laws(const SidProblem& problem,
                                                 const inference::Posterior& posterior, int shown,
                                                 const std::vector<int>& links);

}  // namespace wheeltap::identification
