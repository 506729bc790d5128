#include "apps/commands/command_list.hpp"

namespace wheeltap::apps {

const std::vector<Command>& commands() {
  static const std::vector<Command> all = {
      modes_command(),   section_command(),    data_command(),     table_command(),
      damage_command(),  sid_command(),        modal_command(),    batch_command(),
      update_command(),  monitor_command(),    track_command(),    plan_command(),
      serve_command(),   app_command(),        simulate_command(), report_command(),
      compare_command(), init_command(),       laws_command(),     schema_command(),
      explain_command(), completion_command(), man_command(),
  };
  return all;
}

const Command* command_of_kind(const CaseFile& file) {
  if (!file.json.is_object() || !file.json.contains("kind")) return nullptr;
  const Command* general = nullptr;
  for (const Command& command : commands()) {
    if (command.case_kind.empty() || file.json["kind"] != command.case_kind) continue;
    if (command.case_key.empty()) general = &command;
    if (!command.case_key.empty() && file.json.contains(command.case_key)) return &command;
  }
  return general;
}

std::vector<std::string> case_kinds(bool sampled_only) {
  std::vector<std::string> kinds;
  for (const Command& command : commands())
    if (!command.case_kind.empty() && command.case_key.empty() &&
        (command.make_run || !sampled_only))
      kinds.push_back(command.case_kind);
  return kinds;
}

}  // namespace wheeltap::apps
