// Runs that the application starts: a queue of child processes of this program.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "apps/remote/child_program.hpp"
#include "apps/report_json.hpp"

namespace wheeltap::apps {

/// A run of a case.
struct RunRequest {
  std::string command;  ///< damage, sid, …
  std::string case_name, output_name;
  std::filesystem::path case_path, output;
  std::optional<std::uint64_t> seed = {};
  bool samples = false;  ///< true if the command has checkpoints, --quick and --resume
  bool quick = false;
  bool resume = false;
};

class RunQueue {
 public:
  /// A queue that runs at most `at_once` cases at a time, each with `threads` threads.
  RunQueue(int at_once, int threads);
  RunQueue(const RunQueue&) = delete;
  RunQueue& operator=(const RunQueue&) = delete;
  /// Stops all runs; each run writes its results so far. Kills runs that do not end within 10 s.
  ~RunQueue();

  /// Returns the identification number of the run; empty if the queue is full, or if a run with the
  /// same output folder is waiting or running.
  [[nodiscard]] std::optional<int> add(RunRequest request);
  /// Removes a waiting run; a running run ends early and writes its results so far. Returns false
  /// if no waiting or running run has this identification number.
  bool stop(int number);
  /// Returns [{number, command, case, output, state, stage, stages, fraction, seconds_left, detail,
  /// message, exit, seconds, trace}, …]. A state is queued, running, stopping, done, stopped or
  /// failed. `stages` is [{name, begin}, …], with times since the start of the run [s]. `trace` has
  /// the model probabilities from the draws up to each time: {seconds: […], models: [{name,
  /// probability: […]}, …]}. Runs that have ended have no trace.
  [[nodiscard]] Report list() const;
  /// True if a run with this output folder is waiting or running.
  [[nodiscard]] bool is_busy(const std::filesystem::path& output) const;

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr double kTraceStep = 0.1;
  struct Stage {
    std::string name;
    double begin;  ///< [s] since the start of the run
  };
  struct Point {
    double seconds;
    std::map<std::string, double> probabilities;
  };
  struct Run {
    int number = 0;
    RunRequest request = {};
    std::string state = "queued";
    std::string stage = {}, detail = {}, message = {};
    double fraction = 0.0;
    std::optional<double> seconds_left = {};
    std::optional<int> exit = {};
    std::optional<Clock::time_point> begun = {}, ended = {};
    std::unique_ptr<ChildProgram> program = {};
    std::string unread = {};  ///< incomplete last line of the output
    std::vector<Stage> stages = {};
    std::vector<Point> trace = {};
    double trace_step = kTraceStep;  ///< smallest time between two points of the trace [s]
  };

  void watch(const std::stop_token& done);
  void step();
  void start(Run& run) const;
  /// Elapsed time of the run [s].
  [[nodiscard]] static double seconds_of(const Run& run);
  static void note_models(Run& run, const nlohmann::json& models);
  [[nodiscard]] static Report trace_of(const Run& run);
  static void read(Run& run, const std::string& output);
  [[nodiscard]] int running() const;
  [[nodiscard]] bool busy(const std::filesystem::path& output) const;

  int at_once_, threads_;
  int next_ = 1;
  mutable std::mutex mutex_;
  std::deque<Run> runs_;
  std::jthread thread_;
};

}  // namespace wheeltap::apps
