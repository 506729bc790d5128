// Reversible-jump MCMC over a model space (Green 1995, 2003; Hastie & Green 2012), tuned
// automatically.
//
//   α = min{1, likelihood ratio · prior ratio · proposal ratio · |J|}        (see move.hpp)
#pragma once

#include "inference/diagnosis/posterior.hpp"
#include "inference/model/target.hpp"
#include "inference/options.hpp"

namespace wheeltap::inference {

/// Samples the posterior over (model, parameters) in three stages: explore, tune, sample. Only the
/// first two stages adapt the kernel; the kernel that produces the draws is fixed. The result holds
/// no reference to `problem`. Throws std::invalid_argument for options out of range, and the
/// LikelihoodErrors of Target and check_models.
[[nodiscard]] Posterior reversible_jump(const Problem& problem, const Options& options);

}  // namespace wheeltap::inference
