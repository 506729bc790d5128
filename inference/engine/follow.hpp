// Tests whether the posterior has mass in regions that SMC sampled but no chain visited.
#pragma once

#include <vector>

#include "base/eigen.hpp"
#include "inference/engine/run_context.hpp"

namespace wheeltap::inference {

/// If the fraction of SMC draws outside the fitted mixture exceeds that of chain draws by more than
/// this value (lacks_annealed), chains start at these SMC draws. Proposals are then fitted to the
/// states of these chains. The value is lower than the limit of the convergence diagnosis.
inline constexpr double kWorthFollowing = 0.01;

/// SMC starts from draws of the whole prior. SMC can therefore sample regions, such as the ends of
/// a curved ridge, that neither the fitted mixtures nor the chains' local moves reach. If the
/// fraction of a model's draws outside the mixture is larger for SMC than for the chains, this
/// function starts chains at the SMC draws. If a chain returns to the mixture within a thousand
/// steps, the draw was an artefact of SMC. If the chain stays outside, a part of the posterior lies
/// outside the mixture. The function sets ModelFindings::annealed_beyond of models with a
/// probability of at least 1 %; call this function after weigh(). Returns the states of the new
/// chains outside their model's mixture, dimension × n, one matrix per model.
[[nodiscard]] std::vector<Eigen::MatrixXd> follow_annealed(RunContext& run, RunState& state);

}  // namespace wheeltap::inference
