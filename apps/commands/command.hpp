// A command of the program. The list of commands in command_list.cpp defines the command line, the
// help, the manual page, completion, `batch`, `serve`, `schema` and the Python interface.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "apps/cases/syntax/case_file.hpp"
#include "apps/commands/program_text.hpp"
#include "apps/run_options.hpp"

namespace wheeltap::apps {

class CaseRun;
class CommandOptions;

/// Parses a case of one kind. Throws Failure.
using MakeCaseRun =
    std::function<std::unique_ptr<CaseRun>(CaseFile, const CommonOptions&, const SamplingOptions&)>;

/// The options of the command line.
struct Invocation {
  CommonOptions common = {};
  SamplingOptions sampling = {};
  bool as_json = false;  ///< true with --json, for a command that writes results
  /// Value of --simd, which main.cpp applies before the command line is parsed
  std::string simd = {};
  std::function<ProgramText()> describe = {};  ///< describes every command with its options
};

struct Command {
  std::string name;
  std::string summary;  ///< description of the command, one line for --help
  /// True if MPI ranks divide the work of the command; other commands run on rank 0 only
  bool on_all_ranks = false;
  std::string case_kind = {};  ///< kind of the cases that the command runs; empty: it runs no case
  /// Key that the cases of the command must have; if empty, a case must have none of the keys of
  /// other commands
  std::string case_key = {};
  /// Creates a run of a case of this kind; empty if the command does not sample a posterior
  MakeCaseRun make_run = {};
  /// For kinds without `make_run`: checks a case and reads its data, without a run. Throws Failure.
  std::function<void(CaseFile)> check = {};
  /// Adds arguments and options to the command. Each option sets a member of the Invocation, or a
  /// variable that `run` reads.
  std::function<void(CommandOptions&)> add_options = {};
  /// Runs the command. Throws Failure, io::FileError.
  std::function<void(const Invocation&)> run = {};
};

}  // namespace wheeltap::apps
