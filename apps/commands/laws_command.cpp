#include <algorithm>
#include <iostream>

#include "apps/commands/command_list.hpp"
#include "apps/commands/command_options.hpp"
#include "apps/failure.hpp"
#include "apps/nearest.hpp"
#include "apps/report/law_figure.hpp"
#include "apps/report/law_page.hpp"
#include "apps/runs/running.hpp"

namespace wheeltap::apps {

using dynamics::LawInfo;

namespace {

struct LawsOptions {
  std::string name;               ///< name of one law; empty: all
  bool example = false;           ///< print only the example case, as JSON
  std::filesystem::path figures;  ///< folder for the figures of the force laws; empty: no figures
};

/// Prints the page of force laws, the section of one force law, or its example.
void run_laws(const LawsOptions& options) {
  const auto infos = dynamics::law_infos();
  const auto found = std::ranges::find(infos, options.name, &LawInfo::name);
  if (!options.name.empty() && found == infos.end()) {
    std::vector<std::string> names;
    std::string list;
    for (const LawInfo& info : infos) {
      names.emplace_back(info.name);
      list += (list.empty() ? "" : ", ") + names.back();
    }
    std::string meant = nearest(options.name, names);
    for (const LawInfo& info : infos)  // "stop" is a form of the force law "contact"
      if (meant.empty() && info.description.find(options.name) != std::string_view::npos)
        meant = info.name;
    throw Failure(Exit::usage, "no force law has the name \"" + options.name + "\"" +
                                   (meant.empty() ? "" : "; did you mean \"" + meant + "\"?") +
                                   " (there are: " + list + ")");
  }
  if (options.example && options.name.empty()) {
    throw Failure(Exit::usage, "--example needs the name of a law (see wheeltap laws)");
  }
  if (!options.figures.empty()) {
    make_output_folder(options.figures);
    for (const LawInfo& info : infos) {
      write_text(options.figures / law_figure_name(info), law_figure(info));
    }
  }
  if (options.example) {
    std::cout << law_example(*found);
  } else {
    std::cout << (options.name.empty() ? laws_page() : law_section(*found));
  }
}

}  // namespace

Command laws_command() {
  const auto laws = std::make_shared<LawsOptions>();
  return {.name = "laws",
          .summary = "describe the force laws of links: formula, sign, keys, an example",
          .add_options =
              [laws](CommandOptions& options) {
                CLI::App& app = options.app();
                app.add_option("NAME", laws->name, "name of a force law (default: all force laws)");
                app.add_flag("--example", laws->example,
                             "print only an example case with the force law NAME");
                app.add_option(
                    "--figures", laws->figures,
                    "folder for the SVG figures of the force laws (default: none are written)");
              },
          .run = [laws](const Invocation&) { run_laws(*laws); }};
}

}  // namespace wheeltap::apps
