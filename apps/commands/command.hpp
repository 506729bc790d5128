// A command of the program. The list in command_list.cpp defines the command line, its help, the
// manual page, completion, `batch`, `serve`, `schema` and the Python interface.
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
  bool as_json = false;   ///< --json of a command that writes results
  std::string simd = {};  ///< --simd; main.cpp applies it before the command line is parsed
  std::function<ProgramText()> describe = {};  ///< every command with its options
};

struct Command {
  std::string name;
  std::string summary;         ///< one line for --help
  bool on_all_ranks = false;   ///< mpirun divides its work; other commands run on rank 0
  std::string case_kind = {};  ///< kind of case that it runs; empty: none
  MakeCaseRun make_run = {};   ///< makes a run of such a case; empty if the kind is not sampled
  /// Checks such a case where the kind is not sampled: reads its data, runs nothing. Throws Failure.
  std::function<void(CaseFile)> check = {};
  /// Adds arguments and options. They set members of the Invocation, or a value shared with `run`.
  std::function<void(CommandOptions&)> add_options = {};
  /// Runs the command. Throws Failure, io::FileError.
  std::function<void(const Invocation&)> run = {};
};

}  // namespace wheeltap::apps
