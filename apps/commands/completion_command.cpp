#include <iostream>

#include "apps/commands/command_list.hpp"
#include "apps/commands/command_options.hpp"

namespace wheeltap::apps {

Command completion_command() {
  const auto shell = std::make_shared<std::string>();
  return {
      .name = "completion",
      .summary = "print a script that completes commands and options in a shell",
      .add_options =
          [shell](CommandOptions& options) {
            options.app()
                .add_option("SHELL", *shell, "name of the shell: bash, zsh or fish")
                ->required();
          },
      .run =
          [shell](const Invocation& asked) { std::cout << completion(asked.describe(), *shell); }};
}

}  // namespace wheeltap::apps
