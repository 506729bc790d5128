// Starting another program as a process.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace wheeltap::base {

/// Exit codes of the shell if it does not find a program, or cannot run it.
inline constexpr int kProgramNotFound = 127, kNotRunnable = 126;

struct ProgramStart {
  const char* file;                        ///< without a "/", searched for in PATH
  std::vector<std::string> words;          ///< the first is the program's name
  std::vector<std::string> environment{};  ///< "NAME=VALUE"; none: that of this process
  std::string directory = ".";             ///< working directory
  /// File descriptors: its standard input, output and error. This process should have opened them
  /// with O_CLOEXEC.
  int input, output, error;
};

/// Starts the program with default signal handlers and in its own process group, so that a
/// terminal's Ctrl-C does not reach it. The system kills it when this process ends. Returns its
/// process identifier, or -1 with errno if the system creates no process. The child process ends
/// with kProgramNotFound if the program does not exist, and with kNotRunnable if it cannot be run.
[[nodiscard]] pid_t start_program(ProgramStart start);

/// Waits for the end of a child process. Returns its status as waitpid does; -1 with errno if
/// it is not a child of this process.
[[nodiscard]] int wait_for(pid_t child);

}  // namespace wheeltap::base
