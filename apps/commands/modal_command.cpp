#include "apps/commands/modal_command.hpp"

#include <chrono>
#include <iostream>
#include <stdexcept>

#include "apps/cases/modal_case.hpp"
#include "apps/commands/command_list.hpp"
#include "apps/commands/command_options.hpp"
#include "apps/report/modal_page.hpp"
#include "apps/results/modal_summary.hpp"
#include "apps/results/stored_run.hpp"
#include "apps/results/summary.hpp"
#include "apps/results/terminal.hpp"
#include "apps/runs/run_cost.hpp"
#include "apps/runs/running.hpp"
#include "apps/text/modal_words.hpp"
#include "identification/modal/modal_cost.hpp"
#include "io/atomic_file.hpp"
#include "io/text/text.hpp"
#include "signals/modal/shape_quantities.hpp"
#include "signals/refuse.hpp"

namespace wheeltap::apps {
namespace {

using signals::ModalResult;
using signals::Mode;

/// Identifies modes. In error messages, channel names replace the channel indices of the library.
ModalResult identify_modes_of(const CaseFile& file, const SetUp& set_up, std::uint64_t seed) {
  try {
    return identification::identify(set_up, seed);
  } catch (const signals::ChannelError& error) {
    const auto name = [&](long channel) {
      return set_up.sensors[static_cast<std::size_t>(channel)].name;
    };
    file.refuse(set_up.places[static_cast<std::size_t>(error.channel)],
                error.original ? "equals " + name(*error.original) +
                                     " except for its scale: omit one of the two"
                               : error.reason);
  } catch (const signals::ChosenPoleError& error) {
    file.refuse(Pointer("/poles") / static_cast<std::size_t>(error.pole), error.what());
  } catch (const std::invalid_argument& error) {
    file.refuse(set_up.where, error.what());
  }
}

/// Identifies pre-merged set-ups.
ModalResult identify_together(const ModalCaseFile& modal) {
  std::vector<Eigen::MatrixXd> records;
  std::vector<std::vector<int>> sensors;
  for (const SetUp& s : modal.set_ups) {
    records.push_back(s.records);
    sensors.push_back(s.which);
  }
  try {
    return signals::identify_set_ups(records, sensors, modal.references,
                                     static_cast<int>(modal.sensors.size()),
                                     modal.set_ups.front().options);
  } catch (const signals::ChosenPoleError& error) {
    modal.file.refuse(Pointer("/poles") / static_cast<std::size_t>(error.pole), error.what());
  } catch (const std::invalid_argument& error) {
    modal.file.refuse(Pointer("/records"), error.what());
  }
}

IdentifiedModes identify_modes_of(const ModalCaseFile& modal, const CommonOptions& common) {
  IdentifiedModes out;
  if (modal.pre_merged) {
    out.set_ups.push_back(identify_together(modal));
    std::vector<int> orders(modal.sensors.size(), 0);
    for (const SetUp& s : modal.set_ups)
      for (std::size_t c = 0; c < s.orders.size(); ++c)
        orders[static_cast<std::size_t>(s.which[c])] = s.orders[c];
    if (!modal.quantity.empty()) signals::convert_shapes(out.set_ups.back(), orders);
    return out;
  }
  ProgressBar bar(common.quiet || modal.set_ups.size() == 1);
  std::vector<signals::SetUpModes> pieces;
  for (const SetUp& set_up : modal.set_ups) {
    bar.show("set-ups",
             static_cast<double>(pieces.size()) / static_cast<double>(modal.set_ups.size()),
             io::printable(set_up.name));
    out.set_ups.push_back(identify_modes_of(modal.file, set_up, common.seed.value_or(1)));
    pieces.push_back({.modes = out.set_ups.back().modes,
                      .covariance = out.set_ups.back().covariance,
                      .sensors = set_up.which,
                      .covariance_samples = out.set_ups.back().covariance_samples()});
  }
  bar.clear();
  if (pieces.size() > 1)
    out.merged = signals::merge_modes(pieces, static_cast<int>(modal.sensors.size()));
  return out;
}

template <class AnyMode>
void print_doubts(const Page& page, const std::vector<AnyMode>& modes) {
  int number = 0;
  for (const AnyMode& m : modes) {
    ++number;
    const std::vector<std::string> why = doubts_in_words(m);
    if (why.empty()) continue;
    std::string text = "Mode " + std::to_string(number) + " is doubtful: ";
    for (std::size_t i = 0; i < why.size(); ++i) text += (i > 0 ? "; " : "") + why[i];
    page.wrapped(text + ".", "! ", "  ");
  }
}

void print_table(const Page& page, const std::vector<Mode>& modes) {
  std::vector<std::vector<std::string>> rows = {
      {"mode", "f [Hz]", "damping [%]", "MPC", "orders", ""}};
  for (const Mode& m : modes)
    rows.push_back({std::to_string(rows.size()), with_sd(m.pole.frequency_hz, m.pole.frequency_sd),
                    with_sd(100.0 * m.pole.damping, 100.0 * m.pole.damping_sd),
                    fixed(m.collinearity, 3), orders_in_words(m.present, m.orders),
                    m.doubts.empty() ? "" : "doubtful"});
  page.table(rows);
}

void print_table(const Page& page, const std::vector<signals::MergedMode>& modes) {
  std::vector<std::vector<std::string>> rows = {
      {"mode", "f [Hz]", "damping [%]", "MPC", "set-ups", ""}};
  for (const signals::MergedMode& m : modes)
    rows.push_back({std::to_string(rows.size()), with_sd(m.frequency_hz, m.frequency_sd),
                    with_sd(100.0 * m.damping, 100.0 * m.damping_sd), fixed(m.collinearity, 3),
                    std::to_string(m.found()) + " of " + std::to_string(m.places.size()),
                    m.doubts.empty() ? "" : "doubtful"});
  page.table(rows);
}

}  // namespace

Report ModalRun::summary(const CommonOptions& common) const {
  Report out = {
      {"wheeltap",
       about("modal", {.seed = common.seed.value_or(1), .command_line = common.command_line},
             modal.file)}};
  out.update(modal_summary(modal, found));
  out["cost"] = {{"wall_seconds", seconds}};
  return out;
}

void ModalRun::print(std::ostream& out, bool colour) const {
  const Page page(out, colour);
  out << page.bold(io::printable(modal.title)) << "\n\n";
  const auto print_modes = [&](const auto& list) {
    if (list.empty()) return;
    print_table(page, list);
    if (modes.covariance.size() > 0) out << "± is one standard deviation.\n";
    print_doubts(page, list);
  };
  if (found.merged) {
    print_modes(found.merged->modes);
  } else {
    print_modes(found.set_ups[0].modes);
  }
  for (const std::string& text : cautions(modal, found))
    page.wrapped(io::printable(text), "! ", "  ");
  out << "\n";
  if (found.merged) {
    page.wrapped(merging_in_words(*found.merged, found.set_ups.size()), "", "");
  } else {
    for (const std::string& text : procedure_in_words(found.set_ups[0])) page.wrapped(text, "", "");
  }
  for (const SetUp& set_up : modal.set_ups)
    for (const std::string& text : record_in_words(set_up))
      page.wrapped(
          (modal.set_ups.size() > 1 ? io::printable(set_up.name) + ": " : "") + io::printable(text),
          "", "");
}

void ModalRun::keep(const std::filesystem::path& folder, const CommonOptions& common) const {
  claim_output_folder(folder);
  io::finish_commit(folder);
  Report kept = summary(common);
  const std::string text = modes_json(modes).dump(1) + "\n";
  const std::string page = modal_page(kept, modes);
  kept["files"]["modes.json"] = seal(text);
  io::AtomicFile identified(folder / "modes.json"), poles(folder / "poles.json"),
      report(folder / "report.html"), whole(folder / "summary.json");
  identified.write(text);
  poles.write(poles_with_shapes(modal, found).dump() + "\n");
  report.write(page);
  whole.write(kept.dump(1) + "\n");
  io::AtomicFile* const files[] = {&identified, &poles, &report, &whole};
  io::commit_together(files);
}

ModalRun identify_modal(CaseFile file, const CommonOptions& common,
                        std::optional<signals::Record> given) {
  const auto begun = std::chrono::steady_clock::now();
  ModalRun run{
      .modal = parse_modal_case(std::move(file), std::move(given)), .found = {}, .modes = {}};
  for (SetUp& set_up : run.modal.set_ups) set_up.options.threads = common.threads;
  run.found = identify_modes_of(run.modal, common);
  run.modes = run.found.merged ? measured_modes(*run.found.merged, run.modal.sensors)
                               : measured_modes(run.found.set_ups[0], run.modal.sensors);
  run.modes.title = run.modal.title;
  run.modes.quantity = run.modal.quantity;
  run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  return run;
}

void run_modal(const CommonOptions& common) {
  CaseFile file = read_case(common.case_path, common.overrides);
  if (common.dry_run) {
    const ModalCaseFile modal = parse_modal_case(std::move(file));
    double numbers = 0.0;
    for (const SetUp& set_up : modal.set_ups) {
      numbers += static_cast<double>(set_up.records.size());
      if (common.quiet) continue;
      std::cout << (modal.set_ups.size() > 1 ? io::printable(set_up.name) + ": " : "")
                << set_up.sensors.size() << " responses of ";
      if (set_up.responses) {
        std::cout << set_up.inputs.size() << " inputs at "
                  << base::grouped(set_up.responses->lines()) << " frequencies\n";
      } else {
        std::cout << base::grouped(set_up.records.cols()) << " samples at "
                  << significant(set_up.options.sample_rate_hz, 6) << " Hz\n";
      }
    }
    return common.dry_run("identification", identification::cost_of_modes(numbers));
  }
  claim_output_folder(common.output);
  const ModalRun run = identify_modal(std::move(file), common);
  run.keep(common.output, common);
  run.print(std::cout, colour_wanted());
  std::cout << "\nModes: " << io::printable((common.output / "modes.json").string())
            << "\nDrawn: " << io::printable((common.output / "report.html").string()) << "\n";
}

Command modal_command() {
  return {.name = "modal",
          .summary = "identify modes with their uncertainty from vibration records",
          .case_kind = "modal",
          .check = [](CaseFile file) { static_cast<void>(parse_modal_case(std::move(file))); },
          .add_options =
              [](CommandOptions& options) {
                options.add_case();
                options.add_output(
                    "FOLDER",
                    "folder of the results: modes.json, poles.json, summary.json and report.html");
                options.add_json(kSummary);
                options.add_threads();
                options.add_dry_run();
              },
          .run = [](const Invocation& asked) { run_modal(asked.common); }};
}

}  // namespace wheeltap::apps
