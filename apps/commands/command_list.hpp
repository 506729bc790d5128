// All commands of the program.
#pragma once

#include <vector>

#include "apps/commands/command.hpp"

namespace wheeltap::apps {

[[nodiscard]] Command modes_command();
[[nodiscard]] Command section_command();
[[nodiscard]] Command data_command();
[[nodiscard]] Command table_command();
[[nodiscard]] Command damage_command();
[[nodiscard]] Command sid_command();
[[nodiscard]] Command modal_command();
[[nodiscard]] Command batch_command();
[[nodiscard]] Command update_command();
[[nodiscard]] Command monitor_command();
[[nodiscard]] Command serve_command();
[[nodiscard]] Command simulate_command();
[[nodiscard]] Command report_command();
[[nodiscard]] Command compare_command();
[[nodiscard]] Command init_command();
[[nodiscard]] Command laws_command();
[[nodiscard]] Command schema_command();
[[nodiscard]] Command explain_command();
[[nodiscard]] Command completion_command();
[[nodiscard]] Command man_command();

/// In the order of --help. A new command is a file NAME_command.cpp, its declaration above and its
/// line in this list.
[[nodiscard]] const std::vector<Command>& commands();

}  // namespace wheeltap::apps
