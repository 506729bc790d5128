// posterior.nc of a system-identification run, in the ArviZ InferenceData layout.
#pragma once

#include <string>

#include "apps/cases/sid_case.hpp"
#include "apps/draw_columns.hpp"
#include "identification/sid/sid_predictive.hpp"

namespace wheeltap::apps {

/// A column a parameter, after that of the model.
[[nodiscard]] std::vector<DrawColumn> sid_columns(const identification::SidProblem& problem,
                                                  const inference::Posterior& posterior);

/// Fills a NetCDF-4 file with the groups
///   posterior             one variable a parameter (chain, draw), NaN where the model has none;
///                         model, the model's number
///   sample_stats          as in posterior_file.hpp
///   posterior_predictive  one variable a response (chain, draw, sample), noise of `seed` added;
///                         its draws are those of `predictive`, numbered in draw_index
///   noise_free            one variable a response (quantile, sample): 2.5, 50 and 97.5 % of what
///                         the same draws predict without noise
///   link_paths            extension, rate, tension of each link (sample) in the motion of the most
///                         probable model's best draw, and what the data say of the tension
///                         (identification/sid/findings/link_paths.hpp)
///   observed_data         one variable a response (sample) [SI], and time [s]
/// Throws io::FileError (unwritable) for what NetCDF does not take.
void write_sid_posterior(const io::NetcdfWriter& file, const std::string& run,
                         const SidCaseFile& parsed, const identification::SidProblem& problem,
                         const inference::Posterior& posterior,
                         const identification::SidPredictive& predictive, std::uint64_t seed);

}  // namespace wheeltap::apps
