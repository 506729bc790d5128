// What a damage run found: the general summary, and where on the beam.
#pragma once

#include "apps/damage_problem.hpp"
#include "apps/evidence.hpp"
#include "apps/summary.hpp"

namespace wheeltap::apps {

/// The whole of summary.json. `posterior` must have at least 4 draws a chain, all chains the same.
[[nodiscard]] Report summarise_damage(const DamageProblem& problem,
                                      const inference::Posterior& posterior,
                                      const std::vector<MethodEvidence>& evidence,
                                      const RunInfo& info);

/// Errors of an emulator on held-out FE runs, per count and mode, with a warning for every mode it
/// cannot predict. `noise` [Hz] is the measurement's sd of each mode, empty where not known.
[[nodiscard]] Report emulator_report(const FrequencyEmulator& emulator,
                                     const std::vector<double>& noise);
/// The measurement's sd [Hz] of each mode: the data's, or cov times `intact` where there are none
/// yet; empty where neither is known.
[[nodiscard]] std::vector<double> measurement_noise(const DamageCase& damage_case,
                                                    std::span<const double> intact);

/// "modes 5 to 20", "modes 3, 7 and 9".
[[nodiscard]] std::string name_modes(const std::vector<int>& modes);

}  // namespace wheeltap::apps
