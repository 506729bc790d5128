// What a command of the program is. command_list.cpp names all of them; the command line, its help,
// the manual page, completion, `batch`, `serve`, `schema` and Python read that list.
#pragma once

#include <functional>
#include <string>

#include "apps/commands/program_text.hpp"
#include "apps/run_options.hpp"
#include "apps/runs/case_run.hpp"

namespace wheeltap::apps {

class CommandOptions;

/// What was asked for on the command line.
struct Invocation {
  CommonOptions common = {};
  SamplingOptions sampling = {};
  bool as_json = false;   ///< --json of a command that writes results
  std::string simd = {};  ///< --simd, obeyed before the command line is read (main.cpp)
  std::function<ProgramText()> describe = {};  ///< every command with its options
};

struct Command {
  std::string name;
  std::string summary;         ///< one line for --help
  bool on_all_ranks = false;   ///< under mpirun its work is divided; other commands run on rank 0
  std::string case_kind = {};  ///< the kind of case that it runs; empty: none
  MakeCaseRun make_run = {};   ///< of a case of that kind; none where it is not sampled
  /// Adds arguments and options. What they set lies in the Invocation or in a value shared with
  /// `run`.
  std::function<void(CommandOptions&)> add_options = {};
  /// Throws Failure or io::FileError where it cannot do its work.
  std::function<void(const Invocation&)> run = {};
};

}  // namespace wheeltap::apps
