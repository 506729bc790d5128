// posterior.nc: every draw of a model-updating run, in the ArviZ InferenceData layout.
#pragma once

#include <string>

#include "apps/cases/update_case.hpp"
#include "identification/structural/updating/update_problem.hpp"
#include "inference/engine/reversible_jump.hpp"
#include "io/netcdf/netcdf_writer.hpp"

namespace wheeltap::apps {

/// Writes the contents of posterior.nc (NetCDF-4). Groups:
/// - posterior: one variable per parameter (chain, draw).
/// - sample_stats: lp, log_likelihood, k, move, accepted (chain, draw).
/// - posterior_predictive: frequency (chain, draw, mode): predictions of the measured modes plus
///   noise with the covariance of the likelihood and the seed `seed`.
/// - observed_data: frequency, sd (mode), shape (mode, sensor).
/// Throws io::FileError (unwritable) if NetCDF rejects a value.
void write_update_posterior(const io::NetcdfWriter& file, const std::string& run,
                            const UpdateCaseFile& parsed,
                            const identification::UpdateProblem& problem,
                            const inference::Posterior& posterior, std::uint64_t seed);

}  // namespace wheeltap::apps
