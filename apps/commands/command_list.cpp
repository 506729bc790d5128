#include "apps/commands/command_list.hpp"

namespace wheeltap::apps {

const std::vector<Command>& commands() {
  static const std::vector<Command> all = {
      modes_command(),  section_command(), data_command(),       table_command(),
      damage_command(), sid_command(),     modal_command(),      batch_command(),
      update_command(), monitor_command(), serve_command(),      simulate_command(),
      report_command(), compare_command(), init_command(),       laws_command(),
      schema_command(), explain_command(), completion_command(), man_command(),
  };
  return all;
}

}  // namespace wheeltap::apps
