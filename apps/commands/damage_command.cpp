#include "apps/commands/command_list.hpp"
#include "apps/commands/command_options.hpp"

namespace wheeltap::apps {

Command damage_command() {
  return sampled_command({.name = "damage",
                          .summary = "how many damages, where, how bad",
                          .make_run = make_damage_run},
                         true);
}

}  // namespace wheeltap::apps
