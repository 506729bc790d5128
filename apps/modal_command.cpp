#include "apps/modal_command.hpp"

#include <chrono>
#include <iostream>
#include <numbers>
#include <stdexcept>

#include "apps/modal_case.hpp"
#include "apps/modal_page.hpp"
#include "apps/modal_words.hpp"
#include "apps/running.hpp"
#include "apps/summary.hpp"
#include "apps/terminal.hpp"
#include "io/text.hpp"

namespace wheeltap::apps {
namespace {

using signals::ModalResult;
using signals::Mode;

/// Channels are numbered by the library from 0; here they have names.
ModalResult identify(const ModalCaseFile& modal) {
  try {
    return signals::identify_modes(modal.records, modal.options);
  } catch (const std::invalid_argument& error) {
    const std::string what = error.what();
    for (std::size_t i = 0; i < modal.sensors.size(); ++i) {
      const std::string numbered = "channel = " + std::to_string(i) + ".";
      if (!what.starts_with(numbered)) continue;
      const std::size_t colon = what.find(": ");
      std::string rest = what.substr(colon + 2);
      for (std::size_t j = 0; j < modal.sensors.size(); ++j)
        if (const std::string other = "as channel " + std::to_string(j) + " ";
            rest.find(other) != std::string::npos)
          rest.replace(rest.find(other), other.size(), "as " + modal.sensors[j].name + " ");
      modal.file.refuse(modal.places[i], rest);
    }
    modal.file.refuse(Pointer("/record"), what);
  }
}

Report mode_json(const Mode& m) {
  return {{"frequency_hz", m.pole.frequency_hz},
          {"frequency_sd", finite(m.pole.frequency_sd)},
          {"damping", m.pole.damping},
          {"damping_sd", finite(m.pole.damping_sd)},
          {"collinearity", m.collinearity},
          {"phase_deviation", m.phase_deviation},
          {"amplitude_kurtosis", m.amplitude_kurtosis},
          {"order", m.pole.order},
          {"orders", {{"present", m.present}, {"possible", m.orders}}},
          {"doubts", doubts_in_words(m)}};
}

}  // namespace

Report ModalRun::summary(const CommonOptions& common) const {
  Report found = Report::array(), poles = Report::array();
  for (const Mode& m : result.modes) found.push_back(mode_json(m));
  for (const signals::Pole& p : result.diagram.poles)
    poles.push_back(
        {p.order, p.frequency_hz, p.damping, finite(p.frequency_sd), finite(p.damping_sd)});
  std::vector<std::string> said = warnings(result);
  said.insert(said.end(), modal.oddities.begin(), modal.oddities.end());
  return {{"wheeltap",
           about("modal", {.seed = common.seed.value_or(1), .command_line = common.command_line},
                 modal.file)},
          {"modes", found},
          {"procedure",
           {{"method", "ssi-cov"},
            {"band", {result.lowest_hz, result.highest_hz}},
            {"sample_rate_hz", result.sample_rate_hz},
            {"decimated", result.decimated},
            {"lags", result.lags},
            {"blocks", result.blocks},
            {"block_seconds", result.block_seconds},
            {"largest_order", result.largest_order},
            {"distance_threshold", result.diagram.threshold},
            {"references", result.references}}},
          {"stabilisation",
           {{"columns", {"order", "frequency_hz", "damping", "frequency_sd", "damping_sd"}},
            {"poles", poles}}},
          {"diagnostics", {{"warnings", said}}},
          {"cost", {{"wall_seconds", seconds}}}};
}

void ModalRun::print(std::ostream& out, bool colour) const {
  const Page page(out, colour);
  out << page.bold(io::printable(modal.title)) << "\n\n";
  if (!result.modes.empty()) {
    std::vector<std::vector<std::string>> rows = {
        {"mode", "f [Hz]", "damping [%]", "MPC", "orders", ""}};
    for (const Mode& m : result.modes)
      rows.push_back(
          {std::to_string(rows.size()), with_sd(m.pole.frequency_hz, m.pole.frequency_sd),
           with_sd(100.0 * m.pole.damping, 100.0 * m.pole.damping_sd), fixed(m.collinearity, 3),
           std::to_string(m.present) + " of " + std::to_string(m.orders),
           m.doubts.empty() ? "" : "doubtful"});
    page.table(rows);
    out << "± is one standard deviation.\n";
  }
  int number = 0;
  for (const Mode& m : result.modes) {
    ++number;
    const std::vector<std::string> why = doubts_in_words(m);
    if (why.empty()) continue;
    std::string text = "Mode " + std::to_string(number) + " is doubtful: ";
    for (std::size_t i = 0; i < why.size(); ++i) text += (i > 0 ? "; " : "") + why[i];
    page.wrapped(text + ".", "! ", "  ");
  }
  for (const std::string& text : warnings(result)) page.wrapped(text, "! ", "  ");
  for (const std::string& text : modal.oddities) page.wrapped(io::printable(text), "! ", "  ");
  out << "\n";
  for (const std::string& text : procedure_in_words(result)) page.wrapped(text, "", "");
}

void ModalRun::keep(const std::filesystem::path& folder, const CommonOptions& common) const {
  make_output_folder(folder);
  write_text(folder / "modes.json", modes_json(modes).dump(1) + "\n");
  write_text(folder / "report.html", modal_page(modal, result));
  write_text(folder / "summary.json", summary(common).dump(1) + "\n");
}

ModalRun identify_modal(CaseFile file, const CommonOptions& common,
                        std::optional<signals::Record> given) {
  const auto begun = std::chrono::steady_clock::now();
  ModalRun run{
      .modal = parse_modal_case(std::move(file), std::move(given)), .result = {}, .modes = {}};
  run.modal.options.threads = common.threads;
  run.result = identify(run.modal);
  run.modes = measured_modes(run.result, run.modal.sensors);
  run.modes.title = run.modal.title;
  run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  return run;
}

void run_modal(const CommonOptions& common) {
  CaseFile file = read_case(common.case_path, common.overrides);
  if (common.dry_run) {
    const ModalCaseFile modal = parse_modal_case(std::move(file));
    std::cout << modal.sensors.size() << " responses of " << base::grouped(modal.records.cols())
              << " samples at " << significant(modal.options.sample_rate_hz, 6)
              << " Hz: seconds, and "
              << significant(4.0 * 8e-6 * static_cast<double>(modal.records.size()) + 200.0, 2)
              << " MB\n";
    return;
  }
  make_output_folder(common.output);
  const ModalRun run = identify_modal(std::move(file), common);
  run.keep(common.output, common);
  run.print(std::cout, colour_wanted());
  std::cout << "\nModes: " << io::printable((common.output / "modes.json").string())
            << "\nDrawn: " << io::printable((common.output / "report.html").string()) << "\n";
}

}  // namespace wheeltap::apps
