#include "apps/commands/command_list.hpp"
#include "apps/commands/command_options.hpp"
#include "apps/runs/case_run.hpp"

namespace wheeltap::apps {

Command damage_command() {
  return sampled_command({.name = "damage",
                          .summary = "infer the number, positions and severities of damages",
                          .make_run = make_damage_run},
                         true);
}

}  // namespace wheeltap::apps
