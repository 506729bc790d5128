// Conversion of a system identification case to an inference problem.
#pragma once

#include <memory>

#include "identification/sid/sid_case.hpp"
#include "inference/model/target.hpp"

namespace wheeltap::identification {

/// All data of a run in one object, because the problem's likelihood refers to them.
struct SidProblem {
  SidCase sid_case;
  /// Misfit function of each model; its parameters are those of SidCase::parameters
  std::vector<dynamics::Misfit> misfits;
  inference::Problem problem;
  double seconds_a_likelihood = 0.0;  ///< run time of a likelihood evaluation on one core [s]
  /// The problems of the further records, with the same parameter layout.
  std::vector<std::unique_ptr<const SidProblem>> further = {};

  /// Converts the parameters of a model (as in inference::Model) to parameters of the case.
  /// Parameters that the model does not have are 0.
  [[nodiscard]] std::vector<double> theta(int model, std::span<const double> x) const;
};

/// Returns the case with only the first `first` of its scored samples.
[[nodiscard]] SidCase shortened(SidCase sid_case, int first);

/// Makes the problem. The log likelihood of model m is
///
///   Σ over channels c of  ln p(r_c | σ_c, c_c) + N ln |scale_c|,
///
/// where r_c are the residuals, in SI units, of the N scored samples of channel c. p is the density
/// of its residual model with parameters c_c (residuals/residual_model.hpp). The last term converts
/// p to the density of the raw samples; it is present only if the scale is a parameter. For several
/// records, the log likelihood is the sum over the records, each with a separate initial state.
/// `misfits` are the misfits of the first record. Throws InvalidInput (models, model).
[[nodiscard]] std::unique_ptr<const SidProblem> make_sid_problem(SidCase sid_case);

}  // namespace wheeltap::identification
