#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <thread>

#include "apps/cases/monitoring/monitor_case.hpp"
#include "apps/commands/command_list.hpp"
#include "apps/commands/command_options.hpp"
#include "apps/results/monitoring/monitor_summary.hpp"
#include "apps/results/terminal.hpp"
#include "apps/runs/monitor_run.hpp"
#include "apps/runs/run_cost.hpp"
#include "apps/runs/running.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {

namespace {

struct MonitorFlags {
  bool alarm_exit = false, follow = false;
  double poll_seconds = 5.0;
};

Report process(const CommonOptions& common) {
  const MonitorCaseFile parsed = parse_monitor_case(read_case(common.case_path, common.overrides));
  Report summary = run_monitor(parsed, common);
  if (common.as_json)
    common.as_json(summary.dump(1));
  else
    print_monitor(std::cout, parsed, summary, colour_wanted());
  return summary;
}

/// The file of the case's table; the case itself where it names none.
std::filesystem::path table_of(const CommonOptions& common) {
  const CaseFile file = read_case(common.case_path, common.overrides);
  const Pointer where("/series/file");
  if (!file.json.contains(where) || !file.json.at(where).is_string()) return common.case_path;
  return file.place_of(file.json.at(where).get<std::string>());
}

/// Waits until the table's file changes; false where the program is to end.
bool wait_for_rows(const std::filesystem::path& table, std::filesystem::file_time_type& seen,
                   double seconds) {
  for (;;) {
    for (double waited = 0.0; waited < seconds; waited += 0.2) {
      if (was_interrupted()) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
    }
    std::error_code error;
    const auto now = std::filesystem::last_write_time(table, error);
    if (error || now == seen) continue;
    seen = now;
    return true;
  }
}

bool alarmed(const Report& summary) {
  return summary.at("monitor").at("alarm").get<bool>();
}

/// From timings of learning and of one row.
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
    const std::filesystem::path table = table_of(common);
    std::error_code ignored;
    auto seen = std::filesystem::last_write_time(table, ignored);
    summary = process(common);
    if (!common.as_json)
      std::cout << "\nResults: " << io::printable((common.output / "summary.json").string())
                << "\nReport: " << io::printable((common.output / "report.html").string())
                << std::endl;
    if (!flags.follow || (flags.alarm_exit && alarmed(summary))) break;
    common.resume = true;
    if (!stop) stop.emplace();
    if (!wait_for_rows(table, seen, flags.poll_seconds)) break;
  }
  if (flags.alarm_exit && alarmed(summary))
    throw Failure(Exit::alarm, "alarm: " + monitor_headline(summary.at("monitor")));
}

}  // namespace

Command monitor_command() {
  const auto flags = std::make_shared<MonitorFlags>();
  return {.name = "monitor",
          .summary = "a series of features under weather: onset of change, and alarms",
          .case_kind = "monitor",
          .check = [](CaseFile file) { static_cast<void>(parse_monitor_case(std::move(file))); },
          .add_options =
              [flags](CommandOptions& options) {
                options.add_case();
                options.add_output("FOLDER",
                                   "the folder for the results: summary.json, series.csv, "
                                   "state.nc and report.html");
                options.add_json(kSummary);
                options.add_seed("of learning and of the replay of healthy rows");
                options.add_threads();
                options.add_dry_run();
                options.add_resume("process only the rows that are new since the last call");
                CLI::App& app = options.app();
                app.add_flag("--alarm-exit", flags->alarm_exit, "end with 3 on an alarm");
                app.add_flag("--follow", flags->follow,
                             "wait for new rows of the table, until interrupted");
                app.add_option("--poll", flags->poll_seconds,
                               "with --follow: seconds between two checks of the table")
                    ->check(positive());
              },
          .run = [flags](const Invocation& asked) { monitor(asked.common, *flags); }};
}

}  // namespace wheeltap::apps
