#include "apps/commands/batch_command.hpp"

#include <poll.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <functional>
#include <iostream>
#include <mutex>
#include <type_traits>

#include "apps/cases/syntax/case_file.hpp"
#include "apps/commands/command_list.hpp"
#include "apps/commands/command_options.hpp"
#include "apps/failure.hpp"
#include "apps/remote/child_program.hpp"
#include "apps/runs/batch/batch_folders.hpp"
#include "apps/runs/batch/batch_table.hpp"
#include "apps/runs/case_run.hpp"
#include "apps/runs/failure_of.hpp"
#include "apps/runs/run_cost.hpp"
#include "apps/runs/running.hpp"
#include "apps/runs/several_ranks.hpp"
#include "base/parallel.hpp"
#include "base/parcel.hpp"
#include "io/atomic_file.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {
namespace {

using Clock = std::chrono::steady_clock;

/// The command that runs a case of this kind. Throws Failure if there is no such command.
const Command& command_of(const CaseFile& file) {
  if (const Command* command = command_of_kind(file)) return *command;
  file.refuse(Pointer("/kind"), "a batch runs cases of the kinds " + listed(case_kinds()));
}

// A path that begins with a dash must not be parsed as an option.
std::string as_argument(const std::filesystem::path& path) {
  const std::string text = path.string();
  return text.starts_with('-') ? "./" + text : text;
}

std::vector<std::string> arguments(const Command& command, const std::filesystem::path& path,
                                   const std::filesystem::path& folder, const CommonOptions& common,
                                   const SamplingOptions& sampling) {
  std::vector<std::string> out{command.name, as_argument(path), "--output=" + folder.string(),
                               "--quiet"};
  const auto add = [&](const char* option, auto value) {
    out.insert(out.end(), {option, std::to_string(value)});
  };
  const auto precise = [&](const char* option, double value) {
    out.insert(out.end(), {option, Json(value).dump()});
  };
  for (const std::string& override : common.overrides) out.push_back("--set=" + override);
  if (!command.make_run) return out;  // such a command has no runs to resume
  add("--chains", sampling.chains);
  if (common.seed) add("--seed", *common.seed);
  if (sampling.warmup > 0) add("--warmup", sampling.warmup);
  if (sampling.draws > 0) add("--draws", sampling.draws);
  if (sampling.searches > 0) add("--search", sampling.searches);
  precise("--checkpoint", common.checkpoint_seconds);
  precise("--max-memory", common.max_memory_gb);
  precise("--max-hours", common.max_hours);
  if (common.max_disk_gb) precise("--max-disk", *common.max_disk_gb);
  if (common.allow_commands) out.emplace_back("--allow-commands");
  for (const std::string& host : common.allow_hosts) out.push_back("--allow-hosts=" + host);
  if (sampling.prior_only) out.emplace_back("--prior-only");
  if (sampling.quick) out.emplace_back("--quick");
  if (!sampling.evidence.empty()) out.push_back("--evidence=" + sampling.evidence);
  if (common.resume) out.emplace_back("--resume");
  return out;
}

/// Prints the estimated cost of each case, one line per case, and of all cases together.
void estimate_batch(const std::vector<BatchCase>& cases, const CommonOptions& common,
                    const SamplingOptions& sampling) {
  const int threads = base::thread_count(common.threads);
  const int at_a_time = std::min<int>(threads, static_cast<int>(cases.size()));
  std::vector<double> bytes;
  RunCost all;
  std::optional<Failure> first;
  std::size_t refused = 0;
  for (const BatchCase& one : cases) {
    CommonOptions alone = common;
    alone.case_path = one.path;
    alone.quiet = true;
    alone.threads = std::max(1, threads / at_a_time);
    alone.dry_run = [&](const std::string& what, const RunCost& cost) {
      std::cout << io::printable(one.name) << ": the " << what << " would take " << in_words(cost)
                << "\n";
      bytes.push_back(cost.bytes);
      all.likelihoods += cost.likelihoods;
      all.seconds += cost.seconds / at_a_time;
    };
    try {
      const Command& command = command_of(read_case(one.path, common.overrides));
      command.run({.common = alone, .sampling = sampling});
    } catch (...) {
      const Failure failure = failure_of(std::current_exception(), one.path);
      std::cout << io::printable(one.name) << ": refused (exit code "
                << static_cast<int>(failure.exit()) << "): " << failure.what() << "\n";
      if (!first) first.emplace(failure);
      ++refused;
    }
  }
  std::ranges::sort(bytes, std::greater{});
  bytes.resize(std::min(bytes.size(), static_cast<std::size_t>(at_a_time)));
  for (const double b : bytes) all.bytes += b;
  if (common.as_json) common.as_json(estimate_json("batch", all));
  std::cout << "All " << cases.size() << ", " << at_a_time << " at a time: " << in_words(all)
            << "\n";
  if (first)
    throw Failure(first->exit(), std::to_string(refused) + " of " + std::to_string(cases.size()) +
                                     " cases would be rejected");
}

/// Runs each case in a separate process, on one or more threads of one of the ranks.
class Batch {
 public:
  Batch(std::vector<BatchCase> cases, const CommonOptions& common, const SamplingOptions& sampling)
      : cases_(std::move(cases)), common_(common), sampling_(sampling), rows_(cases_.size()) {
    if (base::ranks() != nullptr) section_ = kCasesAThread * base::ranks()->size() * threads_;
  }

  /// Other ranks send their rows at the end of each section. Finally writes the table to the disk.
  void run() {
    for (int first = 0; first < all() && !stopped_; first += section_) {
      const int n = std::min(section_, all() - first);
      free_ = threads_;
      base::parallel_for(
          n, threads_, [&](int i) { run_case(first + i, n - i); },
          base::carriage([&](int i, auto& parcel) {
            std::optional<BatchRow>& row = rows_[static_cast<std::size_t>(first + i)];
            bool there = row.has_value();
            parcel(there);
            if (!there) return;
            if (!row) row.emplace();
            parcel(*row);
            if constexpr (std::is_same_v<std::remove_reference_t<decltype(parcel)>, base::Unpacker>)
              report(first + i);
          }));
      stopped_ = was_interrupted();
    }
    if (done_ % rows_per_write_ != 0 && base::is_first_rank()) keep_table();
  }

  [[nodiscard]] const std::vector<std::optional<BatchRow>>& rows() const { return rows_; }
  [[nodiscard]] std::size_t done() const { return done_; }

 private:
  static constexpr int kCasesAThread = 8;

  [[nodiscard]] int all() const { return static_cast<int>(cases_.size()); }
  [[nodiscard]] std::filesystem::path folder(int at) const {
    return common_.output / cases_[static_cast<std::size_t>(at)].name;
  }

  // One thread per case while enough cases are `waiting`; the last cases share free threads.
  void run_case(int at, int waiting) {
    if (was_interrupted()) return;
    int threads = 0;
    {
      const std::scoped_lock lock(mutex_);
      threads = std::max(1, free_ / std::min(std::max(free_, 1), waiting));
      free_ -= threads;
    }
    const auto& one = cases_[static_cast<std::size_t>(at)];
    BatchRow row{.name = one.name, .path = one.place};
    bool ended = true;
    try {
      const CaseFile file = read_case(one.path, common_.overrides);
      const Command& command = command_of(file);
      row.kind = file.json["kind"].get<std::string>();
      ended = run_program(arguments(command, one.path, folder(at), common_, sampling_), threads, at,
                          row);
    } catch (const Failure& failure) {
      row.exit = static_cast<int>(failure.exit());
      row.error = failure.what();
    }
    const std::scoped_lock lock(mutex_);
    free_ += threads;
    if (!ended) return;  // a later --resume continues this run
    rows_[static_cast<std::size_t>(at)] = std::move(row);
    report(at);
  }

  /// Runs the program and waits until it ends. Returns false if a stop of the batch also stopped
  /// the program.
  bool run_program(const std::vector<std::string>& words, int threads, int at,
                   BatchRow& row) const {
    constexpr int kMilliseconds = 200;
    const auto began = Clock::now();
    // An environment variable sets the number of threads, so that the command in the results omits
    // it.
    ChildProgram program(words, {std::string(kThreadsVariable) + "=" + std::to_string(threads)});
    std::optional<int> exit;
    for (bool terminated = false; !exit; exit = program.ended()) {
      pollfd descriptor{.fd = program.descriptor(), .events = POLLIN, .revents = 0};
      poll(&descriptor, 1, kMilliseconds);
      if (!terminated && was_interrupted()) {
        program.send(SIGTERM);
        terminated = true;
      }
    }
    const bool stopped =
        *exit == static_cast<int>(Exit::interrupted) || (*exit == 0 && stopped_early(folder(at)));
    if (stopped && was_interrupted()) return false;
    row.exit = stopped ? static_cast<int>(Exit::interrupted) : *exit;
    row.seconds = std::chrono::duration<double>(Clock::now() - began).count();
    if (row.exit == 0) {
      take_from_summary(folder(at), row);
    } else {
      row.error = program.last_line();
      if (row.error.empty()) row.error = "ended without an error message";
      if (*exit > 128 && !stopped) row.error = "ended by signal " + std::to_string(*exit - 128);
    }
    return true;
  }

  void report(int at) {
    ++done_;
    if (!base::is_first_rank()) return;
    std::cout << batch_line(*rows_[static_cast<std::size_t>(at)], done_, cases_.size())
              << std::endl;
    if (done_ % rows_per_write_ == 0) keep_table();
  }

  void keep_table() const { write_text(common_.output / kBatchTable, batch_csv(rows_)); }

  std::vector<BatchCase> cases_;
  const CommonOptions& common_;
  const SamplingOptions& sampling_;
  std::vector<std::optional<BatchRow>> rows_;
  int threads_ = base::thread_count(common_.threads);  // threads of this rank
  int section_ = all();                                // cases per section
  // With 100 000 cases, rewriting the table after each case would write 500 GB.
  std::size_t rows_per_write_ = 1 + cases_.size() / 10'000;
  std::mutex mutex_;  // guards the members below, and rows_
  int free_ = 0;      // free threads
  std::size_t done_ = 0;
  bool stopped_ = false;
};

}  // namespace

void run_batch(const CommonOptions& common, const SamplingOptions& sampling) {
  static_cast<void>(evidence_methods(sampling.evidence));  // an error before the first run
  std::vector<BatchCase> cases = read_batch_list(common.case_path);
  BatchFolders folders(common.output, common.resume);
  for (BatchCase& one : cases) folders.give(one);
  std::string names;
  for (const BatchCase& one : cases) names += one.name + '\n';
  if (common.dry_run) return estimate_batch(cases, common, sampling);
  require_same_on_all_ranks("list", names);
  outlive_readers();
  on_first_rank([&] {
    claim_output_folder(common.output);
    const io::AtomicFile writable(common.output / kBatchTable);
    folders.keep();
  });
  const StopOnInterrupt stop;
  Batch batch(std::move(cases), common, sampling);
  batch.run();
  if (!base::is_first_rank()) return;
  const auto& rows = batch.rows();
  const std::string all = std::to_string(rows.size());
  if (batch.done() < rows.size()) {
    throw Failure(Exit::interrupted,
                  "stopped after " + std::to_string(batch.done()) + " of " + all +
                      " cases; the same command with --resume continues the batch");
  }
  if (common.as_json) common.as_json(batch_json(rows));
  std::cout << "Results: " << io::printable((common.output / kBatchTable).string())
            << " (the table), and one folder per case\n";
  const auto failed = [](const std::optional<BatchRow>& row) { return row->exit != 0; };
  const auto first = std::ranges::find_if(rows, failed);
  if (first == rows.end()) return;
  throw Failure(static_cast<Exit>((*first)->exit),
                std::to_string(std::ranges::count_if(rows, failed)) + " of " + all +
                    " cases failed, the first of them " + (*first)->name + " (exit code " +
                    std::to_string((*first)->exit) + "); --resume runs the failed cases again");
}

Command batch_command() {
  return {.name = "batch",
          .summary = "run many cases of any kind, with one table of results",
          .on_all_ranks = true,
          .add_options =
              [](CommandOptions& options) {
                CommonOptions& common = options.invocation().common;
                options.app()
                    .add_option("LIST", common.case_path,
                                "text file with one path of a case per line; # begins a comment")
                    ->required();
                options.app()
                    .add_option(
                        "--set", common.overrides,
                        "key and new value of an entry of every case, as path.to.key=VALUE; "
                        "may be repeated")
                    ->take_all()
                    ->allow_extra_args(false);
                options.add_output("FOLDER",
                                   "folder of the results: batch.csv and one folder per case");
                options.add_json("print the table as JSON");
                options.add_seed(
                    "seed of the random numbers of the Markov chains of every run (default 1)");
                options.add_threads();
                options.add_sampling();
                options.add_permissions();
                options.add_limits();
                options.add_dry_run();
                options.add_resume(
                    "keep finished runs, continue interrupted runs, start all other runs");
              },
          .run = [](const Invocation& asked) { run_batch(asked.common, asked.sampling); }};
}

}  // namespace wheeltap::apps
