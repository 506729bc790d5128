#include "apps/application/run_queue.hpp"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <exception>
#include <utility>

#include "apps/failure.hpp"
#include "apps/json_text.hpp"
#include "apps/run_options.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {
namespace {

constexpr std::size_t kMostWaiting = 100, kMostKept = 200, kLongestLine = 65536;
constexpr std::size_t kMostTracePoints = 200, kMostStages = 100;
constexpr auto kWatchInterval = std::chrono::milliseconds(100);
constexpr auto kPatience = std::chrono::seconds(10);  // time for runs to end after a signal
constexpr const char* kCheckpointSeconds = "5";

}  // namespace

RunQueue::RunQueue(int at_once, int threads)
    : at_once_(at_once),
      threads_(threads),
      thread_([this](const std::stop_token& done) { watch(done); }) {}

RunQueue::~RunQueue() {
  thread_.request_stop();
  thread_.join();
  const std::lock_guard lock(mutex_);
  for (Run& run : runs_)
    if (run.program) run.program->send(SIGINT);
  const auto last = Clock::now() + kPatience;
  while (running() > 0 && Clock::now() < last) {
    for (Run& run : runs_)
      if (run.program && run.program->ended()) run.program.reset();
    std::this_thread::sleep_for(kWatchInterval);
  }
}

int RunQueue::running() const {
  return static_cast<int>(
      std::ranges::count_if(runs_, [](const Run& run) { return run.program != nullptr; }));
}

bool RunQueue::busy(const std::filesystem::path& output) const {
  return std::ranges::any_of(runs_, [&](const Run& run) {
    return run.request.output == output && (run.program || run.state == "queued");
  });
}

bool RunQueue::is_busy(const std::filesystem::path& output) const {
  const std::lock_guard lock(mutex_);
  return busy(output);
}

std::optional<int> RunQueue::add(RunRequest request) {
  const std::lock_guard lock(mutex_);
  const auto waiting = std::ranges::count(runs_, "queued", &Run::state);
  if (static_cast<std::size_t>(waiting) >= kMostWaiting || busy(request.output)) return {};
  while (runs_.size() >= kMostKept) {
    const auto old =
        std::ranges::find_if(runs_, [](const Run& run) { return run.ended.has_value(); });
    if (old == runs_.end()) break;
    runs_.erase(old);
  }
  runs_.push_back({.number = next_++, .request = std::move(request)});
  return runs_.back().number;
}

bool RunQueue::stop(int number) {
  const std::lock_guard lock(mutex_);
  const auto run = std::ranges::find(runs_, number, &Run::number);
  if (run == runs_.end() || run->ended) return false;
  if (run->program) {
    run->program->send(SIGINT);
    run->state = "stopping";
  } else {
    run->state = "stopped";
    run->ended = Clock::now();
  }
  return true;
}

void RunQueue::watch(const std::stop_token& done) {
  while (!done.stop_requested()) {
    step();
    std::this_thread::sleep_for(kWatchInterval);
  }
}

void RunQueue::step() {
  const std::lock_guard lock(mutex_);
  for (Run& run : runs_) {
    if (!run.program) continue;
    try {
      run.exit = run.program->ended();
    } catch (const std::exception& error) {
      run.message = error.what();
      run.exit = static_cast<int>(Exit::internal);
    }
    read(run, run.program->take_output());
    if (!run.exit) continue;
    run.ended = Clock::now();
    const bool stopped =
        run.state == "stopping" || *run.exit == static_cast<int>(Exit::interrupted);
    run.state = *run.exit != 0 && !stopped ? "failed" : stopped ? "stopped" : "done";
    run.program.reset();
  }
  for (Run& run : runs_) {
    if (running() >= at_once_) return;
    if (run.state == "queued") start(run);
  }
}

void RunQueue::start(Run& run) const {
  const RunRequest& asked = run.request;
  std::vector<std::string> words = {asked.command, asked.case_path.string(),
                                    "-o",          asked.output.string(),
                                    "--threads",   std::to_string(threads_)};
  if (asked.seed) words.insert(words.end(), {"--seed", std::to_string(*asked.seed)});
  if (asked.samples) words.insert(words.end(), {"--checkpoint", kCheckpointSeconds});
  if (asked.quick) words.emplace_back("--quick");
  if (asked.resume) words.emplace_back("--resume");
  run.begun = Clock::now();
  try {
    run.program = std::make_unique<ChildProgram>(
        words, std::vector<std::string>{std::string(kProgressVariable) + "=json"});
    run.state = "running";
  } catch (const std::exception& error) {
    run.state = "failed";
    run.message = error.what();
    run.ended = run.begun;
  }
}

void RunQueue::read(Run& run, const std::string& output) {
  run.unread += output;
  for (std::size_t end = 0; (end = run.unread.find('\n')) != std::string::npos;) {
    const std::string line = run.unread.substr(0, std::min(end, kLongestLine));
    run.unread.erase(0, end + 1);
    const nlohmann::json progress = line.starts_with('{') ? parse_answer(line) : nlohmann::json();
    if (!progress.is_object() || !progress.contains("stage")) {
      if (!line.empty()) run.message = io::printable(line);
      continue;
    }
    try {
      run.stage = progress.value("stage", "");
      if (run.stages.size() < kMostStages &&
          (run.stages.empty() || run.stages.back().name != run.stage))
        run.stages.push_back({run.stage, seconds_of(run)});
      if (progress.contains("models")) note_models(run, progress.at("models"));
      run.fraction = progress.value("fraction", 0.0);
      run.detail = progress.value("detail", "");
      run.seconds_left.reset();
      if (progress.contains("seconds_left"))
        run.seconds_left = progress.at("seconds_left").get<double>();
    } catch (const nlohmann::json::exception&) {  // a line in another format
      run.message = io::printable(line);
    }
  }
  if (run.unread.size() > kLongestLine) run.unread.clear();
}

double RunQueue::seconds_of(const Run& run) {
  if (!run.begun) return 0.0;
  return std::chrono::duration<double>(run.ended.value_or(Clock::now()) - *run.begun).count();
}

void RunQueue::note_models(Run& run, const nlohmann::json& models) {
  const double now = seconds_of(run);
  if (!run.trace.empty() && now - run.trace.back().seconds < run.trace_step) return;
  Point point{.seconds = now, .probabilities = {}};
  for (const nlohmann::json& model : models)
    point.probabilities[model.at("name").get<std::string>()] =
        model.at("probability").get<double>();
  if (run.trace.size() >= kMostTracePoints) {  // keep every second point, including the last
    for (std::size_t i = 0; 2 * i + 1 < run.trace.size(); ++i)
      run.trace[i] = std::move(run.trace[2 * i + 1]);
    run.trace.resize(run.trace.size() / 2);
    run.trace_step *= 2.0;
  }
  run.trace.push_back(std::move(point));
}

Report RunQueue::trace_of(const Run& run) {
  const auto rounded = [](double x) { return std::round(1e4 * x) / 1e4; };
  // Models in the order of their latest probabilities; models without a latest value are omitted.
  std::vector<std::pair<std::string, double>> last(run.trace.back().probabilities.begin(),
                                                   run.trace.back().probabilities.end());
  std::ranges::stable_sort(last, std::ranges::greater{}, &std::pair<std::string, double>::second);
  Report seconds = Report::array(), models = Report::array();
  for (const Point& point : run.trace) seconds.push_back(rounded(point.seconds));
  for (const auto& [name, ignored] : last) {
    Report line = Report::array();
    for (const Point& point : run.trace) {
      const auto found = point.probabilities.find(name);
      line.push_back(found == point.probabilities.end() ? Report() : rounded(found->second));
    }
    models.push_back({{"name", io::printable(name)}, {"probability", std::move(line)}});
  }
  return {{"seconds", seconds}, {"models", models}};
}

Report RunQueue::list() const {
  const std::lock_guard lock(mutex_);
  Report out = Report::array();
  for (const Run& run : runs_) {
    Report one = {{"number", run.number},
                  {"command", run.request.command},
                  {"case", run.request.case_name},
                  {"output", run.request.output_name},
                  {"state", run.state},
                  {"stage", run.stage},
                  {"fraction", run.fraction},
                  {"detail", run.detail},
                  {"message", run.message}};
    if (run.seconds_left) one["seconds_left"] = *run.seconds_left;
    if (run.exit) one["exit"] = *run.exit;
    if (run.begun) one["seconds"] = seconds_of(run);
    for (const Stage& stage : run.stages)
      one["stages"].push_back({{"name", io::printable(stage.name)}, {"begin", stage.begin}});
    if (run.program && !run.trace.empty()) one["trace"] = trace_of(run);
    out.push_back(std::move(one));
  }
  return out;
}

}  // namespace wheeltap::apps
