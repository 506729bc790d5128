// The commands of the program, one function each. All throw Failure (or io::FileError) where
// they cannot do their work.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace wheeltap::apps {

struct RunCost;  // run_cost.hpp

/// An environment variable that stands for --threads where that is not given.
inline constexpr const char* kThreadsVariable = "WHEELTAP_THREADS";

/// Options that commands share.
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

struct ModesOptions {
  std::optional<int> modes;  ///< rigid-body ones included
  bool truth = false;        ///< damaged as the case's truth says
  bool json = false;
  bool shapes = false;        ///< with json: add the shapes
  std::filesystem::path vtk;  ///< of a structure: draw it and its shapes into this file
};

struct TableOptions {
  std::string part;                          ///< "I/N": this part of the runs only
  std::vector<std::filesystem::path> merge;  ///< parts to join, whose runs are not repeated
};

struct SamplingOptions {
  int chains = 4;
  int warmup = 0;    ///< 0: chosen by the engine
  int draws = 0;     ///< 0: chosen by the engine
  int searches = 0;  ///< climbs to modes of each model; 0: chosen by the engine
  bool prior_only = false;
  bool quick = false;    ///< modes and short chains: a look, marked as such
  std::string evidence;  ///< "", or methods joined by +: tmcmc, bridge, laplace
};

void run_modes(const CommonOptions& common, const ModesOptions& options);
/// Runs the design of the case's predictor, measures the emulator on fresh runs, writes the table.
/// Finished runs are remembered beside the output until it is written; `resume` starts from them.
void run_table(const CommonOptions& common, const TableOptions& options);
/// Writes summary.json and posterior.nc into the output folder and prints what was found. With
/// `resume`, a folder that holds a finished run of the same case and options is printed again
/// instead.
void run_damage(const CommonOptions& common, const SamplingOptions& options);
/// Frequencies with noise from the case's truth: a CSV, or a complete case where the output ends in
/// .json.
void run_simulate(const CommonOptions& common);
/// Which model explains a record: writes summary.json and posterior.nc into the output folder and
/// prints what was found. A case with a sweep is run once a value, and sweep.csv takes the place of
/// posterior.nc.
void run_sid(const CommonOptions& common, const SamplingOptions& options);
void run_schema(const std::string& name);

}  // namespace wheeltap::apps
