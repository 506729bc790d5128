// What a run of either command leaves behind: files, and where they are.
#pragma once

#include <filesystem>
#include <string>

#include "apps/commands.hpp"
#include "apps/summary.hpp"
#include "inference/reversible_jump.hpp"
#include "io/atomic_file.hpp"

namespace wheeltap::apps {

/// The engine's options that a command line states.
[[nodiscard]] inference::Options engine_options(const CommonOptions& common,
                                                const SamplingOptions& options);

/// posterior.nc, summary.json, summary.txt and report.html of one run. The names are reserved
/// first: a run that cannot be kept should not start. What is not kept is removed.
class RunFiles {
 public:
  /// Makes the folder. Throws io::FileError.
  explicit RunFiles(std::filesystem::path folder);

  /// Where to write the draws, before `keep`.
  [[nodiscard]] std::filesystem::path posterior() const { return posterior_.temporary(); }
  /// Writes the rest, and puts all in its place.
  void keep(const Report& summary, const std::string& text);

 private:
  std::filesystem::path folder_;
  io::AtomicFile posterior_, summary_;
};

/// Says where the results are, and whether they may be trusted.
void print_results(const std::filesystem::path& folder, bool converged);

}  // namespace wheeltap::apps
