// Command-line parsing, dispatch to a command, and exit codes.
#pragma once

#include <vector>

#include "apps/commands/command.hpp"

namespace wheeltap::apps {

/// Parses the command line argv[1], …, argv[argc - 1], runs the command of the list that it names
/// and returns the exit code. Under mpirun it runs as one of the ranks. A failure prints one line
/// on standard error.
[[nodiscard]] int run_program(const std::vector<Command>& commands, int argc, char** argv);

}  // namespace wheeltap::apps
