// Predictions, likelihood and posterior of a case for other programs (`wheeltap serve`).
#pragma once

#include <memory>
#include <vector>

#include "apps/remote/umbridge_server.hpp"
#include "identification/sid/sid_problem.hpp"
#include "identification/structural/damage/damage_problem.hpp"
#include "identification/structural/updating/update_problem.hpp"

namespace wheeltap::apps {

/// Returns "forward": from the parameters of the structure, in alphabetical order, to the
/// frequencies [Hz] of the measured modes and of the modes to predict. "log_likelihood" and
/// "posterior": from all parameters to ln p(data | x), and to ln p(data | x) + ln p(x). The problem
/// must outlive the models.
[[nodiscard]] std::vector<ServedModel> served(
    std::shared_ptr<const identification::UpdateProblem> problem);

/// Returns "forward". Its inputs are place and severity (and extent [m], if unknown) of the largest
/// number of defects of each kind; severity 0 means no defect. The place is that of posterior.nc:
/// on a beam the location [m]; on other structures member (number from 0) and location [m from its
/// first node], or the number of a node, link or substructure. It predicts with the emulator if the
/// likelihood does. Each model NAME also has "log_likelihood NAME" and "posterior NAME", with the
/// same inputs for its number of defects. Throws std::invalid_argument if a kind has no severity.
[[nodiscard]] std::vector<ServedModel> served(
    std::shared_ptr<const identification::DamageProblem> problem);

/// Returns for each model (with its name if there are several) three functions of its parameters.
/// "forward" gives the response of every channel without noise at the samples of the likelihood
/// [SI], channel by channel, record by record. The others are "log_likelihood" and "posterior".
[[nodiscard]] std::vector<ServedModel> served(
    std::shared_ptr<const identification::SidProblem> problem);

}  // namespace wheeltap::apps
