// Exit codes and failures of commands.
#pragma once

#include <stdexcept>
#include <string>

namespace wheeltap::apps {

/// Exit codes of the program: the codes of sysexits.h, and the shell's code for an interrupt.
enum class Exit : int {
  done = 0,
  alarm = 3,           ///< `monitor --alarm-exit` found an alarm
  usage = 64,          ///< bad command line
  bad_input = 65,      ///< invalid case or data
  no_input = 66,       ///< a file is missing or unreadable
  internal = 70,       ///< a fault of the program
  cannot_create = 73,  ///< output cannot be written
  interrupted = 130,   ///< Ctrl-C before the run had results
};

/// A failure of a command: an exit code and one line with the location, the value and the allowed
/// values.
class Failure : public std::runtime_error {
 public:
  Failure(Exit exit, const std::string& line) : std::runtime_error(line), exit_(exit) {}
  [[nodiscard]] Exit exit() const { return exit_; }

 private:
  Exit exit_;
};

}  // namespace wheeltap::apps
