#include <iostream>

#include "apps/commands/command_list.hpp"

namespace wheeltap::apps {

Command man_command() {
  return {.name = "man",
          .summary = "print the manual page, for man -l -",
          .add_options = [](CommandOptions&) {},
          .run = [](const Invocation& asked) { std::cout << man_page(asked.describe()); }};
}

}  // namespace wheeltap::apps
