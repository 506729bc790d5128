#include "apps/cli/run_program.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <iostream>
#include <stdexcept>

#include "apps/cli/command_line_faults.hpp"
#include "apps/cli/json_output.hpp"
#include "apps/commands/command_options.hpp"
#include "apps/runs/failure_of.hpp"
#include "apps/runs/several_ranks.hpp"
#include "io/date_of_files.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {
namespace {

std::string& last_words() {
  static std::string words;
  return words;
}

int report(Exit exit, const std::string& line) {
  // Names, keys and values of the user must not contain line breaks.
  std::string words = io::printable(line);
  // The text that the user typed may be long: keep the beginning and the end of the line.
  constexpr std::size_t kLongest = 1000;
  if (exit == Exit::usage && words.size() > kLongest)
    words.replace(kLongest / 2, words.size() - kLongest, " ... ");
  words = io::printable(words);  // the cut may have split a character
  std::cerr << "wheeltap: " << words << '\n';
  last_words() = words;
  return static_cast<int>(exit);
}

// Flushes standard output; reports an error if the disk is full.
int printed() {
  std::cout.flush();
  if (!std::cout) return report(Exit::cannot_create, "standard output cannot be written");
  return static_cast<int>(Exit::done);
}

std::string command_line_of(int argc, char** argv) {
  std::string line = "wheeltap";
  for (int i = 1; i < argc; ++i) {
    const std::string word = io::printable(argv[i]);
    const bool plain =
        !word.empty() && word.find_first_of(" '\"{}[]$*?&|;<>()\\") == std::string::npos;
    line += " " + (plain ? word : "'" + word + "'");
  }
  return line;
}

// Check the date before the run produces results.
void check_date_of_files() {
  try {
    (void)io::date_of_files();
  } catch (const std::invalid_argument& error) {
    throw Failure(Exit::usage, error.what());
  }
}

// The texts of --help, as input of shell completion and of the manual page.
ProgramText text_of(const CLI::App& app) {
  ProgramText program{.name = "wheeltap",
                      .version = WHEELTAP_VERSION,
                      .description = app.get_description(),
                      .commands = {}};
  for (const CLI::App* command : app.get_subcommands({})) {
    program.commands.push_back(
        {.name = command->get_name(), .description = command->get_description(), .options = {}});
    for (const CLI::Option* option : command->get_options()) {
      OptionText text{.names = {}, .description = option->get_description(), .value = {}};
      text.is_argument = option->get_positional();
      if (text.is_argument) text.names.push_back(option->get_name());
      for (const std::string& name : option->get_snames()) text.names.push_back("-" + name);
      for (const std::string& name : option->get_lnames()) text.names.push_back("--" + name);
      if (option->get_items_expected_max() > 0) text.value = option->get_type_name();
      program.commands.back().options.push_back(std::move(text));
    }
  }
  return program;
}

/// Adds every command of the list to `app`.
void add_commands(const std::vector<Command>& commands, CLI::App& app, Invocation& invocation) {
  for (const Command& command : commands) {
    CommandOptions options(*app.add_subcommand(command.name, command.summary), invocation);
    command.add_options(options);
  }
}

const Command& chosen_command(const std::vector<Command>& commands, const CLI::App& app) {
  return *std::ranges::find(commands, app.get_subcommands().front()->get_name(), &Command::name);
}

/// Message for an invalid command line, with a reference to --help.
std::string parse_fault(const CLI::App& app, const CLI::ParseError& error, int argc, char** argv) {
  const auto chosen = app.get_subcommands();
  std::string what = error.what();
  if (argc == 1)
    what = "a command is missing; to begin, write a starter case: wheeltap init damage -o my-beam";
  if (chosen.empty() && argc > 1 && argv[1][0] != '-') what = unknown_command(app, argv[1]);
  if (!chosen.empty()) {
    const CLI::App& command = *chosen.front();
    if (const std::string words = unexpected_words(app, command); !words.empty()) {
      what = words;
    } else if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr) {
      what = missing_option(command).value_or(what);
    }
  }
  // The number of threads may come from the environment variable.
  const bool typed = std::any_of(argv + 1, argv + argc, [](const char* word) {
    return std::string_view(word).starts_with("--threads");
  });
  if (const std::string option = "--threads: "; what.starts_with(option) && !typed)
    what.replace(0, option.size(), std::string(kThreadsVariable) + ": ");
  std::ranges::replace(what, '\n', ' ');
  return what + " (see wheeltap " + (chosen.empty() ? "" : chosen.front()->get_name() + " ") +
         "--help)";
}

/// True if this rank has work: under mpirun, ranks other than the first run only the commands that
/// use all ranks.
bool divide_among_ranks(const Command& command, CommonOptions& common) {
  if (base::ranks() == nullptr) return true;
  if (common.threads == 0) common.threads = 1;
  if (command.on_all_ranks) return true;
  if (!base::is_first_rank()) return false;
  base::ranks() = nullptr;
  return true;
}

int run(const std::vector<Command>& commands, int argc, char** argv) {
  // If a file exceeds the size limit, report a write error instead of ending by a signal.
  std::signal(SIGXFSZ, SIG_IGN);
  // Disable the file locks of HDF5: Wheeltap locks its files, and some file systems have no locks.
  ::setenv("HDF5_USE_FILE_LOCKING", "FALSE", 0);
  CLI::App app{
      "Structural health monitoring: number, positions and severities of damages, with calibrated "
      "probabilities"};
  app.set_version_flag("--version", std::string("wheeltap ") + WHEELTAP_VERSION);
  app.require_subcommand(1);
  app.get_formatter()->column_width(34);
  Invocation asked;
  asked.common.command_line = command_line_of(argc, argv);
  asked.describe = [&app] { return text_of(app); };
  add_commands(commands, app, asked);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    app.exit(success);
    return printed();
  } catch (const CLI::ParseError& error) {
    return report(Exit::usage, parse_fault(app, error, argc, argv));
  }

  const Command& command = chosen_command(commands, app);
  const CLI::App& line = *app.get_subcommands().front();
  if (!divide_among_ranks(command, asked.common)) return static_cast<int>(Exit::done);
  JsonOutput json(asked.as_json, asked.common);
  try {
    check_date_of_files();
    if (base::ranks() != nullptr) require_equal_processors();
    const bool may_only_estimate = line.get_option_no_throw("--dry-run") != nullptr;
    if (may_only_estimate && asked.common.output.empty() && !asked.common.dry_run)
      throw Failure(Exit::usage,
                    output_is_missing(line) + " (see wheeltap " + command.name + " --help)");
    command.run(asked);
    json.print();
    return printed();
  } catch (const FailedOnFirstRank&) {
    return static_cast<int>(
        Exit::done);  // the first rank reports the failure and returns its exit code
  } catch (const std::exception&) {
    json.print_partial();
    const Failure failure = failure_of(std::current_exception(), asked.common.case_path);
    return report(failure.exit(), failure.what());
  }
}

}  // namespace

int run_program(const std::vector<Command>& commands, int argc, char** argv) {
  try {
    JoinedRanks joined;
    const int code = run(commands, argc, argv);
    joined.leave(code, last_words());
    return code;
  } catch (const Failure& failure) {
    return report(failure.exit(), failure.what());
  }
}

}  // namespace wheeltap::apps
