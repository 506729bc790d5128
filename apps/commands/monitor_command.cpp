#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <thread>

#include "apps/cases/monitoring/monitor_case.hpp"
#include "apps/commands/command_list.hpp"
#include "apps/commands/command_options.hpp"
#include "apps/remote/alarm_command.hpp"
#include "apps/results/monitoring/monitor_summary.hpp"
#include "apps/results/terminal.hpp"
#include "apps/runs/monitor_run.hpp"
#include "apps/runs/run_cost.hpp"
#include "apps/runs/running.hpp"
#include "base/parallel.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {

namespace {

struct MonitorFlags {
  bool alarm_exit = false, follow = false, charts = false;
  double poll_seconds = 5.0;
};

ModesReading reading_of(const CommonOptions& common, bool following, ProgressBar& bar) {
  return {.threads = base::thread_count(common.threads),
          .seed = common.seed.value_or(1),
          .kept = common.output.empty() ? std::filesystem::path() : common.output / "modes",
          .following = following,
          .progress = [&bar](double fraction) { bar.show("records", fraction, ""); }};
}

/// The program that the case runs on an alarm. Throws Failure (64) if programs are not allowed.
std::optional<AlarmCommand> alarm_command(const CaseFile& file, const CommonOptions& common) {
  const Pointer where("/on_alarm/command");
  if (!file.json.contains(where)) return {};
  AlarmCommand out{.words = file.json.at(where).get<std::vector<std::string>>(),
                   .folder = file.path.parent_path().empty() ? "." : file.path.parent_path(),
                   .timeout_seconds = file.json.at("on_alarm").value("timeout", 60.0)};
  if (!common.allow_commands)
    throw Failure(Exit::usage, file.path.string() + ": " + where.to_string() +
                                   ": runs the program \"" + out.words[0] +
                                   "\", which needs --allow-commands");
  return out;
}

/// Input of the program: the headline and the new alarms.
std::string alarm_text(const MonitorRun& run, const std::filesystem::path& folder) {
  const Report& monitor = run.summary.at("monitor");
  const Report& all = monitor.at("alarms");
  Report fresh = Report::array();
  for (std::size_t i = all.size() - run.new_alarms; i < all.size(); ++i) fresh.push_back(all[i]);
  const Report out = {{"title", run.summary.at("title")},
                      {"headline", monitor_headline(monitor)},
                      {"folder", std::filesystem::absolute(folder).string()},
                      {"time_unit", monitor.at("time_unit")},
                      {"alarms", fresh}};
  return out.dump(1) + "\n";
}

Report process(const CommonOptions& common, const MonitorFlags& flags) {
  ProgressBar bar(common.quiet);
  const MonitorCaseFile parsed = parse_monitor_case(read_case(common.case_path, common.overrides),
                                                    reading_of(common, flags.follow, bar));
  bar.clear();
  const std::optional<AlarmCommand> command = alarm_command(parsed.file, common);
  MonitorRun run = run_monitor(parsed, common, {.charts = flags.charts});
  if (common.as_json)
    common.as_json(run.summary.dump(1));
  else
    print_monitor(std::cout, parsed, run.summary, colour_wanted());
  if (command && run.new_alarms > 0)
    if (const std::string fault =
            run_on_alarm(*command, common.output / "summary.json", alarm_text(run, common.output));
        !fault.empty())
      std::cerr << "wheeltap: " << io::printable(fault) << "\n";
  return std::move(run.summary);
}

/// Waits until a file of the series changes. Returns false if the program should end.
bool wait_for_rows(const CommonOptions& common, std::string& seen, double seconds) {
  for (;;) {
    for (double waited = 0.0; waited < seconds; waited += 0.2) {
      if (was_interrupted()) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
    }
    const std::string now = files_now(read_case(common.case_path, common.overrides));
    if (now.empty() || now == seen) continue;
    seen = now;
    return true;
  }
}

bool alarmed(const Report& summary) {
  return summary.at("monitor").at("alarm").get<bool>();
}

/// Estimates the run time from measured times of the training and of one row.
RunCost cost_of_monitoring(const MonitorCaseFile& parsed) {
  const auto features = static_cast<double>(parsed.series.feature_count());
  const double monitored = parsed.series.rows() - parsed.learning_rows;
  return {.seconds = 0.02 * features * parsed.learning_rows + 1e-3 * features * monitored};
}

void monitor(CommonOptions common, const MonitorFlags& flags) {
  if (common.dry_run)
    return common.dry_run(
        "monitoring",
        cost_of_monitoring(parse_monitor_case(read_case(common.case_path, common.overrides))));
  claim_output_folder(common.output);
  Report summary;
  std::optional<StopOnInterrupt> stop;
  for (;;) {
    std::string seen;
    if (flags.follow) seen = files_now(read_case(common.case_path, common.overrides));
    summary = process(common, flags);
    if (!common.as_json)
      std::cout << "\nResults: " << io::printable((common.output / "summary.json").string())
                << "\nReport: " << io::printable((common.output / "report.html").string())
                << std::endl;
    if (!flags.follow || (flags.alarm_exit && alarmed(summary))) break;
    common.resume = true;
    if (!stop) stop.emplace();
    if (!wait_for_rows(common, seen, flags.poll_seconds)) break;
  }
  if (flags.alarm_exit && alarmed(summary))
    throw Failure(Exit::alarm, monitor_headline(summary.at("monitor")));
}

}  // namespace

Command monitor_command() {
  const auto flags = std::make_shared<MonitorFlags>();
  return {
      .name = "monitor",
      .summary = "detect changes of features under changing weather: alarms, onset of changes",
      .case_kind = "monitor",
      .check = [](CaseFile file) { static_cast<void>(parse_monitor_case(std::move(file))); },
      .add_options =
          [flags](CommandOptions& options) {
            options.add_case();
            options.add_output("FOLDER",
                               "folder of the results: summary.json, series.csv, "
                               "state.nc and report.html");
            options.add_json(kSummary);
            options.add_seed("seed of the training and of the replay of healthy rows (default 1)");
            options.add_threads();
            options.add_dry_run();
            options.app().add_flag(
                "--allow-commands", options.invocation().common.allow_commands,
                "allow the case to run a program when an alarm is raised (\"on_alarm\")");
            options.add_resume("process only the rows that are new since the last call");
            CLI::App& app = options.app();
            app.add_flag("--alarm-exit", flags->alarm_exit,
                         "end with exit code 3 if an alarm was raised");
            app.add_flag("--charts", flags->charts,
                         "also run the usual control charts over all rows, for comparison");
            app.add_flag("--follow", flags->follow,
                         "wait for new rows or files until interrupted; Wheeltap reads the "
                         "last line only after its line break is written");
            app.add_option(
                   "--poll", flags->poll_seconds,
                   "time in seconds between two checks of the files with --follow (default 5)")
                ->check(positive());
          },
      .run = [flags](const Invocation& asked) { monitor(asked.common, *flags); }};
}

}  // namespace wheeltap::apps
