#include <iostream>

#include "apps/cases/syntax/case_file.hpp"
#include "apps/commands/command_list.hpp"
#include "apps/commands/command_options.hpp"

namespace wheeltap::apps {

Command schema_command() {
  const auto kind = std::make_shared<std::string>();
  return {.name = "schema",
          .summary = "print the JSON Schema of a kind of case",
          .add_options =
              [kind](CommandOptions& options) {
                *kind = case_kinds().front();
                options.app().add_option("NAME", *kind, "kind of case (default: " + *kind + ")");
              },
          .run = [kind](const Invocation&) { std::cout << schema(*kind).dump(2) << '\n'; }};
}

}  // namespace wheeltap::apps
