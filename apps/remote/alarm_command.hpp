// The program that a monitor case runs on an alarm.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace wheeltap::apps {

struct AlarmCommand {
  std::vector<std::string> words = {};  ///< {summary}: summary.json, {case}: folder of the case
  std::filesystem::path folder = {};    ///< the case's
  double timeout_seconds = 60.0;
};

/// Runs the command in the folder of the case, with `text` on its standard input; what it prints
/// goes to standard error. No shell interprets the words. Returns a sentence on what went wrong, or
/// an empty text.
[[nodiscard]] std::string run_on_alarm(const AlarmCommand& command,
                                       const std::filesystem::path& summary,
                                       const std::string& text);

}  // namespace wheeltap::apps
