// Stored runs: the files of a results folder, and checks that they belong to one run.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "apps/results/summary.hpp"
#include "inference/diagnosis/posterior.hpp"

namespace wheeltap::io {
class NetcdfReader;
}

namespace wheeltap::apps {

/// Returns an identifier of a run, computed from its draws. The identifier is the same for the same
/// case, seed and options on every machine. posterior.nc has it as the attribute `run_id`,
/// summary.json as /wheeltap/run.
[[nodiscard]] std::string run_id(const Report& about, const inference::Posterior& posterior);

/// Returns {"bytes", "checksum"} of a file, as in /files of summary.json. The checksum is
/// io::fingerprint.
[[nodiscard]] Report seal(std::string_view bytes);
/// Returns {"bytes", "checksum"} of a file of any length, which is read in blocks.
[[nodiscard]] Report seal_of_file(const std::filesystem::path& file);

/// The description of the file posterior.nc in messages.
inline constexpr const char* kPosterior = "a posterior of wheeltap";

/// Opens a posterior.nc. Messages use the name `name` for the file. A long file is read on demand.
/// Throws io::FileError: missing, corrupt.
[[nodiscard]] std::unique_ptr<const io::NetcdfReader> read_posterior(
    const std::filesystem::path& file, const std::filesystem::path& name);

/// Returns summary.json of a folder; empty if the file is missing or unreadable.
[[nodiscard]] std::optional<Report> stored_summary(const std::filesystem::path& folder);

/// Returns true if the run in `folder` has the file `name`, false if the summary states that the
/// file could not be written. Throws io::FileError if the file does not belong to the run: missing;
/// corrupt (truncated or invalid); mismatch (of another run). Runs of old program versions, which
/// stored no checksums, are not checked.
[[nodiscard]] bool is_sealed(const std::filesystem::path& folder, const std::string& name,
                             const Report& summary);
/// Returns the bytes of a file of a run; empty if the run has no such file. Throws the same
/// exceptions as `is_sealed`.
[[nodiscard]] std::optional<std::string> sealed_file(const std::filesystem::path& folder,
                                                     const std::string& name,
                                                     const Report& summary);

/// Returns the text of the finished run in `folder`. The result is empty if the run is incomplete.
/// The result is also empty if version, case, contents of input files, seed or options (in
/// /wheeltap/KEY) differ from those of the present run. Throws io::FileError if a file does not
/// belong to the run.
[[nodiscard]] std::optional<std::string> finished_run(const std::filesystem::path& folder,
                                                      const CaseFile& file, std::uint64_t seed,
                                                      const std::string& key,
                                                      const Report& options);

}  // namespace wheeltap::apps
