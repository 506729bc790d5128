// What annealing saw and the draws may not have: followed by the chains' own steps.
#pragma once

#include <vector>

#include "base/eigen.hpp"
#include "inference/engine/run_context.hpp"

namespace wheeltap::inference {

/// So much of the probability (lacks_annealed), less than the verdict asks for, makes walks, and
/// fits to what they met.
inline constexpr double kWorthFollowing = 0.01;

/// Annealing reaches the posterior from everywhere at once, and so draws parts of it, as the ends
/// of a ridge that turns, which neither the fitted mixtures nor, by their small steps, the chains
/// come to. Where more of its draws of a model than of the chains' lie beyond the mixture, chains
/// are started at them: what is only annealing's own error walks home in a thousand steps, what is
/// the posterior's stays. Fills in ModelFindings::annealed_beyond, of models that matter, after
/// weigh(); returns where such walks were beyond their model's mixture, dimension × n, one a model.
[[nodiscard]] std::vector<Eigen::MatrixXd> follow_annealed(RunContext& run, RunState& state);

}  // namespace wheeltap::inference
