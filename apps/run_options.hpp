// Options that commands share.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace wheeltap::inference {
struct RunCost;  // run_cost.hpp
}

namespace wheeltap::apps {

using inference::RunCost;

/// Name of the environment variable that replaces --threads.
inline constexpr const char* kThreadsVariable = "WHEELTAP_THREADS";

/// Environment variable. If its value is "json" and standard error is not a terminal, progress is
/// printed as JSON Lines: {"stage", "fraction", "detail", "seconds_left" if known, "models" if
/// any}.
inline constexpr const char* kProgressVariable = "WHEELTAP_PROGRESS";

/// Options of every command that reads a case.
struct CommonOptions {
  std::filesystem::path case_path;
  std::filesystem::path output;
  std::vector<std::string> overrides;  ///< values of --set
  std::optional<std::uint64_t> seed;
  int threads = 0;  ///< number of threads; 0: one per processor of the machine
  bool quiet = false;
  bool resume = false;
  double checkpoint_seconds = 60.0;  ///< time between two checkpoints [s]; 0: no checkpoints
  /// Callback of --dry-run. If this callback is set, a command passes the estimated cost of its
  /// work ("run", "table") to the callback and ends without the work.
  std::function<void(const std::string& what, const RunCost& cost)> dry_run;
  double max_memory_gb = 4.0;  ///< limit of the estimated memory [GB]
  double max_hours = 100.0;
  /// Limit of the disk space; empty: free space of the results folder
  std::optional<double> max_disk_gb;
  bool allow_commands = false;                ///< true if cases may run programs
  std::vector<std::string> allow_hosts = {};  ///< other machines that cases may connect to
  std::string command_line;
  /// Callback of --json, which receives the output of the command as JSON text instead of standard
  /// output.
  std::function<void(const std::string& json)> as_json;
};

/// Options of every command that samples.
struct SamplingOptions {
  int chains = 4;
  int warmup = 0;    ///< number per chain; 0: chosen by the engine
  int draws = 0;     ///< number per chain; 0: chosen by the engine
  int searches = 0;  ///< local searches for posterior modes per model; 0: automatic
  bool prior_only = false;
  bool quick = false;    ///< quick run: posterior modes and short chains, marked in the results
  std::string evidence;  ///< evidence methods joined by +: tmcmc, bridge, laplace; may be empty
};

}  // namespace wheeltap::apps
