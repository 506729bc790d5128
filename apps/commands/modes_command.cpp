#include <iostream>

#include "apps/commands/command_list.hpp"
#include "apps/commands/command_options.hpp"
#include "apps/runs/found_modes.hpp"
#include "apps/structure_words.hpp"

namespace wheeltap::apps {
namespace {

void run_modes(const CommonOptions& common, const ModesOptions& options) {
  if (options.shapes && !options.json)
    throw Failure(Exit::usage,
                  "modes: --shapes needs --json: only this output has mode shapes; add --json");
  const FoundModes found = find_modes(read_case(common.case_path, common.overrides), options);
  warn_of(found.doubts);
  std::cout << (options.json ? found.report.dump() + "\n" : found.text);
}

}  // namespace

Command modes_command() {
  const auto modes = std::make_shared<ModesOptions>();
  return {
      .name = "modes",
      .summary = "compute natural frequencies of the case's beam or structure",
      .add_options =
          [modes](CommandOptions& options) {
            options.add_case();
            CLI::App& app = options.app();
            app.add_option("--modes", modes->modes, "number of modes, including rigid-body modes")
                ->transform(whole(1, kMany));
            app.add_flag("--truth", modes->truth, "include the damages of the key damage.truth");
            app.add_flag("--json", modes->json, "print the modes as JSON");
            app.add_flag("--shapes", modes->shapes, "also print the mode shapes; needs --json");
            app.add_option("--vtk", modes->vtk,
                           "VTK file for the structure and its mode shapes, to open in ParaView");
          },
      .run = [modes](const Invocation& asked) { run_modes(asked.common, *modes); }};
}

}  // namespace wheeltap::apps
