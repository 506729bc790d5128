// posterior.nc of a system-identification run, in the ArviZ InferenceData layout.
#pragma once

#include <filesystem>

#include "apps/sid_summary.hpp"

namespace wheeltap::apps {

/// Writes a NetCDF-4 file with the groups
///   posterior             one variable a parameter (chain, draw), NaN where the model has none;
///                         model, the model's number
///   sample_stats          as in posterior_file.hpp
///   posterior_predictive  one variable a response (chain, draw, sample), noise of `seed` added;
///   its
///                         draws are those of `predictive`, numbered in draw_index
///   observed_data         one variable a response (sample) [SI], and time [s]
/// A name's characters that NetCDF forbids become "_". Throws io::FileError.
void write_sid_posterior_file(const std::filesystem::path& path, const SidProblem& problem,
                              const inference::Posterior& posterior,
                              const SidPredictive& predictive, std::uint64_t seed);

}  // namespace wheeltap::apps
