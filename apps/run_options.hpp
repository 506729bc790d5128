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

/// An environment variable that stands for --threads where that is not given.
inline constexpr const char* kThreadsVariable = "WHEELTAP_THREADS";

/// Of every command that reads a case.
struct CommonOptions {
  std::filesystem::path case_path;
  std::filesystem::path output;
  std::vector<std::string> overrides;  ///< --set
  std::optional<std::uint64_t> seed;
  int threads = 0;  ///< 0: as many as the machine has
  bool quiet = false;
  bool resume = false;
  double checkpoint_seconds = 60.0;  ///< between two of a run; 0: none
  /// Where it is set, a command tells it what it would take ("run", "table"), and ends.
  std::function<void(const std::string& what, const RunCost& cost)> dry_run;
  double max_memory_gb = 4.0;  ///< estimates beyond these are refused
  double max_hours = 100.0;
  std::optional<double> max_disk_gb;          ///< none: what is free in the folder of the results
  bool allow_commands = false;                ///< cases may run programs
  std::vector<std::string> allow_hosts = {};  ///< other machines that cases may reach
  std::string command_line;
  /// Set with --json: takes what the command prints, as JSON text, in place of standard output.
  std::function<void(const std::string& json)> as_json;
};

/// Of every command that samples.
struct SamplingOptions {
  int chains = 4;
  int warmup = 0;    ///< 0: chosen by the engine
  int draws = 0;     ///< 0: chosen by the engine
  int searches = 0;  ///< climbs to modes of each model; 0: chosen by the engine
  bool prior_only = false;
  bool quick = false;    ///< modes and short chains: a look, marked as such
  std::string evidence;  ///< "", or methods joined by +: tmcmc, bridge, laplace
};

}  // namespace wheeltap::apps
