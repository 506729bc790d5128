// posterior.nc of a system-identification run, in the ArviZ InferenceData layout.
#pragma once

#include <string>

#include "apps/cases/sid_case.hpp"
#include "apps/draw_columns.hpp"
#include "identification/sid/sid_predictive.hpp"

namespace wheeltap::apps {

/// Returns the column of the model and then one column per parameter.
[[nodiscard]] std::vector<DrawColumn> sid_columns(const identification::SidProblem& problem,
                                                  const inference::Posterior& posterior);

/// Writes the contents of posterior.nc (NetCDF-4). Groups:
/// - posterior: one variable per parameter (chain, draw), NaN in draws of models without the
///   parameter; model: the index of the model.
/// - sample_stats: as in posterior_file.hpp.
/// - posterior_predictive: one variable per response (chain, draw, sample): predictions plus noise
///   (seed `seed`) for the draws of `predictive`; draw_index has the indices of these draws.
/// - noise_free: one variable per response (quantile, sample): 2.5, 50 and 97.5 % quantiles of the
///   predictions without noise, over the same draws.
/// - link_paths: extension, rate and tension of each link (sample) of the most probable model at
///   its draw with the highest posterior density, and the tension from the data
///   (identification/sid/findings/link_paths.hpp).
/// - observed_data: one variable per response (sample) [SI], and time [s].
/// Throws io::FileError (unwritable) if NetCDF rejects a value.
void write_sid_posterior(const io::NetcdfWriter& file, const std::string& run,
                         const SidCaseFile& parsed, const identification::SidProblem& problem,
                         const inference::Posterior& posterior,
                         const identification::SidPredictive& predictive, std::uint64_t seed);

}  // namespace wheeltap::apps
