// The estimate of a run in words, held against the limits that the command line sets.
#pragma once

#include <filesystem>
#include <string>

#include "apps/cases/syntax/case_file.hpp"
#include "apps/run_options.hpp"
#include "inference/engine/run_cost.hpp"

namespace wheeltap::apps {

/// "about 0.02 GB of memory, 120 000 likelihoods or FE runs of 0.3 ms each, 10 s".
[[nodiscard]] std::string in_words(const RunCost& cost);

/// Says so of a "run", a "table", on standard output: CommonOptions::dry_run of one case.
void print_estimate(const std::string& what, const RunCost& cost);

/// The same as JSON text: "what", "memory_bytes", "disk_bytes", "likelihoods", "seconds".
[[nodiscard]] std::string estimate_json(const std::string& what, const RunCost& cost);

/// Throws Failure (65) at `where` for what takes more than --max-memory, --max-hours or --max-disk
/// allow, with the estimate in words.
void require_affordable(const CaseFile& file, const Pointer& where, const RunCost& cost,
                        const CommonOptions& common);

/// Throws io::FileError (unwritable) where the folder of the results, which is there, has not so
/// much room, unless --max-disk says how much may be taken. What a checkpoint has is there already.
void require_room(const RunCost& cost, const CommonOptions& common);

/// Half a second where that is all that is asked for, else a tenth.
[[nodiscard]] inline double probe_seconds(const CommonOptions& common) {
  return common.dry_run ? 0.5 : 0.1;
}

/// Bytes of draws above which a run keeps them on the disk; infinity without a folder for them.
[[nodiscard]] double draws_in_memory(const CommonOptions& common);

/// The most that this process has held so far [bytes].
[[nodiscard]] double bytes_held();

/// Of a record that is simulated from the truth, from a case that its schema has passed; none
/// without a truth.
[[nodiscard]] RunCost cost_of_truth(const CaseFile& file);

}  // namespace wheeltap::apps
