// The command line: which command it names, with which options, and how that ends.
#pragma once

#include <vector>

#include "apps/commands/command.hpp"

namespace wheeltap::apps {

/// Reads the command line argv[1], …, argv[argc - 1] and runs the command of the list that it
/// names, as one of the ranks where mpirun has started several; returns the exit code. A failure is
/// one line on standard error.
[[nodiscard]] int run_program(const std::vector<Command>& commands, int argc, char** argv);

}  // namespace wheeltap::apps
