// Checkpoint of a run in its results folder: written during the run, read by --resume.
#pragma once

#include <exception>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "apps/results/summary.hpp"
#include "apps/run_options.hpp"
#include "identification/sid/sid_run.hpp"
#include "inference/engine/checkpoint.hpp"
#include "inference/options.hpp"

namespace wheeltap::apps {

/// The identity of the run to which a checkpoint belongs.
struct CheckpointOf {
  std::string command;  ///< name of the command: "damage" or "sid"
  std::uint64_t seed = 1;
  Report options;  ///< options of the run (options_report)
  Json case_json;  ///< case with the overrides of the command line
  Json inputs;     ///< fingerprints of the input files (InputFiles::json)
};

/// FOLDER/checkpoint.nc: NetCDF-4 with a group "run" (version, command, seed, options, case,
/// fingerprints of its input files, time steps of a repeated sid run, checksums of the parts) and a
/// group "state" (inference::Checkpoint). The file ends with 16 hexadecimal digits, the fingerprint
/// of all previous bytes. If there are many draws, each file FOLDER/checkpoint-N.nc has a part of
/// the draws in the same format, without "run".
class CheckpointFile {
 public:
  static constexpr const char* kName = "checkpoint.nc";

  /// With `resume`, reads an existing checkpoint. Throws io::FileError: corrupt if the file is
  /// truncated or invalid, foreign if it is not a checkpoint, version if it has another format,
  /// mismatch (with the difference) if it belongs to another run. With `others_pass`, the
  /// checkpoint of another case is ignored. If an input file has changed, a line on standard error
  /// names it and a new run begins. Without `resume`, removes an existing checkpoint; throws
  /// io::FileError (unwritable) if the file is not a checkpoint.
  CheckpointFile(const std::filesystem::path& folder, CheckpointOf of, const CommonOptions& common,
                 bool others_pass = false);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Integration settings if the resumed run was stopped during a repetition with smaller time
  /// steps.
  [[nodiscard]] const std::optional<identification::StepsRefined>& refined() const {
    return refined_;
  }
  /// Stores the time steps with which the run is being repeated.
  void repeat(const identification::StepsRefined& refined) {
    refined_ = refined;
    if (!seals_.empty())
      first_ = seals_.rbegin()->first + 1;  // the last checkpoint still needs its parts
  }
  /// Sets the options of the engine so that it saves its checkpoints in this file. At the first
  /// call, the engine also resumes from the checkpoint that was read. If a checkpoint cannot be
  /// written, the run continues, and a line on standard error reports the fault.
  void attach(inference::Options& engine);
  /// True if a checkpoint of this run exists.
  [[nodiscard]] bool kept() const { return kept_; }
  /// Removes the checkpoint of a finished run.
  void remove();
  /// Removes checkpoints from the folder of a finished run that was killed before it removed its
  /// checkpoints.
  static void discard(const std::filesystem::path& folder);

 private:
  void read(std::string bytes, bool others_pass);
  void save(const inference::Checkpoint& checkpoint);
  bool save_draws(const inference::Checkpoint& draws, long number);
  [[nodiscard]] inference::Checkpoint saved_draws(long number) const;
  [[nodiscard]] std::filesystem::path part(long number) const;
  void warn(const std::exception& error);

  std::filesystem::path path_;
  CheckpointOf of_;
  double every_seconds_;
  std::shared_ptr<const inference::Checkpoint> from_;
  std::optional<identification::StepsRefined> refined_;
  std::map<long, std::string> seals_;  // checksums of the files of draws, by number
  long first_ = 0;                     // number of the file with the engine's part 0
  bool kept_ = false, warned_ = false;
};

}  // namespace wheeltap::apps
