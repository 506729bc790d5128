// Result files of a run.
#pragma once

#include <spdlog/logger.h>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "apps/results/summary.hpp"
#include "apps/run_options.hpp"
#include "inference/engine/reversible_jump.hpp"
#include "io/atomic_file.hpp"

namespace wheeltap::apps {

/// Returns the options of the engine for the options of a command line.
[[nodiscard]] inference::Options engine_options(const CommonOptions& common,
                                                const SamplingOptions& options);

/// Returns the sampling options as JSON. A summary stores this JSON, and `--resume` compares it
/// with the options of the new run.
[[nodiscard]] Report options_report(const SamplingOptions& options);

/// Writes posterior.nc. Throws io::FileError.
using WriteDraws = std::function<void(io::AtomicFile&)>;

/// posterior.nc, summary.json, summary.txt and report.html of one run. The constructor creates the
/// files and reserves disk space for the results. A run whose results cannot be stored therefore
/// does not start. The destructor removes unfinished files.
class RunFiles {
 public:
  /// Creates the folder. Throws io::FileError.
  explicit RunFiles(std::filesystem::path folder);

  /// Writes all four files as one transaction; the summary contains the run identifier and the
  /// checksum of posterior.nc. If the disk is full and the folder has no earlier run, the function
  /// writes all files except posterior.nc. If the folder has an earlier run, the function leaves
  /// the earlier files unchanged and writes summary.unkept.json. In both cases, the function
  /// returns the error with the list of written files. The caller then prints the text and throws
  /// the error.
  [[nodiscard]] std::optional<io::FileError> keep(Report summary, const std::string& text,
                                                  const std::string& run, const WriteDraws& draws);

 private:
  std::string keep_without_draws(Report& summary, const std::string& text,
                                 const std::string& reason);

  std::filesystem::path folder_;
  bool earlier_;  // true if the folder has an earlier run
  std::optional<io::AtomicFile> posterior_;
  io::AtomicFile summary_, text_, report_;
};

/// Prints the stored text of a finished run (finished_run).
void print_finished(const std::filesystem::path& folder, const std::string& text,
                    spdlog::logger& log);

/// Prints the paths of the results, and a warning if the run has not converged.
void print_results(const std::filesystem::path& folder, bool converged);

}  // namespace wheeltap::apps
