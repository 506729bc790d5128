// What a run of either command leaves behind: files, and where they are.
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

/// The engine's options that a command line states.
[[nodiscard]] inference::Options engine_options(const CommonOptions& common,
                                                const SamplingOptions& options);

/// The options as a summary repeats them, and `--resume` compares them.
[[nodiscard]] Report options_report(const SamplingOptions& options);

/// Writes posterior.nc. Throws io::FileError.
using WriteDraws = std::function<void(io::AtomicFile&)>;

/// posterior.nc, summary.json, summary.txt and report.html of one run. The names are reserved
/// first, and room for the numbers: a run that cannot be kept should not start. What is not kept is
/// removed.
class RunFiles {
 public:
  /// Makes the folder. Throws io::FileError.
  explicit RunFiles(std::filesystem::path folder);

  /// Puts all four in their places as if at once, the summary with the run's name and the seals of
  /// the others. Where that fails (a full disk): in a folder without a run, everything but the
  /// draws; in a folder that has one already, which stays as it is, summary.unkept.json. Returns
  /// then what failed and what was kept, for the caller to throw once it has printed the text.
  [[nodiscard]] std::optional<io::FileError> keep(Report summary, const std::string& text,
                                                  const std::string& run, const WriteDraws& draws);

 private:
  std::string keep_without_draws(Report& summary, const std::string& text,
                                 const std::string& reason);

  std::filesystem::path folder_;
  bool earlier_;  // there is a run in the folder
  std::optional<io::AtomicFile> posterior_;
  io::AtomicFile summary_, text_, report_;
};

/// Says again what a finished run said (finished_run).
void print_finished(const std::filesystem::path& folder, const std::string& text,
                    spdlog::logger& log);

/// Says where the results are, and whether they may be trusted.
void print_results(const std::filesystem::path& folder, bool converged);

}  // namespace wheeltap::apps
