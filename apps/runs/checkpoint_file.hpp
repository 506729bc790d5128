// A run's checkpoint beside its results: written while it runs, taken up by --resume.
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

/// What a checkpoint is a checkpoint of: its draws are those of no other run.
struct CheckpointOf {
  std::string command;  ///< "damage" or "sid"
  std::uint64_t seed = 1;
  Report options;  ///< options_report
  Json case_json;  ///< with what the command line overrode
  Json inputs;     ///< the content of the files that the case reads, InputFiles::json
};

/// FOLDER/checkpoint.nc: NetCDF-4 with a group "run" (version, command, seed, options, case, the
/// content of its input files, what of it a sid run is repeating, and the seals of the parts), a
/// group "state" (inference::Checkpoint), and behind it 16 hexadecimal digits, the fingerprint of
/// all bytes before. Where there are many draws, FOLDER/checkpoint-N.nc has a part of them, in the
/// same way, without "run".
class CheckpointFile {
 public:
  static constexpr const char* kName = "checkpoint.nc";

  /// With `resume`, reads what is there: throws io::FileError for a file that is truncated or
  /// damaged (corrupt), none of ours (foreign), of another version of the format (version), or of
  /// another run (mismatch, the difference said; where `others_pass`, one of another case is passed
  /// over). One whose case reads files of another content now is passed over: a line on standard
  /// error says which file, and a new run begins. Without, removes it, unless it is none of ours
  /// (unwritable).
  CheckpointFile(const std::filesystem::path& folder, CheckpointOf of, const CommonOptions& common,
                 bool others_pass = false);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// How the run that is taken up was being repeated.
  [[nodiscard]] const std::optional<identification::StepsRefined>& refined() const {
    return refined_;
  }
  /// The run is repeated like this from here on.
  void repeat(const identification::StepsRefined& refined) {
    refined_ = refined;
    if (!seals_.empty()) first_ = seals_.rbegin()->first + 1;  // the last one's are needed yet
  }
  /// Makes the engine save here, and go on from what was read the first time. Where a checkpoint
  /// cannot be written, a line on standard error says so once and the run goes on.
  void attach(inference::Options& engine);
  /// A checkpoint of this run is there.
  [[nodiscard]] bool kept() const { return kept_; }
  /// The run is finished, and its results are kept.
  void remove();
  /// Of a folder whose run was finished already: removes what is ours, as a run killed just then
  /// could not.
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
  std::map<long, std::string> seals_;  // of the parts of the draws, by the numbers of their files
  long first_ = 0;                     // number of the file that has the engine's part 0
  bool kept_ = false, warned_ = false;
};

}  // namespace wheeltap::apps
