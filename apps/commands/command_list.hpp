// All commands of the program.
#pragma once

#include <string>
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
[[nodiscard]] Command plan_command();
[[nodiscard]] Command track_command();
[[nodiscard]] Command serve_command();
[[nodiscard]] Command app_command();
[[nodiscard]] Command simulate_command();
[[nodiscard]] Command report_command();
[[nodiscard]] Command compare_command();
[[nodiscard]] Command init_command();
[[nodiscard]] Command laws_command();
[[nodiscard]] Command schema_command();
[[nodiscard]] Command explain_command();
[[nodiscard]] Command completion_command();
[[nodiscard]] Command man_command();

/// The commands in the order of --help. A new command needs a file NAME_command.cpp, a declaration
/// in this header and an entry in this list.
[[nodiscard]] const std::vector<Command>& commands();

/// The command that runs a case with this kind and these keys; null if no command runs it.
[[nodiscard]] const Command* command_of_kind(const CaseFile& file);

/// The kinds of case that commands run; with `sampled_only`, only those whose command samples.
[[nodiscard]] std::vector<std::string> case_kinds(bool sampled_only = false);

}  // namespace wheeltap::apps
