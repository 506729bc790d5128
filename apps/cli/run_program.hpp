// Command-line parsing, dispatch to a command, and exit codes.
#pragma once

#include <vector>

#include "apps/commands/command.hpp"

namespace wheeltap::apps {

/// Parses the command line argv[1], …, argv[argc - 1], runs the command of `commands` that argv[1]
/// names, and returns the exit code. Under mpirun, the process is one of the ranks. If the command
/// fails, the function prints one line on standard error.
[[nodiscard]] int run_program(const std::vector<Command>& commands, int argc, char** argv);

}  // namespace wheeltap::apps
