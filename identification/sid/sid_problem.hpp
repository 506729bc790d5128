// From what is asked of chains of masses to a problem for the engine.
#pragma once

#include <memory>

#include "identification/sid/sid_case.hpp"
#include "inference/model/target.hpp"

namespace wheeltap::identification {

/// All that a run needs, kept together because the problem's likelihood refers to it.
struct SidProblem {
  SidCase sid_case;
  std::vector<dynamics::Misfit> misfits;  ///< one a model; parameters as in SidCase::parameters
  inference::Problem problem;
  double seconds_a_likelihood = 0.0;  ///< about, on one core
  /// Of the further records, with parameters laid out alike.
  std::vector<std::unique_ptr<const SidProblem>> further = {};

  /// The parameters of the case from those of a model (as in inference::Model); 0 for the others.
  [[nodiscard]] std::vector<double> theta(int model, std::span<const double> x) const;
};

/// The case of the first scored samples alone.
[[nodiscard]] SidCase shortened(SidCase sid_case, int first);

/// The log likelihood of model m is
///
///   Σ over channels c of  ln p(r_c | σ_c, c_c) + N ln |scale_c|,
///
/// r_c the N scored residuals of the channel in SI units and p the density of its residual model
/// with the parameters c_c (residuals/residual_model.hpp); the last term, the density of the raw
/// samples, only where the scale is a parameter. Of several records it is their sum, each with the
/// initial state of its own record; `misfits` are those of the first. Throws InvalidInput (models,
/// model).
[[nodiscard]] std::unique_ptr<const SidProblem> make_sid_problem(SidCase sid_case);

}  // namespace wheeltap::identification
