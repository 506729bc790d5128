// Estimates of the memory, disk space and time of a run, and the limits set by the command line.
#pragma once

#include <filesystem>
#include <string>

#include "apps/cases/syntax/case_file.hpp"
#include "apps/run_options.hpp"
#include "inference/engine/run_cost.hpp"

namespace wheeltap::apps {

/// Returns the cost in words: "about 0.02 GB of memory, 120 000 likelihood evaluations or FE runs
/// of 0.3 ms each, 10 s".
[[nodiscard]] std::string in_words(const RunCost& cost);

/// Prints the estimated cost of a "run" or "table" on standard output. This function is
/// CommonOptions::dry_run for a single case.
void print_estimate(const std::string& what, const RunCost& cost);

/// Returns the estimate as JSON text: "what", "memory_bytes", "disk_bytes", "likelihoods",
/// "seconds".
[[nodiscard]] std::string estimate_json(const std::string& what, const RunCost& cost);

/// Throws Failure (65) at `where`, with the estimate, if the cost exceeds --max-memory, --max-hours
/// or --max-disk.
void require_affordable(const CaseFile& file, const Pointer& where, const RunCost& cost,
                        const CommonOptions& common);

/// Throws io::FileError (unwritable) if --max-disk is not given and the existing results folder has
/// too little free space. The space of existing checkpoint files counts as free.
void require_room(const RunCost& cost, const CommonOptions& common);

/// Returns for how many seconds Wheeltap measures the time of a likelihood evaluation: 0.5 s with
/// --dry-run, 0.1 s without.
[[nodiscard]] inline double probe_seconds(const CommonOptions& common) {
  return common.dry_run ? 0.5 : 0.1;
}

/// Returns the maximum size [bytes] of the draws in memory; a run stores further draws on disk.
/// If there is neither a results folder nor --dry-run, the size is infinite.
[[nodiscard]] double draws_in_memory(const CommonOptions& common);

/// Returns the peak memory of this process so far [bytes].
[[nodiscard]] double bytes_held();

/// Returns the cost of simulating a record from the truth of a valid case; zero without a truth.
[[nodiscard]] RunCost cost_of_truth(const CaseFile& file);

}  // namespace wheeltap::apps
