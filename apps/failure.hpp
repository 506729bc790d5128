// How a command ends when it cannot do its work.
#pragma once

#include <stdexcept>
#include <string>

namespace wheeltap::apps {

/// The program's exit codes: those of sysexits.h, and the shell's for an interrupt.
enum class Exit : int {
  done = 0,
  alarm = 3,           ///< `monitor --alarm-exit` and an alarm
  usage = 64,          ///< bad command line
  bad_input = 65,      ///< invalid case or data
  no_input = 66,       ///< a file is missing or unreadable
  internal = 70,       ///< a fault of ours
  cannot_create = 73,  ///< output cannot be written
  interrupted = 130,   ///< Ctrl-C before there was anything to keep
};

/// One readable line that names the place, the value and what is allowed, and the exit code.
class Failure : public std::runtime_error {
 public:
  Failure(Exit exit, const std::string& line) : std::runtime_error(line), exit_(exit) {}
  [[nodiscard]] Exit exit() const { return exit_; }

 private:
  Exit exit_;
};

}  // namespace wheeltap::apps
