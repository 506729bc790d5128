// Start of another program as a child process.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace wheeltap::base {

/// Exit codes of a shell for a program that does not exist, and for a program that cannot be run.
inline constexpr int kProgramNotFound = 127, kNotRunnable = 126;

struct ProgramStart {
  const char* file;                        ///< program file; a name without "/" is searched for in
                                           ///< PATH
  std::vector<std::string> words;          ///< arguments; the first is the program's name
  std::vector<std::string> environment{};  ///< "NAME=VALUE"; empty: the environment of this process
  std::string directory = ".";             ///< working directory
  /// File descriptors of the program's standard input, output and error. This process should open
  /// these descriptors with O_CLOEXEC.
  int input, output, error;
};

/// Starts the program as a child process with default signal handlers. The child process has its
/// own process group, so that a terminal's Ctrl-C does not reach it. The system kills the child
/// process when this process ends. Returns the process identifier of the child, or -1 with errno if
/// the system creates no process. The child process ends with the exit code kProgramNotFound if the
/// program does not exist, and with kNotRunnable if the system cannot run the program.
[[nodiscard]] pid_t start_program(ProgramStart start);

/// Waits for the end of a child process. Returns the status of the child as waitpid does, or -1
/// with errno if `child` is not a child of this process.
[[nodiscard]] int wait_for(pid_t child);

}  // namespace wheeltap::base
