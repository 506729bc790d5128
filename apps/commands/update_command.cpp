#include "apps/commands/command_list.hpp"
#include "apps/commands/command_options.hpp"
#include "apps/runs/case_run.hpp"

namespace wheeltap::apps {

Command update_command() {
  return sampled_command({.name = "update",
                          .summary = "update the parameters of a structure from measured modes",
                          .make_run = make_update_run},
                         true);
}

}  // namespace wheeltap::apps
