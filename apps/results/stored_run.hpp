// What a folder holds of a run, and whether its files are of one another.
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

/// Names a run by what it drew: the same for the same case, seed and options, whatever machine and
/// day. posterior.nc has it as the attribute `run_id`, summary.json under /wheeltap/run.
[[nodiscard]] std::string run_id(const Report& about, const inference::Posterior& posterior);

/// {"bytes", "checksum"} of a file, as summary.json keeps it under /files; the checksum is
/// io::fingerprint.
[[nodiscard]] Report seal(std::string_view bytes);
/// The same of a file of any length.
[[nodiscard]] Report seal_of_file(const std::filesystem::path& file);

/// What a posterior.nc should be, for messages.
inline constexpr const char* kPosterior = "a posterior of wheeltap";

/// Opens a posterior.nc, which messages call `name`; a long one is read where it is, as it is asked
/// for. Throws io::FileError: missing, corrupt.
[[nodiscard]] std::unique_ptr<const io::NetcdfReader> read_posterior(
    const std::filesystem::path& file, const std::filesystem::path& name);

/// summary.json of a folder; none where there is none, or none that can be read.
[[nodiscard]] std::optional<Report> stored_summary(const std::filesystem::path& folder);

/// Whether the run in `folder` has such a file: not where its summary says that it could not be
/// written. Throws io::FileError where it is not what the run wrote: missing; corrupt where it is
/// truncated or damaged; mismatch where it is of another run. Runs of before seals are taken as
/// they are.
[[nodiscard]] bool is_sealed(const std::filesystem::path& folder, const std::string& name,
                             const Report& summary);
/// Its bytes; none where it has none. Throws as `is_sealed` does.
[[nodiscard]] std::optional<std::string> sealed_file(const std::filesystem::path& folder,
                                                     const std::string& name,
                                                     const Report& summary);

/// The text that the finished run in `folder` printed, if it is one of this case, of the same
/// content of the files that it reads, of this seed and these options (as /wheeltap/KEY has them),
/// and all its draws are there. Throws io::FileError where a file is
/// not what the run wrote.
[[nodiscard]] std::optional<std::string> finished_run(const std::filesystem::path& folder,
                                                      const CaseFile& file, std::uint64_t seed,
                                                      const std::string& key,
                                                      const Report& options);

}  // namespace wheeltap::apps
