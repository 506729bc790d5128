// posterior.nc: every draw of a damage run, in the ArviZ InferenceData layout.
#pragma once

#include <string>

#include "apps/cases/damage_case.hpp"
#include "apps/draw_columns.hpp"
#include "identification/findings/findings.hpp"
#include "identification/structural/damage/damage_problem.hpp"
#include "inference/engine/reversible_jump.hpp"
#include "io/netcdf/netcdf_writer.hpp"

namespace wheeltap::apps {

/// Writes the group sample_stats. The variable `k` is the number of defects or terms of each draw.
void write_sample_stats(const io::NetcdfWriter& file, const inference::Posterior& posterior,
                        const DrawColumn& k);

/// Returns the name of the variable that stores an unknown in the group `posterior`: "location",
/// "support_location", "cov".
[[nodiscard]] std::string damage_variable(const identification::DamageCase& damage_case,
                                          const identification::Unknown& unknown);

/// Returns the columns of posterior.nc: models, numbers of defects, and parameters.
[[nodiscard]] std::vector<DrawColumn> damage_columns(const identification::DamageProblem& problem,
                                                     const inference::Posterior& posterior);

/// Writes the contents of posterior.nc (NetCDF-4). Attributes name models, moves and the run
/// (RunFiles). Groups:
/// - posterior: parameters (chain, draw[, slot]), NaN in unused slots; k, model.
/// - sample_stats: lp, log_likelihood, k, move, accepted (chain, draw).
/// - posterior_predictive: frequency (chain, draw, mode): predicted frequencies plus noise from the
///   noise model of the likelihood with the seed `seed`.
/// - observed_data: frequency (mode).
/// Throws io::FileError (unwritable) if NetCDF rejects a value.
void write_posterior(const io::NetcdfWriter& file, const std::string& run,
                     const DamageCaseFile& damage_case,
                     const identification::DamageProblem& problem,
                     const inference::Posterior& posterior, std::uint64_t seed);

}  // namespace wheeltap::apps
