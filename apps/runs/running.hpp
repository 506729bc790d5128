// What the commands that sample have in common: a log, an engine that can be interrupted, files.
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

/// Lines for people who watch, on standard error; warnings only where `quiet`.
[[nodiscard]] std::shared_ptr<spdlog::logger> make_log(bool quiet);

/// While it lives, Ctrl-C (or another of base::kStopSignals; SIGHUP unless it was ignored) asks the
/// engine to stop: the run ends with what there is. Another one, a second later or more, ends the
/// program; sooner it is the same wish, and so is SIGXCPU, which the system repeats. Once asked,
/// they stay caught.
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

/// From now on a reader of standard output who goes away does not end the program: what a run found
/// is written to files all the same.
void outlive_readers();

[[nodiscard]] bool was_interrupted();

/// Samples with a progress bar, until it is interrupted (StopOnInterrupt), keeping checkpoints, and
/// from the one that is there. Chains are cut to one length. Throws Failure where the likelihood
/// fails, or nothing was sampled.
[[nodiscard]] inference::Posterior run_engine(const inference::Problem& problem,
                                              inference::Options options,
                                              const std::filesystem::path& case_path, bool quiet,
                                              CheckpointFile& checkpoint);

/// Says on standard error, of a run that was stopped early, that --resume goes on with it.
void say_what_goes_on(const CheckpointFile& checkpoint, bool stopped);

/// "tmcmc+bridge" → both methods; none for "". Throws Failure (usage) for a method that is neither
/// tmcmc, bridge nor laplace.
[[nodiscard]] std::vector<identification::EvidenceMethod> evidence_methods(const std::string& text);

/// identification::compute_evidence, with a note of each method; those that an interruption leaves
/// unfinished are missing.
[[nodiscard]] std::vector<identification::MethodEvidence> compute_evidence(
    const inference::Problem& problem, const std::vector<identification::EvidenceMethod>& methods,
    std::uint64_t seed, int threads, RunWatch& watch);

/// The terminal's: a bar, a log, and checkpoints. From its first sample on, signals stop the run
/// (StopOnInterrupt).
class TerminalWatch : public RunWatch {
 public:
  /// Both must outlive it.
  TerminalWatch(const CommonOptions& common, spdlog::logger& log);
  /// Where to keep checkpoints: to be said before anything is sampled.
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

/// Throws io::FileError where it cannot be made.
void make_output_folder(const std::filesystem::path& directory);

/// The same, and holds it for this process until that ends: two runs that wrote into one folder
/// would mix their files. Throws io::FileError also where another run has it.
void claim_output_folder(const std::filesystem::path& directory);

/// The whole file at once. Throws io::FileError.
void write_text(const std::filesystem::path& path, const std::string& text);

/// What `simulate --json` prints: {"file", "origin", KEY: count}, as JSON text.
[[nodiscard]] std::string written_data(const std::filesystem::path& path, const std::string& origin,
                                       std::size_t count, const std::string& key);

}  // namespace wheeltap::apps
