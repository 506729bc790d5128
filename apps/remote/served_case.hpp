// What of a case can be asked for by others: predictions, likelihood, posterior.
#pragma once

#include <memory>
#include <vector>

#include "apps/remote/umbridge_server.hpp"
#include "identification/sid/sid_problem.hpp"
#include "identification/structural/damage/damage_problem.hpp"
#include "identification/structural/updating/update_problem.hpp"

namespace wheeltap::apps {

/// "forward": the parameters of the structure, alphabetically, to the frequencies [Hz] of the modes
/// measured and of those to be foretold. "log_likelihood" and "posterior": all parameters to
/// ln p(data | x), and to that and ln p(x). The problem must outlive them.
[[nodiscard]] std::vector<ServedModel> served(
    std::shared_ptr<const identification::UpdateProblem> problem);

/// "forward": of each kind of defect, as many as there may be at the most, place and severity (and
/// extent [m], where it is unknown) of each; a severity of 0 is none. The place is that of
/// posterior.nc: on a beam location [m]; on other structures member (its number from 0) and
/// location [m from its first node], or the number of a node, link or substructure. An emulator
/// predicts where the likelihood uses it. For each model with its name, "log_likelihood NAME" and
/// "posterior NAME", of the same numbers for the defects that there are. Throws
/// std::invalid_argument where a kind has no severity to be 0.
[[nodiscard]] std::vector<ServedModel> served(
    std::shared_ptr<const identification::DamageProblem> problem);

/// For each model (with its name, where there are several), all of them from its parameters:
/// "forward" to the response of every channel at the scored samples [SI], channel by channel,
/// record by record, without noise; "log_likelihood" and "posterior".
[[nodiscard]] std::vector<ServedModel> served(
    std::shared_ptr<const identification::SidProblem> problem);

}  // namespace wheeltap::apps
