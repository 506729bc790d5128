// Reversible-jump MCMC over a model space (Green 1995, 2003; Hastie & Green 2012), with no tuning
// asked of its user.
//
//   α = min{1, likelihood ratio · prior ratio · proposal ratio · |J|}        (move.hpp, the one
//                                                                             place)
#pragma once

#include "inference/diagnosis/posterior.hpp"
#include "inference/model/target.hpp"
#include "inference/options.hpp"

namespace wheeltap::inference {

/// Samples the posterior over (model, parameters) in three stages (stages/): explore, tune, sample.
/// Adaptation happens in the first two only; the kernel that produces the draws is fixed. The
/// problem is not referred to once this has returned. Throws std::invalid_argument for options out
/// of range, LikelihoodError as Target and check_models do.
[[nodiscard]] Posterior reversible_jump(const Problem& problem, const Options& options);

}  // namespace wheeltap::inference
