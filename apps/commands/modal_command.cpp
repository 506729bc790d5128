#include "apps/commands/modal_command.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <numbers>
#include <stdexcept>

#include "apps/cases/modal_case.hpp"
#include "apps/cases/records/record_reading.hpp"
#include "apps/commands/command_list.hpp"
#include "apps/commands/command_options.hpp"
#include "apps/report/modal_page.hpp"
#include "apps/results/stored_run.hpp"
#include "apps/results/summary.hpp"
#include "apps/results/terminal.hpp"
#include "apps/runs/run_cost.hpp"
#include "apps/runs/running.hpp"
#include "apps/text/modal_words.hpp"
#include "identification/modal/modal_cost.hpp"
#include "io/atomic_file.hpp"
#include "io/text/text.hpp"
#include "signals/modal/free_decay.hpp"
#include "signals/modal/frequency_domain_decomposition.hpp"
#include "signals/modal/polyreference.hpp"
#include "signals/modal/shape_quantities.hpp"
#include "signals/spectra.hpp"

namespace wheeltap::apps {
namespace {

using signals::ModalResult;
using signals::Mode;

/// Channels are numbered by the library from 0; here they have names.
ModalResult identify_modes_of(const CaseFile& file, const SetUp& set_up, std::uint64_t seed) {
  try {
    if (set_up.responses)
      return signals::identify_modes(*set_up.responses,
                                     {.lowest_hz = set_up.options.lowest_hz,
                                      .highest_hz = set_up.options.highest_hz,
                                      .largest_order = set_up.options.largest_order,
                                      .seed = seed,
                                      .threads = set_up.options.threads});
    if (!set_up.bands.empty())
      return identification::identify_bands(set_up.records, set_up.options.sample_rate_hz,
                                            set_up.bands,
                                            {.seed = seed, .threads = set_up.options.threads});
    if (set_up.spectral)
      return signals::decompose_spectra(
          set_up.records, {.sample_rate_hz = set_up.options.sample_rate_hz,
                           .lowest_hz = set_up.options.lowest_hz,
                           .highest_hz = set_up.options.highest_hz,
                           .segment = file.json.value("segment", 0),
                           .enhanced = set_up.spectral == signals::ModalMethod::enhanced,
                           .blocks = set_up.options.blocks,
                           .threads = set_up.options.threads});
    if (!set_up.decays.empty())
      return signals::identify_decays(set_up.decays, set_up.options, seed);
    return signals::identify_modes(set_up.records, set_up.options);
  } catch (const std::invalid_argument& error) {
    const std::string what = error.what();
    for (std::size_t i = 0; i < set_up.sensors.size(); ++i) {
      const std::string numbered = "channel = " + std::to_string(i) + ".";
      if (!what.starts_with(numbered)) continue;
      const std::size_t colon = what.find(": ");
      std::string rest = what.substr(colon + 2);
      for (std::size_t j = 0; j < set_up.sensors.size(); ++j)
        if (const std::string other = "as channel " + std::to_string(j) + " ";
            rest.find(other) != std::string::npos)
          rest.replace(rest.find(other), other.size(), "as " + set_up.sensors[j].name + " ");
      file.refuse(set_up.places[i], rest);
    }
    file.refuse(set_up.where, what);
  }
}

/// Shapes of one quantity.
void unite_quantities(const std::vector<int>& orders, ModalResult& result) {
  // A set-up that measures one quantity alone has the shapes of any other, but for a factor.
  signals::convert_shapes(result, orders);
}

/// Set-ups that are merged before they are identified.
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
    if (!modal.quantity.empty()) unite_quantities(orders, out.set_ups.back());
    return out;
  }
  ProgressBar bar(common.quiet || modal.set_ups.size() == 1);
  std::vector<signals::SetUpModes> pieces;
  for (const SetUp& set_up : modal.set_ups) {
    bar.show("set-ups",
             static_cast<double>(pieces.size()) / static_cast<double>(modal.set_ups.size()),
             io::printable(set_up.name));
    out.set_ups.push_back(identify_modes_of(modal.file, set_up, common.seed.value_or(1)));
    unite_quantities(set_up.orders, out.set_ups.back());
    pieces.push_back({.modes = out.set_ups.back().modes,
                      .covariance = out.set_ups.back().covariance,
                      .sensors = set_up.which});
  }
  bar.clear();
  if (pieces.size() > 1)
    out.merged = signals::merge_modes(pieces, static_cast<int>(modal.sensors.size()));
  return out;
}

Report mode_json(const Mode& m) {
  return {{"frequency_hz", m.pole.frequency_hz},
          {"frequency_sd", finite(m.pole.frequency_sd)},
          {"damping", finite(m.pole.damping)},
          {"damping_sd", finite(m.pole.damping_sd)},
          {"collinearity", m.collinearity},
          {"phase_deviation", m.phase_deviation},
          {"amplitude_kurtosis", m.amplitude_kurtosis},
          {"order", m.pole.order},
          {"orders", {{"present", m.present}, {"possible", m.orders}}},
          {"doubts", doubts_in_words(m)}};
}

Report merged_json(const signals::MergedMode& m) {
  Report places = Report::array();
  for (const int place : m.places) places.push_back(place < 0 ? Report() : Report(place));
  return {{"frequency_hz", m.frequency_hz},
          {"frequency_sd", finite(m.frequency_sd)},
          {"damping", m.damping},
          {"damping_sd", finite(m.damping_sd)},
          {"collinearity", m.collinearity},
          {"between_hz", m.between_hz},
          {"consistency_p", m.consistency_p},
          {"reference_mac", m.reference_mac},
          {"places", places},
          {"doubts", doubts_in_words(m)}};
}

/// Poles of the diagram, each with the mode that it belongs to (from 1).
Report poles_json(const signals::Stabilisation& diagram) {
  std::vector<Report> of(diagram.poles.size());
  for (std::size_t m = 0; m < diagram.modes.size(); ++m)
    for (const int p : diagram.modes[m].members) of[static_cast<std::size_t>(p)] = m + 1;
  Report out = Report::array();
  for (std::size_t i = 0; i < diagram.poles.size(); ++i) {
    const signals::Pole& p = diagram.poles[i];
    out.push_back(
        {p.order, p.frequency_hz, p.damping, finite(p.frequency_sd), finite(p.damping_sd), of[i]});
  }
  return {{"columns", {"order", "frequency_hz", "damping", "frequency_sd", "damping_sd", "mode"}},
          {"poles", out}};
}

Report rejected_json(const signals::Stabilisation& diagram) {
  Report out = Report::array();
  for (const signals::RejectedCluster& r : diagram.rejected) {
    const signals::Pole& p = diagram.poles[static_cast<std::size_t>(r.cluster.chosen)];
    out.push_back(
        {{"frequency_hz", p.frequency_hz},
         {"damping", p.damping},
         {"orders", {{"present", r.cluster.members.size()}, {"possible", r.cluster.orders}}},
         {"why", rejection_in_words(r.why)}});
  }
  return out;
}

/// Mean of the channels' spectra, each over its variance, in decibels, within the band.
std::vector<std::pair<double, double>> levels(const SetUp& modal, const ModalResult& result) {
  if (result.singular_spectrum.rows() > 0) {
    std::vector<std::pair<double, double>> out;
    for (const auto& line : result.singular_spectrum.rowwise())
      if (line[1] > 0.0) out.emplace_back(line[0], 10.0 * std::log10(line[1]));
    return out;
  }
  if (modal.responses) {
    std::vector<std::pair<double, double>> out;
    const signals::FrequencyResponses f =
        modal.responses->band(result.lowest_hz, result.highest_hz);
    for (Eigen::Index k = 0; k < f.lines(); ++k)
      if (const double size = f.h[static_cast<std::size_t>(k)].squaredNorm(); size > 0.0)
        out.emplace_back(f.frequencies_hz[k], 10.0 * std::log10(size));
    return out;
  }
  const double rate = modal.options.sample_rate_hz;
  const auto n = static_cast<int>(modal.records.cols());
  int segment = 64;
  while (segment * 8 <= n && segment < 16384) segment *= 2;
  std::vector<std::pair<double, double>> out;
  for (Eigen::Index c = 0; c < modal.records.rows(); ++c) {
    const Eigen::VectorXd x = modal.records.row(c).transpose();
    const signals::Spectrum s =
        signals::welch({x.data(), static_cast<std::size_t>(x.size())}, rate, {.segment = segment});
    const double variance = (x.array() - x.mean()).square().mean();
    if (out.empty())
      for (const double f : s.frequencies_hz) out.emplace_back(f, 0.0);
    for (std::size_t i = 0; i < out.size(); ++i) out[i].second += s.density[i] / variance;
  }
  std::erase_if(out, [&](const auto& p) {
    return p.first < result.lowest_hz || p.first > result.highest_hz || !(p.second > 0.0);
  });
  for (auto& [f, level] : out) level = 10.0 * std::log10(level);
  return out;
}

/// What a record holds, in decibels within the band: the mean of its channels' spectra, each over
/// its variance, the sum of its frequency responses' squares, or the first singular value. Of many
/// lines the highest of each neighbourhood.
Report spectrum_json(const SetUp& set_up, const ModalResult& result) {
  constexpr std::size_t kMostLines = 1000;
  const std::vector<std::pair<double, double>> all = levels(set_up, result);
  const std::size_t width = (all.size() + kMostLines - 1) / kMostLines;
  Report frequencies = Report::array(), level = Report::array();
  for (std::size_t from = 0; from < all.size(); from += width) {
    const auto end = all.begin() + static_cast<std::ptrdiff_t>(std::min(from + width, all.size()));
    const auto top = std::max_element(all.begin() + static_cast<std::ptrdiff_t>(from), end,
                                      [](auto& a, auto& b) { return a.second < b.second; });
    frequencies.push_back(top->first);
    level.push_back(0.01 * std::round(100.0 * top->second));
  }
  return {{"frequencies_hz", frequencies}, {"level_db", level}};
}

/// How the record was read: units of its channels, sampling, layout of its text.
Report record_json(const SetUp& set_up) {
  Report channels = Report::array();
  for (std::size_t i = 0; i < set_up.channels.size(); ++i) {
    const ChannelUse& use = set_up.channels[i];
    Report one = {{"channel", use.column}, {"role", use.is_force ? "force" : "response"}};
    if (!use.is_force && i < set_up.sensors.size() && !set_up.sensors[i].quantity.empty())
      one["quantity"] = set_up.sensors[i].quantity;
    one.update(conversion_json(use.conversion));
    channels.push_back(std::move(one));
  }
  Report out = {{"file", set_up.name}, {"channels", channels}};
  if (!set_up.responses || set_up.sampling.rate_hz > 0.0)
    out["sampling"] = sampling_json(set_up.sampling);
  if (set_up.layout) out["layout"] = layout_json(*set_up.layout);
  return out;
}

/// "modes", "procedure", "spectrum", "stabilisation" and what was rejected, of one record.
Report set_up_json(const SetUp& set_up, const ModalResult& result) {
  Report modes = Report::array();
  for (const Mode& m : result.modes) modes.push_back(mode_json(m));
  Report procedure = {{"method", "ssi-cov"},
                      {"band", {result.lowest_hz, result.highest_hz}},
                      {"largest_order", result.largest_order},
                      {"distance_threshold", result.diagram.threshold}};
  if (result.method == signals::ModalMethod::polyreference) {
    procedure["method"] = "plscf";
    procedure["lines"] = result.lines;
    procedure["replicates"] = result.replicates;
  } else if (result.method == signals::ModalMethod::realisation) {
    procedure["method"] = "era";
    procedure["sample_rate_hz"] = result.sample_rate_hz;
    procedure["decimated"] = result.decimated;
    procedure["lags"] = result.lags;
    procedure["replicates"] = result.replicates;
  } else if (result.segments > 0) {
    procedure = {{"method", result.method == signals::ModalMethod::enhanced ? "efdd" : "fdd"},
                 {"band", {result.lowest_hz, result.highest_hz}},
                 {"sample_rate_hz", result.sample_rate_hz},
                 {"decimated", result.decimated},
                 {"segment", result.segment},
                 {"segments", result.segments},
                 {"blocks", result.blocks}};
  } else if (result.method == signals::ModalMethod::bayesian) {
    procedure = {{"method", "bayoma"},
                 {"band", {result.lowest_hz, result.highest_hz}},
                 {"sample_rate_hz", result.sample_rate_hz}};
  } else {
    procedure.update({{"sample_rate_hz", result.sample_rate_hz},
                      {"decimated", result.decimated},
                      {"lags", result.lags},
                      {"blocks", result.blocks},
                      {"set_ups", result.set_ups},
                      {"block_seconds", result.block_seconds},
                      {"references", result.references}});
  }
  procedure["in_words"] = procedure_in_words(result);
  for (const std::string& text : record_in_words(set_up)) procedure["in_words"].push_back(text);
  return {{"modes", modes},
          {"record", record_json(set_up)},
          {"procedure", procedure},
          {"spectrum", spectrum_json(set_up, result)},
          {"stabilisation", poles_json(result.diagram)},
          {"rejected", rejected_json(result.diagram)},
          {"rejected_poles", rejected_poles_in_words(result)}};
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
  if (found.merged) {
    Report merged = Report::array(), set_ups = Report::array();
    for (const signals::MergedMode& m : found.merged->modes) merged.push_back(merged_json(m));
    for (std::size_t s = 0; s < found.set_ups.size(); ++s) {
      Report one = {{"file", modal.set_ups[s].name}};
      one.update(set_up_json(modal.set_ups[s], found.set_ups[s]));
      one["warnings"] = cautions(modal.set_ups[s], found.set_ups[s]);
      set_ups.push_back(std::move(one));
    }
    out["modes"] = merged;
    out["merging"] = {{"in_words", merging_in_words(*found.merged, found.set_ups.size())}};
    out["references"] = found.merged->references;
    out["set_ups"] = set_ups;
  } else {
    out.update(set_up_json(modal.set_ups[0], found.set_ups[0]));
  }
  if (modal.geometry) out["geometry"] = geometry_json(*modal.geometry);
  out["diagnostics"] = {{"warnings", cautions(modal, found)}};
  out["cost"] = {{"wall_seconds", seconds}};
  return out;
}

void ModalRun::print(std::ostream& out, bool colour) const {
  const Page page(out, colour);
  out << page.bold(io::printable(modal.title)) << "\n\n";
  const auto say = [&](const auto& list) {
    if (list.empty()) return;
    print_table(page, list);
    if (modes.covariance.size() > 0) out << "± is one standard deviation.\n";
    print_doubts(page, list);
  };
  if (found.merged) {
    say(found.merged->modes);
  } else {
    say(found.set_ups[0].modes);
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
  io::AtomicFile identified(folder / "modes.json"), report(folder / "report.html"),
      whole(folder / "summary.json");
  identified.write(text);
  report.write(page);
  whole.write(kept.dump(1) + "\n");
  io::AtomicFile* const files[] = {&identified, &report, &whole};
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
          .summary = "modes with their uncertainty, from records of a vibration",
          .case_kind = "modal",
          .add_options =
              [](CommandOptions& options) {
                options.add_case();
                options.add_output(
                    "FOLDER",
                    "the folder for the results: modes.json, summary.json and report.html");
                options.add_json(kSummary);
                options.add_threads();
                options.add_dry_run();
              },
          .run = [](const Invocation& asked) { run_modal(asked.common); }};
}

}  // namespace wheeltap::apps
