// The command line in words, and what shells and manuals make of them: the same texts as --help.
#pragma once

#include <string>
#include <vector>

namespace wheeltap::apps {

struct OptionText {
  std::vector<std::string> names;  ///< with their dashes; of an argument, its name alone
  std::string description;
  std::string value;  ///< what it takes, "INT in [1 - 1000]"; empty of a flag
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

/// What a shell sources to complete commands and options: bash, zsh or fish. Throws Failure (usage)
/// for another.
[[nodiscard]] std::string completion(const ProgramText& program, const std::string& shell);

/// The manual page of section 1, in man's macros.
[[nodiscard]] std::string man_page(const ProgramText& program);

}  // namespace wheeltap::apps
