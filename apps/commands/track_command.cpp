#include <iostream>
#include <memory>
#include <stdexcept>

#include "apps/commands/command_list.hpp"
#include "apps/commands/command_options.hpp"
#include "apps/results/monitoring/tracked_modes.hpp"
#include "apps/results/terminal.hpp"
#include "io/atomic_file.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {
namespace {

struct TrackFlags {
  double share = 0.5;
  int learning = 0;
};

void track(const CommonOptions& common, const TrackFlags& flags) {
  using identification::monitoring::ModeTracker;
  const std::string list = io::printable(common.case_path.string());
  if (!std::filesystem::exists(common.case_path))
    throw Failure(Exit::no_input, list + ": no such file or folder");
  const auto paths = mode_files(common.case_path);
  if (paths.empty()) throw Failure(Exit::no_input, list + ": has no modes.json files");
  for (const auto& path : paths)
    if (!std::filesystem::is_regular_file(path))
      throw Failure(Exit::no_input,
                    list + " names " + io::printable(path.string()) + ": there is no such file");
  const std::vector<MonitoredTest> tests = read_tests(paths);
  const auto records = identified_records(tests);
  const auto n = static_cast<std::ptrdiff_t>(records.size());
  const auto learning = flags.learning > 0 ? std::min<std::ptrdiff_t>(flags.learning, n) : n;
  std::unique_ptr<ModeTracker> tracker;
  std::vector<identification::monitoring::TrackedRecord> assigned;
  try {
    tracker = std::make_unique<ModeTracker>(
        std::vector(records.begin(), records.begin() + learning), Eigen::MatrixXd(learning, 0),
        identification::monitoring::TrackingOptions{.share = flags.share});
    assigned = tracker->track(records, Eigen::MatrixXd(n, 0));
  } catch (const std::invalid_argument& error) {
    throw Failure(Exit::bad_input, list + ": " + error.what());
  }
  const TrackedModesOf tracked{tests, assigned, tracker->modes()};
  io::AtomicFile file(common.output);
  file.write(tracked_netcdf(tracked, common.output));
  file.commit();
  if (common.as_json) return common.as_json(tracked_report(tracked).dump(1));
  if (common.quiet) return;
  print_tracked(std::cout, tracked, colour_wanted());
  std::cout << "\nTracked modes: " << io::printable(common.output.string()) << "\n";
}

}  // namespace

Command track_command() {
  const auto flags = std::make_shared<TrackFlags>();
  return {.name = "track",
          .summary = "assign the modes of many records to tracked modes",
          .add_options =
              [flags](CommandOptions& options) {
                options.app()
                    .add_option("LIST", options.invocation().common.case_path,
                                "folder of modes.json files, or a text file with one path per "
                                "line, in order of time")
                    ->required();
                options.add_output("FILE.nc", "file of tracked modes to write (NetCDF)");
                options.add_json("print the table as JSON");
                options.app()
                    .add_option("--share", flags->share,
                                "smallest fraction of the training records in which a tracked mode "
                                "must be identified (default 0.5)")
                    ->check(CLI::Range(0.01, 1.0));
                options.app()
                    .add_option("--learning", flags->learning,
                                "number of training records, from the first one (default: all)")
                    ->check(whole(3, kMany));
              },
          .run = [flags](const Invocation& asked) { track(asked.common, *flags); }};
}

}  // namespace wheeltap::apps
