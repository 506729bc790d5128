#include "apps/results/modal_summary.hpp"

#include <cmath>

#include "apps/cases/records/record_reading.hpp"
#include "apps/text/modal_words.hpp"

namespace wheeltap::apps {
namespace {

using signals::ModalResult;
using signals::Mode;

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

/// Poles of the diagram, each with the number (from 1) of the mode to which it belongs.
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

/// The spectrum of a record within the band [dB]; if it has many lines, the maximum of each
/// interval.
Report spectrum_json(const SetUp& set_up, const ModalResult& result) {
  constexpr std::size_t kMostLines = 1000;
  Report frequencies = Report::array(), level = Report::array();
  for (const signals::SpectralLevel& l :
       signals::highest_lines(identification::spectral_levels(set_up, result), kMostLines)) {
    frequencies.push_back(l.frequency_hz);
    level.push_back(0.01 * std::round(100.0 * l.level_db));
  }
  return {{"frequencies_hz", frequencies}, {"level_db", level}};
}

/// Interpretation of the record: units of its channels, sampling, layout of its text.
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

/// "modes", "procedure", "spectrum", "stabilisation" and rejected poles of one record.
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
    if (result.chosen_by_hand) procedure["chosen_by_hand"] = true;
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

/// Four decimals suffice to draw a shape and to compare it with others.
double four_decimals(double x) {
  return 1e-4 * std::round(1e4 * x);
}

}  // namespace

Report poles_with_shapes(const ModalCaseFile& modal, const IdentifiedModes& found) {
  Report out = Report::array();
  for (std::size_t s = 0; s < found.set_ups.size(); ++s) {
    const signals::Stabilisation& diagram = found.set_ups[s].diagram;
    Report sensors = Report::array(), shapes = Report::array();
    for (const MeasuredSensor& sensor :
         modal.pre_merged ? modal.sensors : modal.set_ups[s].sensors) {
      const auto axis = direction_of(sensor);
      sensors.push_back({{"name", sensor.name},
                         {"node", sensor.node},
                         {"direction", axis ? Report(*axis) : Report()}});
    }
    for (const signals::Pole& p : diagram.poles) {
      Report real = Report::array(), imaginary = Report::array();
      for (const std::complex<double>& x : p.shape) {
        real.push_back(four_decimals(x.real()));
        imaginary.push_back(four_decimals(x.imag()));
      }
      shapes.push_back({{"real", real}, {"imaginary", imaginary}});
    }
    Report one = {{"file", modal.set_ups[s].name}, {"sensors", sensors}};
    one.update(poles_json(diagram));
    one["shapes"] = shapes;
    out.push_back(std::move(one));
  }
  return {{"set_ups", out}};
}

Report modal_summary(const ModalCaseFile& modal, const IdentifiedModes& found) {
  Report out = Report::object();
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
  return out;
}

}  // namespace wheeltap::apps
