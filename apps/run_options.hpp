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

/// Environment variable in place of --threads.
inline constexpr const char* kThreadsVariable = "WHEELTAP_THREADS";

/// Environment variable: with the value "json", progress on standard error is lines of JSON,
/// {"stage", "fraction", "detail", "seconds_left"}.
inline constexpr const char* kProgressVariable = "WHEELTAP_PROGRESS";

/// Options of every command that reads a case.
struct CommonOptions {
  std::filesystem::path case_path;
  std::filesystem::path output;
  std::vector<std::string> overrides;  ///< --set
  std::optional<std::uint64_t> seed;
  int threads = 0;  ///< 0: all threads of the machine
  bool quiet = false;
  bool resume = false;
  double checkpoint_seconds = 60.0;  ///< interval between checkpoints; 0: none
  /// If set, a command passes it the estimated cost of the work ("run", "table") and ends.
  std::function<void(const std::string& what, const RunCost& cost)> dry_run;
  double max_memory_gb = 4.0;  ///< larger estimates stop the command
  double max_hours = 100.0;
  std::optional<double> max_disk_gb;          ///< empty: free space of the results folder
  bool allow_commands = false;                ///< cases may run programs
  std::vector<std::string> allow_hosts = {};  ///< other machines that cases may connect to
  std::string command_line;
  /// Set with --json: receives the command's output as JSON text, in place of standard output.
  std::function<void(const std::string& json)> as_json;
};

/// Options of every command that samples.
struct SamplingOptions {
  int chains = 4;
  int warmup = 0;    ///< 0: chosen by the engine
  int draws = 0;     ///< 0: chosen by the engine
  int searches = 0;  ///< optimisations to find modes, per model; 0: chosen by the engine
  bool prior_only = false;
  bool quick = false;    ///< quick run: modes and short chains, marked in the results
  std::string evidence;  ///< "", or methods joined by +: tmcmc, bridge, laplace
};

}  // namespace wheeltap::apps
