#include "apps/batch_command.hpp"

#include <poll.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <iostream>
#include <list>

#include "apps/batch_list.hpp"
#include "apps/batch_table.hpp"
#include "apps/case_file.hpp"
#include "apps/child_program.hpp"
#include "apps/failure.hpp"
#include "apps/running.hpp"
#include "base/parallel.hpp"
#include "io/atomic_file.hpp"
#include "io/text.hpp"

namespace wheeltap::apps {
namespace {

using Clock = std::chrono::steady_clock;

/// Which command runs a kind of case.
struct Runs {
  const char* kind;
  const char* command;
};
constexpr std::array kCommands{Runs{"damage", "damage"}, Runs{"sid", "sid"},
                               Runs{"update", "update"}, Runs{"modal", "modal"}};

std::string command_of(const CaseFile& file) {
  std::vector<std::string> known;
  for (const Runs& runs : kCommands) {
    if (file.json.is_object() && file.json.value("kind", Json()) == runs.kind) return runs.command;
    known.push_back(runs.kind);
  }
  file.refuse(Pointer("/kind"), "a batch runs cases of the kinds " + listed(known));
}

// A path that begins with a dash is no option.
std::string as_argument(const std::filesystem::path& path) {
  const std::string text = path.string();
  return text.starts_with('-') ? "./" + text : text;
}

std::vector<std::string> arguments(const std::string& command, const std::filesystem::path& path,
                                   const std::filesystem::path& folder, int threads,
                                   const CommonOptions& common, const SamplingOptions& sampling) {
  std::vector<std::string> out{command, as_argument(path), "--output=" + folder.string(),
                               "--quiet"};
  const auto add = [&](const char* option, auto value) {
    out.insert(out.end(), {option, std::to_string(value)});
  };
  const auto precise = [&](const char* option, double value) {
    out.insert(out.end(), {option, Json(value).dump()});
  };
  for (const std::string& override : common.overrides) out.push_back("--set=" + override);
  add("--threads", threads);
  if (command == "modal") return out;  // nothing is sampled, and nothing goes on
  add("--chains", sampling.chains);
  if (common.seed) add("--seed", *common.seed);
  if (sampling.warmup > 0) add("--warmup", sampling.warmup);
  if (sampling.draws > 0) add("--draws", sampling.draws);
  if (sampling.searches > 0) add("--search", sampling.searches);
  precise("--checkpoint", common.checkpoint_seconds);
  precise("--max-memory", common.max_memory_gb);
  precise("--max-hours", common.max_hours);
  if (common.allow_commands) out.emplace_back("--allow-commands");
  if (sampling.prior_only) out.emplace_back("--prior-only");
  if (sampling.quick) out.emplace_back("--quick");
  if (!sampling.evidence.empty()) out.push_back("--evidence=" + sampling.evidence);
  if (common.resume) out.emplace_back("--resume");
  return out;
}

/// The cases that run, those that wait, and what has come of the others.
class Batch {
 public:
  Batch(std::vector<BatchCase> cases, const CommonOptions& common, const SamplingOptions& sampling)
      : cases_(std::move(cases)),
        common_(common),
        sampling_(sampling),
        rows_(cases_.size()),
        free_(base::thread_count(common.threads)) {}

  void run() {
    while (true) {
      while (free_ > 0 && next_ < cases_.size() && !was_interrupted()) start(next_++);
      if (running_.empty()) break;
      wait();
    }
  }

  [[nodiscard]] const std::vector<std::optional<BatchRow>>& rows() const { return rows_; }
  [[nodiscard]] std::size_t done() const { return done_; }

 private:
  struct Running {
    std::size_t at;
    int threads;
    BatchRow row;
    Clock::time_point began;
    ChildProgram program;
  };

  [[nodiscard]] std::filesystem::path folder(std::size_t at) const {
    return common_.output / cases_[at].name;
  }

  // A case a thread while there are as many; what is left over goes to the last ones.
  void start(std::size_t at) {
    const int waiting = static_cast<int>(std::min<std::size_t>(cases_.size() - at, 1U << 20));
    const int threads = free_ / std::min(free_, waiting);
    BatchRow row{.name = cases_[at].name};
    try {
      const CaseFile file = read_case(cases_[at].path, common_.overrides);
      const std::string command = command_of(file);
      row.kind = file.json["kind"].get<std::string>();
      const auto words =
          arguments(command, cases_[at].path, folder(at), threads, common_, sampling_);
      running_.push_back({at, threads, row, Clock::now(), ChildProgram(words)});
      free_ -= threads;
    } catch (const Failure& failure) {
      row.exit = static_cast<int>(failure.exit());
      row.error = failure.what();
      keep(at, std::move(row));
    }
  }

  // Until one of them says something or ends, or a signal comes.
  void wait() {
    constexpr int kMilliseconds = 200;
    std::vector<pollfd> descriptors;
    for (const Running& one : running_) {
      descriptors.push_back({.fd = one.program.descriptor(), .events = POLLIN, .revents = 0});
    }
    poll(descriptors.data(), descriptors.size(), kMilliseconds);
    if (was_interrupted() && !told_) {
      for (const Running& one : running_) one.program.send(SIGTERM);
      told_ = true;
    }
    std::erase_if(running_, [&](Running& one) {
      const std::optional<int> exit = one.program.ended();
      if (exit) end(one, *exit);
      return exit.has_value();
    });
  }

  void end(Running& one, int exit) {
    free_ += one.threads;
    const bool stopped =
        exit == static_cast<int>(Exit::interrupted) || (exit == 0 && stopped_early(folder(one.at)));
    if (stopped && was_interrupted()) return;  // it goes on another time
    BatchRow row = std::move(one.row);
    row.exit = stopped ? static_cast<int>(Exit::interrupted) : exit;
    row.seconds = std::chrono::duration<double>(Clock::now() - one.began).count();
    if (row.exit == 0) {
      take_from_summary(folder(one.at), row);
    } else {
      row.error = one.program.last_line();
      if (row.error.empty()) row.error = "ended without a word";
      if (exit > 128 && !stopped) row.error = "ended by signal " + std::to_string(exit - 128);
    }
    keep(one.at, std::move(row));
  }

  void keep(std::size_t at, BatchRow row) {
    std::cout << batch_line(row, ++done_, cases_.size()) << std::endl;
    rows_[at] = std::move(row);
    write_text(common_.output / kBatchTable, batch_csv(rows_));
  }

  std::vector<BatchCase> cases_;
  const CommonOptions& common_;
  const SamplingOptions& sampling_;
  std::vector<std::optional<BatchRow>> rows_;
  std::list<Running> running_;
  std::size_t next_ = 0, done_ = 0;
  int free_;  // threads
  bool told_ = false;
};

}  // namespace

void run_batch(const CommonOptions& common, const SamplingOptions& sampling) {
  static_cast<void>(evidence_methods(sampling.evidence));  // refuse before anything runs
  std::vector<BatchCase> cases = read_batch_list(common.case_path);
  outlive_readers();
  make_output_folder(common.output);
  { const io::AtomicFile writable(common.output / kBatchTable); }
  const StopOnInterrupt stop;
  Batch batch(std::move(cases), common, sampling);
  batch.run();
  const auto& rows = batch.rows();
  const std::string all = std::to_string(rows.size());
  if (batch.done() < rows.size()) {
    throw Failure(Exit::interrupted, "stopped after " + std::to_string(batch.done()) + " of " +
                                         all + " cases; the same command with --resume goes on");
  }
  std::cout << "Results: " << io::printable((common.output / kBatchTable).string())
            << " (the table), a folder for each case beside it\n";
  const auto failed = [](const std::optional<BatchRow>& row) { return row->exit != 0; };
  const auto first = std::ranges::find_if(rows, failed);
  if (first == rows.end()) return;
  throw Failure(static_cast<Exit>((*first)->exit),
                std::to_string(std::ranges::count_if(rows, failed)) + " of " + all +
                    " cases failed, the first of them " + (*first)->name + " (exit code " +
                    std::to_string((*first)->exit) + "); --resume runs those again");
}

}  // namespace wheeltap::apps
