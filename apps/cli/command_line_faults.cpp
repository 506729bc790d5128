#include "apps/cli/command_line_faults.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>

#include "apps/cases/syntax/case_file.hpp"
#include "apps/nearest.hpp"

namespace wheeltap::apps {
namespace {

/// Names of the options of a command: "--quick", "-o", ….
std::vector<std::string> options_of_command(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

bool has(const std::vector<std::string>& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

std::string unknown_option(const CLI::App& app, const CLI::App& command, const std::string& word) {
  const std::string option = word.substr(0, word.find('='));
  const std::vector<std::string> names = options_of_command(command);
  std::string text = command.get_name() + " has no option " + option;
  std::vector<std::string> others;
  for (const CLI::App* other : app.get_subcommands({}))
    if (has(options_of_command(*other), option)) others.push_back(other->get_name());
  // Accept -option for --option, and dashes that an editor has replaced by other characters.
  std::string bare = option;
  for (const char* dash : {"\xE2\x80\x93", "\xE2\x80\x94"})
    if (bare.starts_with(dash)) bare = "--" + bare.substr(3);
  bare = "--" + bare.substr(std::min(bare.find_first_not_of('-'), bare.size()));
  const std::string meant = has(names, bare) ? bare : nearest(bare, names);
  if (!meant.empty()) text += "; did you mean " + meant + "?";
  if (!others.empty()) text += "; an option of " + listed(others);
  return text;
}

}  // namespace

std::string unexpected_words(const CLI::App& app, const CLI::App& command) {
  const std::vector<std::string> left = command.remaining();
  if (left.empty()) return {};
  const std::string& word = left[0];
  if (word.starts_with('-') || word.starts_with("\xE2\x80\x93") || word.starts_with("\xE2\x80\x94"))
    return unknown_option(app, command, word);
  std::string text = "unexpected argument \"" + word + "\"";
  const std::vector<std::string> names = options_of_command(command);
  if (has(names, "--set") && word.find('=') != std::string::npos)
    return text + "; write --set " + word;
  if (has(names, "--output") && command.count("--output") == 0) return text + "; write -o " + word;
  if (std::filesystem::path(word).extension() == ".json")
    return text + ": a command runs one case at a time; wheeltap batch runs a list of cases";
  return text;
}

std::string unknown_command(const CLI::App& app, const std::string& word) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  const std::string meant = nearest(word, names);
  std::string text = "there is no command \"" + word + "\"";
  if (!meant.empty() && word.find('.') == std::string::npos)
    return text + "; did you mean \"" + meant + "\"?";
  if (std::filesystem::path(word).extension() != ".json") return text;
  std::string kind = "damage";
  try {
    const Json given = read_case(word).json.value("kind", Json());
    if (given.is_string() && has(names, given.get<std::string>())) kind = given.get<std::string>();
  } catch (const Failure&) {
    // Other functions report errors of the case.
  }
  return text + "; write wheeltap " + kind + " " + word + " -o results";
}

std::string output_is_missing(const CLI::App& command) {
  const CLI::Option* output = command.get_option("--output");
  std::string what = output->get_description();
  if (const std::string prefix = "required: "; what.starts_with(prefix))
    what.erase(0, prefix.size());
  const std::string type = output->get_type_name();
  return "--output is required: " + what + ", e.g. -o results" +
         (type.starts_with("FILE") ? type.substr(4) : "");
}

std::optional<std::string> missing_option(const CLI::App& command) {
  for (const CLI::Option* option : command.get_options()) {
    if (!option->get_required() || option->count() > 0) continue;
    if (option->check_lname("output")) return output_is_missing(command);
    std::string what = option->get_name() + " is required";
    if (option->get_name() == "CASE")
      what += ": the path of a case file, e.g. wheeltap " + command.get_name() + " case.json";
    return what;
  }
  return {};
}

}  // namespace wheeltap::apps
