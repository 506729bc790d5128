// Conversion of a system identification case to a problem for the engine.
#pragma once

#include <memory>

#include "identification/sid/sid_case.hpp"
#include "inference/model/target.hpp"

namespace wheeltap::identification {

/// All data of a run, kept together because the problem's likelihood refers to it.
struct SidProblem {
  SidCase sid_case;
  std::vector<dynamics::Misfit> misfits;  ///< one per model; parameters as in SidCase::parameters
  inference::Problem problem;
  double seconds_a_likelihood = 0.0;  ///< estimate, on one core
  /// The further records, with the same parameter layout.
  std::vector<std::unique_ptr<const SidProblem>> further = {};

  /// Parameters of the case from those of a model (as in inference::Model); 0 for the others.
  [[nodiscard]] std::vector<double> theta(int model, std::span<const double> x) const;
};

/// The case with its first scored samples only.
[[nodiscard]] SidCase shortened(SidCase sid_case, int first);

/// Makes the problem. The log likelihood of model m is
///
///   Σ over channels c of  ln p(r_c | σ_c, c_c) + N ln |scale_c|,
///
/// with r_c the N scored residuals of the channel in SI units and p the density of its residual
/// model with the parameters c_c (residuals/residual_model.hpp). The last term, the density of the
/// raw samples, is present only if the scale is a parameter. The log likelihood of several records
/// is their sum, each with its own initial state; `misfits` are those of the first. Throws
/// InvalidInput (models, model).
[[nodiscard]] std::unique_ptr<const SidProblem> make_sid_problem(SidCase sid_case);

}  // namespace wheeltap::identification
