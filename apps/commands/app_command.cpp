#include <algorithm>
#include <iostream>
#include <memory>
#include <thread>

#include "apps/application/app_server.hpp"
#include "apps/cases/syntax/case_text.hpp"
#include "apps/commands/command_list.hpp"
#include "apps/commands/command_options.hpp"
#include "apps/commands/init_command.hpp"
#include "apps/runs/case_run.hpp"
#include "apps/runs/running.hpp"
#include "base/parallel.hpp"
#include "io/file_error.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {
namespace {

namespace fs = std::filesystem;

struct AppFlags {
  fs::path folder = ".";
  int port = 0, at_once = 1;
};

/// Parses the case in the same way as its command does before a run. Throws Failure, io::FileError.
void parse_as_command(CaseFile file) {
  const Command* command = command_of_kind(file);
  if (command == nullptr) file.refuse(Pointer("/kind"), "must be one of " + listed(case_kinds()));
  if (command->check) return command->check(std::move(file));
  if (!command->make_run) return validate_against_schema(file, command->case_kind);
  CommonOptions common;
  common.case_path = file.path;
  static_cast<void>(command->make_run(std::move(file), common, {})->estimate());
}

/// Calls `use` for every string in the case, with its location.
void each_text(const Json& json, const Pointer& where,
               const std::function<void(const Pointer&, const std::string&)>& use) {
  if (json.is_string()) use(where, json.get_ref<const std::string&>());
  if (json.is_array())
    for (std::size_t i = 0; i < json.size(); ++i) each_text(json[i], where / i, use);
  if (json.is_object())
    for (const auto& [key, value] : json.items()) each_text(value, where / key, use);
}

std::optional<CasePlace> fault_of(const fs::path& path, const std::string& text,
                                  const std::function<bool(const fs::path&)>& allowed) {
  try {
    CaseFile file = parse_case(path, text);
    // Any string may name an input file. Files outside the folder must not be read.
    each_text(file.json, Pointer(), [&](const Pointer& where, const std::string& name) {
      std::error_code error;
      const fs::path named = file.place_of(name);
      if (!name.empty() && fs::is_regular_file(named, error) && !allowed(named))
        file.refuse(
            where,
            "is a file outside the folder of the application: copy the file into this folder, or "
            "start wheeltap app with a folder that contains both");
    });
    parse_as_command(std::move(file));
    return {};
  } catch (const Failure& failure) {
    if (failure.place()) return failure.place();
    return CasePlace{.pointer = "/", .reason = failure.what()};
  } catch (const io::FileError& error) {
    return CasePlace{.pointer = "/", .reason = error.what()};
  }
}

AppProgram program() {
  AppProgram out{.kinds = case_kinds(), .sampled = case_kinds(true), .check = fault_of};
  for (const auto& [kind, structure] : starter_cases())
    out.starters.push_back({.kind = kind, .structure = structure});
  out.command = [](const std::string& text) {
    const Command* command = command_of_kind(parse_case({}, text));
    return command == nullptr ? std::string() : command->name;
  };
  out.start = [](const StarterCase& starter, const fs::path& folder) {
    return write_starter(starter.kind, starter.structure, folder).front();
  };
  return out;
}

void run_app(const CommonOptions& common, const AppFlags& flags) {
  const AppProgram parts = program();
  const StopOnInterrupt stop;
  serve_application(
      parts, {.folder = flags.folder,
              .port = flags.port,
              .at_once = flags.at_once,
              .threads = std::max(1, base::thread_count(common.threads) / flags.at_once),
              .ready =
                  [&](const std::string& address) {
                    std::cout << "Open this URL in a browser (Ctrl-C ends the application):\n  "
                              << address << std::endl;
                  },
              .stop = was_interrupted});
}

}  // namespace

Command app_command() {
  const auto flags = std::make_shared<AppFlags>();
  return {.name = "app",
          .summary = "start the interactive application in the browser, for the cases of a folder",
          .add_options =
              [flags](CommandOptions& options) {
                CLI::App& app = options.app();
                app.add_option(
                    "FOLDER", flags->folder,
                    "folder of cases, records and results (default: the current folder)");
                app.add_option("--port", flags->port,
                               "TCP port of the application (default or 0: any free port)")
                    ->transform(whole(0, 65535));
                app.add_option(
                       "--runs", flags->at_once,
                       "largest number of simultaneous runs, which share the threads (default 1)")
                    ->transform(whole(1, 64));
                options.add_threads();
              },
          .run = [flags](const Invocation& asked) { run_app(asked.common, *flags); }};
}

}  // namespace wheeltap::apps
