// Shared parts of the sampling commands: log, interruptible engine, output files.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/results/terminal.hpp"
#include "apps/run_options.hpp"
#include "apps/runs/run_watch.hpp"
#include "base/stop_signals.hpp"
#include "identification/findings/findings.hpp"
#include "inference/engine/reversible_jump.hpp"

namespace spdlog {
class logger;
}

namespace wheeltap::apps {

class CheckpointFile;

/// Returns a log on standard error. With `quiet`, the log shows only warnings.
[[nodiscard]] std::shared_ptr<spdlog::logger> make_log(bool quiet);

/// While an object of this class exists, Ctrl-C or another signal of base::kStopSignals stops the
/// engine, and the run ends with the draws so far. SIGHUP is ignored if it was ignored at the
/// start. A second signal after at least 1 s ends the program. A second signal within 1 s and
/// repeated SIGXCPU are ignored. The signal handlers remain installed after the first signal.
class StopOnInterrupt {
 public:
  StopOnInterrupt();
  StopOnInterrupt(const StopOnInterrupt&) = delete;
  StopOnInterrupt& operator=(const StopOnInterrupt&) = delete;
  ~StopOnInterrupt();

 private:
  using Handler = void (*)(int);
  std::array<Handler, base::kStopSignals.size()> before_{};
};

/// Ignores SIGPIPE. If the program that reads the standard output of Wheeltap ends, Wheeltap
/// continues and writes its files.
void outlive_readers();

[[nodiscard]] bool was_interrupted();

/// Runs the engine with a progress bar and checkpoints until the end or an interruption
/// (StopOnInterrupt). If a checkpoint was read, the engine resumes from it. The function truncates
/// all chains to the same length. Throws Failure if the likelihood fails or there are no draws.
[[nodiscard]] inference::Posterior run_engine(const inference::Problem& problem,
                                              inference::Options options,
                                              const std::filesystem::path& case_path, bool quiet,
                                              CheckpointFile& checkpoint);

/// If the run was stopped and has a checkpoint, prints that --resume continues the run.
void print_how_to_resume(const CheckpointFile& checkpoint, bool stopped);

/// Parses a list of evidence methods such as "tmcmc+bridge"; the result is empty for "". Throws
/// Failure (usage) for a method other than tmcmc, bridge and laplace.
[[nodiscard]] std::vector<identification::EvidenceMethod> evidence_methods(const std::string& text);

/// Prints a note and calls identification::compute_evidence for each method. After an interruption,
/// the result contains only the finished methods.
[[nodiscard]] std::vector<identification::MethodEvidence> compute_evidence(
    const inference::Problem& problem, const std::vector<identification::EvidenceMethod>& methods,
    std::uint64_t seed, int threads, RunWatch& watch);

/// Observer for a terminal: progress bar, log and checkpoints. From the first sample() on, signals
/// stop the run (StopOnInterrupt).
class TerminalWatch : public RunWatch {
 public:
  /// `common` and `log` must outlive this object.
  TerminalWatch(const CommonOptions& common, spdlog::logger& log);
  /// Sets the checkpoint file; call this function before sample().
  void keep(CheckpointFile& checkpoint) { checkpoint_ = &checkpoint; }

  inference::Posterior sample(const inference::Problem& problem,
                              inference::Options options) override;
  void show(const char* stage, double fraction, const std::string& detail) override;
  void clear() override { bar_.clear(); }
  void note(const std::string& line) override;
  void warn(const std::string& line) override;
  [[nodiscard]] bool stopped() const override { return was_interrupted(); }
  void repeat(const identification::StepsRefined& refined) override;
  [[nodiscard]] std::optional<identification::StepsRefined> refined() const override;

 private:
  const CommonOptions& common_;
  spdlog::logger& log_;
  CheckpointFile* checkpoint_ = nullptr;
  ProgressBar bar_;
  std::optional<StopOnInterrupt> stop_;
};

/// Creates the folder. Throws io::FileError if this fails.
void make_output_folder(const std::filesystem::path& directory);

/// Creates the folder and locks it until this process ends, because two runs in one folder would
/// mix their files. Throws io::FileError if the folder cannot be created or if another run has
/// locked it.
void claim_output_folder(const std::filesystem::path& directory);

/// Writes a file atomically. Throws io::FileError.
void write_text(const std::filesystem::path& path, const std::string& text);

/// Returns the output of `simulate --json`: {"file", "origin", KEY: count}.
[[nodiscard]] std::string written_data(const std::filesystem::path& path, const std::string& origin,
                                       std::size_t count, const std::string& key);

}  // namespace wheeltap::apps
