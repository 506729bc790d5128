// Texts of the command line. Shell completion and the manual page are generated from the texts of
// --help.
#pragma once

#include <string>
#include <vector>

namespace wheeltap::apps {

struct OptionText {
  std::vector<std::string> names;  ///< names of an option with dashes, or name of an argument
  std::string description;
  std::string value;  ///< description of the value, "INT in [1 - 1000]"; empty for a flag
  bool is_argument = false;
};
struct CommandText {
  std::string name, description;
  std::vector<OptionText> options;
};
struct ProgramText {
  std::string name, version, description;
  std::vector<CommandText> commands;
};

/// A completion script for bash, zsh or fish. Throws Failure (usage) for any other shell.
[[nodiscard]] std::string completion(const ProgramText& program, const std::string& shell);

/// The manual page (section 1), in man macros.
[[nodiscard]] std::string man_page(const ProgramText& program);

}  // namespace wheeltap::apps
