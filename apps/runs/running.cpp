#include "apps/runs/running.hpp"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <ctime>
#include <iostream>
#include <map>
#include <optional>
#include <span>
#include <sstream>

#include "apps/failure.hpp"
#include "apps/results/terminal.hpp"
#include "apps/runs/checkpoint_file.hpp"
#include "apps/runs/several_ranks.hpp"
#include "apps/runs/time_left.hpp"
#include "base/parallel.hpp"
#include "inference/model/likelihood_probe.hpp"
#include "io/atomic_file.hpp"
#include "io/file_lock.hpp"
#include "io/fingerprint.hpp"

namespace wheeltap::apps {
namespace {

std::atomic<std::int64_t> asked_to_stop_at{0};  // [ns] of a monotonic clock; 0: not yet
static_assert(std::atomic<std::int64_t>::is_always_lock_free);

bool interrupted() {
  return asked_to_stop_at.load() != 0;
}

constexpr double kBriefProbe = 0.05;  // seconds

constexpr const char* kHowToResume = "; the same command with --resume continues the run";

// One request may arrive as several signals, because `timeout` and schedulers signal the program
// and its process group. A signal at least 1 s later is a second request.
void ask_to_stop(int signal) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  const std::int64_t now = kSecond * time.tv_sec + time.tv_nsec;
  std::int64_t first = 0;
  if (!asked_to_stop_at.compare_exchange_strong(first, now) && now - first > kSecond &&
      signal != SIGXCPU)
    std::_Exit(128 + signal);
}

std::string fingerprint_of(const inference::Posterior& posterior) {
  std::string text;
  for (const auto& chain : posterior.chains) {
    const auto bytes = std::as_bytes(std::span(chain.log_likelihood));
    text += io::fingerprint({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  }
  return text;
}

// Truncates chains that were stopped early, because they may differ in length.
void cut_to_shortest(inference::Posterior& posterior) {
  std::size_t n = posterior.chains.empty() ? 0 : posterior.chains[0].size();
  for (const auto& chain : posterior.chains) n = std::min(n, chain.size());
  for (auto& chain : posterior.chains) chain.truncate(n);
  posterior.draws = static_cast<int>(n);
}

}  // namespace

std::shared_ptr<spdlog::logger> make_log(bool quiet) {
  auto log = std::make_shared<spdlog::logger>("wheeltap",
                                              std::make_shared<spdlog::sinks::stderr_sink_st>());
  log->set_pattern("%v");
  log->set_level(quiet ? spdlog::level::warn : spdlog::level::info);
  return log;
}

void print_how_to_resume(const CheckpointFile& checkpoint, bool stopped) {
  if (stopped && checkpoint.kept()) std::cerr << "wheeltap: stopped" << kHowToResume << '\n';
}

bool was_interrupted() {
  return base::is_to_stop(interrupted());
}

StopOnInterrupt::StopOnInterrupt() {
  if (base::ranks()) base::ranks()->on_wish_to_stop(interrupted);
  for (std::size_t i = 0; i < before_.size(); ++i) {
    const int signal = base::kStopSignals[i];
    before_[i] = std::signal(signal, ask_to_stop);
    if (signal == SIGHUP && before_[i] == SIG_IGN) std::signal(SIGHUP, SIG_IGN);  // nohup
  }
}

StopOnInterrupt::~StopOnInterrupt() {
  if (interrupted()) return;  // a repeated signal must not end a write
  for (std::size_t i = 0; i < before_.size(); ++i) std::signal(base::kStopSignals[i], before_[i]);
}

void outlive_readers() {
  std::signal(SIGPIPE, SIG_IGN);
}

inference::Posterior run_engine(const inference::Problem& problem, inference::Options options,
                                const std::filesystem::path& case_path, bool quiet,
                                CheckpointFile& checkpoint) {
  checkpoint.attach(options);
  options.draws_folder = checkpoint.path().parent_path();
  if (options.draws_folder.empty()) options.draws_folder = ".";
  ProgressBar bar(quiet);
  // The searches on a record use its first samples; all later stages use the whole record.
  TimeLeft time_left(problem.shortened
                         ? inference::probe(problem, kBriefProbe).middle /
                               std::min(base::thread_count(options.threads), options.chains)
                         : 0.0);
  const auto began = std::chrono::steady_clock::now();
  std::vector<std::string> names;
  for (const auto& model : problem.space.models()) names.push_back(model.name);
  options.progress = [&](const inference::Options::Progress& progress) {
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    // Number of likelihoods per second in the run so far.
    std::string detail =
        seconds > 1.0
            ? rounded_count(static_cast<double>(progress.likelihood_evaluations) / seconds) + "/s"
            : std::string();
    const auto models = models_so_far(progress.model_probabilities, names);
    const std::string so_far = probabilities_so_far(models);
    if (!detail.empty() && !so_far.empty()) detail += "  ";
    detail += so_far;
    const TimeLeft::Shown shown = time_left.of_run(progress, seconds);
    bar.show(progress.stage, shown.fraction, detail, shown.left, models);
    return !interrupted();
  };
  options.stop = interrupted;
  try {
    inference::Posterior posterior = inference::reversible_jump(problem, options);
    bar.clear();
    cut_to_shortest(posterior);
    require_same_on_all_ranks("draws", fingerprint_of(posterior));
    if (posterior.draws < 100) {
      throw Failure(Exit::interrupted, "stopped before the first results: nothing to report" +
                                           std::string(checkpoint.kept() ? kHowToResume : ""));
    }
    return posterior;
  } catch (const inference::CheckpointError& error) {
    bar.clear();
    throw Failure(Exit::bad_input, checkpoint.path().string() + ": " + error.what());
  } catch (const inference::DrawsLost& lost) {
    bar.clear();
    throw io::FileError(io::FileError::Kind::unwritable, options.draws_folder,
                        std::string("the draws stored in this folder are lost: ") + lost.what() +
                            (checkpoint.kept() ? kHowToResume : ""));
  } catch (const inference::LikelihoodError& error) {
    bar.clear();
    throw Failure(Exit::bad_input, case_path.string() + ": " + error.what());
  }
}

std::vector<identification::EvidenceMethod> evidence_methods(const std::string& text) {
  using identification::EvidenceMethod;
  std::vector<EvidenceMethod> methods;
  std::istringstream stream(text);
  for (std::string word; std::getline(stream, word, '+');) {
    bool known = false;
    for (const auto method :
         {EvidenceMethod::tmcmc, EvidenceMethod::bridge, EvidenceMethod::laplace}) {
      if (identification::method_name(method) != word) continue;
      methods.push_back(method);
      known = true;
    }
    if (!known) {
      throw Failure(Exit::usage, "--evidence=" + text + ": methods are tmcmc, bridge and laplace");
    }
  }
  return methods;
}

std::vector<identification::MethodEvidence> compute_evidence(
    const inference::Problem& problem, const std::vector<identification::EvidenceMethod>& methods,
    std::uint64_t seed, int threads, RunWatch& watch) {
  for (const auto method : methods) {
    watch.note("Evidence of each model by " + identification::method_name(method) + " ...");
  }
  return identification::compute_evidence(problem, methods, seed, threads,
                                          [&] { return watch.stopped(); });
}

TerminalWatch::TerminalWatch(const CommonOptions& common, spdlog::logger& log)
    : common_(common), log_(log), bar_(common.quiet) {}

inference::Posterior TerminalWatch::sample(const inference::Problem& problem,
                                           inference::Options options) {
  if (checkpoint_ == nullptr) throw std::logic_error("TerminalWatch: sample() before keep()");
  if (!stop_) stop_.emplace();
  return run_engine(problem, std::move(options), common_.case_path, common_.quiet, *checkpoint_);
}

void TerminalWatch::show(const char* stage, double fraction, const std::string& detail) {
  bar_.show(stage, fraction, detail);
}

void TerminalWatch::note(const std::string& line) {
  log_.info(line);
}

void TerminalWatch::warn(const std::string& line) {
  log_.warn(line);
}

void TerminalWatch::repeat(const identification::StepsRefined& refined) {
  checkpoint_->repeat(refined);
}

std::optional<identification::StepsRefined> TerminalWatch::refined() const {
  return checkpoint_->refined();
}

void make_output_folder(const std::filesystem::path& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error || !std::filesystem::is_directory(directory)) {
    throw io::FileError(io::FileError::Kind::unwritable, directory,
                        error ? error.message() : "is not a folder");
  }
}

void claim_output_folder(const std::filesystem::path& directory) {
  static std::map<std::filesystem::path, io::FileLock> claimed;
  make_output_folder(directory);
  const std::filesystem::path whole = std::filesystem::canonical(directory);
  if (claimed.contains(whole)) return;
  constexpr std::chrono::seconds kToEnd{2};  // time for a killed run and its ranks to end
  std::optional<io::FileLock> lock = io::FileLock::take(whole, kToEnd);
  if (!lock)
    throw io::FileError(io::FileError::Kind::unwritable, directory,
                        "another run is writing into this folder: wait for the end of that run, or "
                        "choose another folder");
  claimed.emplace(whole, std::move(*lock));
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  io::AtomicFile file(path);
  file.write(text);
  file.commit();
}

std::string written_data(const std::filesystem::path& path, const std::string& origin,
                         std::size_t count, const std::string& key) {
  return Report({{"file", path.string()}, {"origin", origin}, {key, count}}).dump();
}

}  // namespace wheeltap::apps
