// Predictions, likelihood and posterior of a case for other programs (`wheeltap serve`).
#pragma once

#include <memory>
#include <vector>

#include "apps/remote/umbridge_server.hpp"
#include "identification/sid/sid_problem.hpp"
#include "identification/structural/damage/damage_problem.hpp"
#include "identification/structural/updating/update_problem.hpp"

namespace wheeltap::apps {

/// Returns the models of an update case. The model "forward" maps the parameters of the structure,
/// in alphabetical order, to the frequencies [Hz] of the measured modes and of the modes to
/// predict. The model "log_likelihood" maps all parameters to ln p(data | x), "posterior" to ln
/// p(data | x) + ln p(x). The models keep `problem` alive.
[[nodiscard]] std::vector<ServedModel> served(
    std::shared_ptr<const identification::UpdateProblem> problem);

/// Returns the models of a damage case. The inputs of "forward" are location, severity and, if
/// unknown, extent [m] of each defect, for the largest number of defects of each kind. A severity
/// of 0 means no defect. The location is given as in posterior.nc. On a beam, the location is the
/// coordinate [m]. On other structures, the location is the member (index from 0) and the distance
/// [m] from its first node, or the index of a node, link or substructure. "forward" predicts with
/// the emulator if the likelihood uses the emulator. For each model NAME, there are also
/// "log_likelihood NAME" and "posterior NAME". Their inputs are the same, but only for as many
/// defects as the model has. Throws std::invalid_argument if a kind of defect has no severity.
[[nodiscard]] std::vector<ServedModel> served(
    std::shared_ptr<const identification::DamageProblem> problem);

/// Returns the models of a sid case: for each equation of motion, three functions of its
/// parameters. "forward" gives the noise-free response [SI] of every channel at the samples of the
/// likelihood, channel by channel, record by record. The other functions are "log_likelihood"
/// and "posterior". If the case has several equations of motion, the names of the functions contain
/// the name of the equation.
[[nodiscard]] std::vector<ServedModel> served(
    std::shared_ptr<const identification::SidProblem> problem);

}  // namespace wheeltap::apps
