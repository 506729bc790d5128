// Exit codes and failures of commands.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

namespace wheeltap::apps {

/// Exit codes of the program: the codes of sysexits.h, and the shell's code for an interrupt.
enum class Exit : int {
  done = 0,
  alarm = 3,           ///< `monitor --alarm-exit` found an alarm
  usage = 64,          ///< bad command line
  bad_input = 65,      ///< invalid case or data
  no_input = 66,       ///< a file is missing or unreadable
  internal = 70,       ///< an internal error of the program
  cannot_create = 73,  ///< output cannot be written
  interrupted = 130,   ///< Ctrl-C before the run had results
};

/// The key of the case to which a failure refers.
struct CasePlace {
  std::string pointer;  ///< JSON pointer, e.g. /beam/material/poisson; "/" for the whole case
  std::string reason;   ///< the message without file and pointer
};

/// A failure of a command: an exit code and one line that states the location, the value and the
/// allowed values.
class Failure : public std::runtime_error {
 public:
  Failure(Exit exit, const std::string& line, std::optional<CasePlace> place = {})
      : std::runtime_error(line), exit_(exit), place_(std::move(place)) {}
  [[nodiscard]] Exit exit() const { return exit_; }
  /// The key of the case; empty if the failure does not refer to a key.
  [[nodiscard]] const std::optional<CasePlace>& place() const { return place_; }

 private:
  Exit exit_;
  std::optional<CasePlace> place_;
};

}  // namespace wheeltap::apps
