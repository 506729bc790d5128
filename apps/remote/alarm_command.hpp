// The program that a monitor case runs on an alarm.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace wheeltap::apps {

struct AlarmCommand {
  /// Program and arguments; {summary} is the path of summary.json, {case} the folder of the case
  std::vector<std::string> words = {};
  std::filesystem::path folder = {};  ///< folder of the case
  double timeout_seconds = 60.0;
};

/// Runs the command in the folder of the case, with `text` on its standard input; its output goes
/// to standard error. No shell interprets the words. Returns a message about the failure, or an
/// empty string.
[[nodiscard]] std::string run_on_alarm(const AlarmCommand& command,
                                       const std::filesystem::path& summary,
                                       const std::string& text);

}  // namespace wheeltap::apps
