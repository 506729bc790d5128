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

/// The group sample_stats; `k` is the number of something in each draw.
void write_sample_stats(const io::NetcdfWriter& file, const inference::Posterior& posterior,
                        const DrawColumn& k);

/// The variable of the group `posterior` that holds an unknown: "location", "support_location",
/// "cov".
[[nodiscard]] std::string damage_variable(const identification::DamageCase& damage_case,
                                          const identification::Unknown& unknown);

/// Models, numbers of defects, parameters and the slots of defects, as in posterior.nc.
[[nodiscard]] std::vector<DrawColumn> damage_columns(const identification::DamageProblem& problem,
                                                     const inference::Posterior& posterior);

/// Fills a NetCDF-4 file with the groups
///   posterior             parameters (chain, draw[, slot]), NaN in unused slots; k, model
///   sample_stats          lp, log_likelihood, k, move, accepted (chain, draw)
///   posterior_predictive  frequency (chain, draw, mode): predicted, with noise of `seed` by the
///                         likelihood's own noise model
///   observed_data         frequency (mode)
/// and attributes that name models and moves, and the run (RunFiles). Throws io::FileError
/// (unwritable) for what NetCDF does not take.
void write_posterior(const io::NetcdfWriter& file, const std::string& run,
                     const DamageCaseFile& damage_case,
                     const identification::DamageProblem& problem,
                     const inference::Posterior& posterior, std::uint64_t seed);

}  // namespace wheeltap::apps
