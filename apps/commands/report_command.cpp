#include <filesystem>
#include <iostream>

#include "apps/commands/command_list.hpp"
#include "apps/commands/command_options.hpp"
#include "apps/report/report.hpp"
#include "io/file_error.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {

namespace {

void run_report(const std::filesystem::path& directory, bool figures) {
  if (!std::filesystem::is_directory(directory)) {
    throw io::FileError(io::FileError::Kind::missing, directory,
                        std::filesystem::exists(directory)
                            ? "is not a folder: give the folder of the run"
                            : "no such folder");
  }
  write_report(directory);
  std::cout << "Report: " << io::printable((directory / "report.html").string()) << '\n';
  if (figures) {
    const int n = write_figures(directory);
    std::cout << n << " figures: " << io::printable((directory / "figures").string()) << '\n';
  }
}

}  // namespace

Command report_command() {
  const auto figures = std::make_shared<bool>(false);
  return {.name = "report",
          .summary = "write report.html of a finished run again",
          .add_options =
              [figures](CommandOptions& options) {
                CLI::App& app = options.app();
                app.add_option("DIR", options.invocation().common.output,
                               "results folder of the run")
                    ->required();
                app.add_flag("--figures", *figures,
                             "also write the figures as SVG files (needs Node.js)");
              },
          .run = [figures](const Invocation& asked) { run_report(asked.common.output, *figures); }};
}

}  // namespace wheeltap::apps
