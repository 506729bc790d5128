#include "apps/text/modal_words.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "apps/cases/records/record_reading.hpp"
#include "apps/words.hpp"
#include "base/number.hpp"

namespace wheeltap::apps {

using signals::ModeDoubt;

std::string with_sd(double x, double sd) {
  if (!std::isfinite(x)) return "-";
  if (!(sd > 0.0) || !std::isfinite(sd)) return significant(x, 5);
  const int decimals = std::max(0, 1 - static_cast<int>(std::floor(std::log10(sd))));
  return fixed(x, decimals) + " ± " + fixed(sd, decimals);
}

std::vector<std::string> doubts_in_words(const signals::Mode& mode) {
  std::vector<std::string> out;
  for (const ModeDoubt doubt : mode.doubts) {
    switch (doubt) {
      case ModeDoubt::few_orders:
        out.push_back("found in only " + std::to_string(mode.present) + " of " +
                      std::to_string(mode.orders) + " model orders");
        break;
      case ModeDoubt::damping_unknown:
        out.emplace_back("the damping ratio is very uncertain");
        break;
      case ModeDoubt::complex_shape:
        out.emplace_back("the mode shape is complex: noise, or two close modes identified as one");
        break;
      case ModeDoubt::tone:
        out.emplace_back("probably a harmonic of a machine, not a mode");
        break;
      case ModeDoubt::twin:
        out.emplace_back(
            "another mode has the same shape, and the frequencies of the two modes differ by less "
            "than their uncertainty or their bandwidths");
        break;
      case ModeDoubt::at_the_edge:
        out.emplace_back("at an end of the band, where a filter may distort the mode");
        break;
    }
  }
  return out;
}

std::vector<std::string> doubts_in_words(const signals::MergedMode& mode) {
  std::vector<std::string> out;
  for (const signals::MergeDoubt doubt : mode.doubts) {
    switch (doubt) {
      case signals::MergeDoubt::few_set_ups:
        out.push_back("found in only " + std::to_string(mode.found()) + " of " +
                      std::to_string(mode.places.size()) + " set-ups");
        break;
      case signals::MergeDoubt::doubted:
        out.emplace_back("doubtful in most set-ups in which it was found");
        break;
      case signals::MergeDoubt::inconsistent:
        out.push_back(
            "its frequency varies by " + significant(mode.between_hz, 2) +
            " Hz between set-ups, more than its standard deviations allow (p " +
            (mode.consistency_p < 1e-15 ? "< 1e-15" : significant(mode.consistency_p, 2)) +
            "): the structure changed, or blocks are too short");
        break;
      case signals::MergeDoubt::unlike:
        out.push_back("set-ups disagree on its shape at the references (MAC down to " +
                      fixed(mode.reference_mac, 2) + ")");
        break;
    }
  }
  return out;
}

std::vector<std::string> record_in_words(const SetUp& set_up) {
  std::vector<std::string> out;
  // Channels with the same unit form one entry.
  std::vector<std::pair<std::string, std::vector<std::string>>> units;
  for (const ChannelUse& use : set_up.channels) {
    const std::string words = conversion_in_words(use.conversion);
    auto same = std::ranges::find(units, words, &decltype(units)::value_type::first);
    if (same == units.end()) same = units.insert(units.end(), {words, {}});
    same->second.push_back(use.column);
  }
  std::string text;
  for (const auto& [words, columns] : units) {
    text += text.empty() ? "Units: " : "; ";
    text += (columns.size() > 4
                 ? columns.front() + " and " + std::to_string(columns.size() - 1) + " others"
                 : in_words(columns)) +
            ": " + words;
  }
  if (!text.empty()) out.push_back(text + ".");
  if (!set_up.orders.empty() && std::ranges::min(set_up.orders) != std::ranges::max(set_up.orders))
    out.emplace_back(
        "Channels measure different quantities. Wheeltap converts all entries of a shape to the "
        "highest time derivative among them, by means of the mode's frequency and damping.");
  if (std::string words = sampling_in_words(set_up.sampling);
      !words.empty() && !set_up.sampling.doubtful_unit)
    out.push_back(std::move(words));
  if (set_up.layout) out.push_back(layout_in_words(*set_up.layout));
  return out;
}

std::string orders_in_words(int present, int orders) {
  return orders > 0 ? std::to_string(present) + " of " + std::to_string(orders) : "-";
}

std::string rejection_in_words(signals::Rejection why) {
  switch (why) {
    case signals::Rejection::few_orders:
      return "found in too few model orders";
    case signals::Rejection::splinter:
      return "part of a mode that another cluster estimates better (high model orders split modes)";
    case signals::Rejection::noise:
      return "without this mode, the other modes explain the decays equally well";
    case signals::Rejection::not_chosen:
      return "not in the list of poles in the case";
  }
  return {};
}

std::string rejected_poles_in_words(const signals::ModalResult& result) {
  const signals::Stabilisation& of = result.diagram;
  if (of.poles.empty()) return {};
  std::vector<bool> told(of.poles.size());
  for (const signals::ModeCluster& c : of.modes)
    for (const int m : c.members) told[static_cast<std::size_t>(m)] = true;
  for (const signals::RejectedCluster& r : of.rejected)
    for (const int m : r.cluster.members) told[static_cast<std::size_t>(m)] = true;
  long unknown = 0, alone = 0;
  for (std::size_t i = 0; i < of.poles.size(); ++i)
    if (!told[i]) ++(of.hard[i] ? alone : unknown);
  std::string out = "Of " + base::grouped(static_cast<long>(of.poles.size())) +
                    " poles in the band with a damping ratio from -0.2 to 20 %, ";
  if (unknown > 0)
    out += base::grouped(unknown) +
           " were omitted because the relative sd of their frequency exceeds 5 %, and ";
  return out + base::grouped(alone) +
         " were omitted because fewer than two other model orders have a similar pole.";
}

std::vector<std::string> procedure_in_words(const signals::ModalResult& result) {
  std::vector<std::string> out;
  if (result.method == signals::ModalMethod::bayesian) {
    out.emplace_back(
        "Wheeltap samples the posterior of each band's modes, modal forces and noise, given the "
        "Fourier coefficients in the band. Values are means and standard deviations of the draws. "
        "The method assumes that the modal forces are white within a band, and that modes of other "
        "bands do not contribute to this band.");
    return out;
  }
  if (result.method == signals::ModalMethod::polyreference) {
    out.push_back("Frequency response functions at " + base::grouped(result.lines) +
                  " frequencies from " + significant(result.lowest_hz, 4) + " to " +
                  significant(result.highest_hz, 4) +
                  " Hz were fitted by matrix fractions of model orders up to " +
                  std::to_string(result.largest_order) + ". Standard deviations come from " +
                  std::to_string(result.replicates) + " bootstrap replicates of the residuals.");
    return out;
  }
  if (result.segments > 0) {
    out.push_back("Spectra are averages of " + base::grouped(static_cast<long>(result.segments)) +
                  " segments of " + base::grouped(static_cast<long>(result.segment)) +
                  " samples, with " + significant(result.sample_rate_hz / result.segment, 3) +
                  " Hz between spectral lines. Modes are peaks of the first singular value.");
    if (result.method == signals::ModalMethod::enhanced)
      out.push_back(
          "Frequency and damping are fitted to the correlation function of the spectral lines "
          "about each peak. Standard deviations are computed from " +
          std::to_string(result.blocks) +
          " parts of the record and do not include bias: damping is wrong if another mode or a "
          "change of shape truncates the spectral bell.");
    else
      out.emplace_back(
          "Frequencies are at best as accurate as the spacing of the spectral lines. This method "
          "gives no damping "
          "and no standard deviations: damage and update cases reject these modes as data.");
    return out;
  }
  if (result.decimated > 1)
    out.push_back("Records were filtered and decimated by the factor " +
                  std::to_string(result.decimated) + ", to " +
                  significant(result.sample_rate_hz, 5) + " Hz.");
  if (result.method == signals::ModalMethod::realisation) {
    out.push_back("Free decays were used over " + std::to_string(result.lags) + " samples (" +
                  significant(result.lags / result.sample_rate_hz, 3) +
                  " s), with model orders up to " + std::to_string(result.largest_order) +
                  ". Standard deviations come from " + std::to_string(result.replicates) +
                  " surrogates of the residuals of the decays.");
    return out;
  }
  if (result.set_ups > 1)
    out.push_back("The covariances of " + std::to_string(result.set_ups) +
                  " set-ups were merged through the " + std::to_string(result.references.size()) +
                  (result.references.size() == 1 ? " sensor" : " sensors") +
                  " common to all set-ups, and the modes of all set-ups were identified together. "
                  "The spectrum shows the first set-up.");
  out.push_back("Covariances were used over " + std::to_string(result.lags) + " lags (" +
                significant(result.lags / result.sample_rate_hz, 3) +
                " s). Their standard deviations come from " + std::to_string(result.blocks) +
                " blocks of " + significant(result.block_seconds, 3) +
                " s. Model orders go up to " + std::to_string(result.largest_order) + ".");
  if (result.chosen_by_hand)
    out.emplace_back(
        "The modes are the poles that the user chose in the key \"poles\" of the case.");
  return out;
}

std::vector<std::string> warnings(const signals::ModalResult& result) {
  std::vector<std::string> out;
  if (result.modes.empty())
    out.emplace_back(
        "No mode was found in the band: no pole is stable over model orders. Check the spectra, "
        "widen the band, or use a longer record.");
  if (const int n = result.remarks.narrow; n > 0)
    out.push_back(
        std::to_string(n) + (n == 1 ? " mode is" : " modes are") +
        " narrower than the frequency resolution: the damping then relies on the fit alone and is "
        "valid only if no window function has broadened the peaks of the frequency response "
        "functions.");
  if (const int n = result.remarks.moved; n > 0)
    out.push_back("The final fit of all modes moved " + std::to_string(n) +
                  (n == 1 ? " mode" : " modes") + " away from " + (n == 1 ? "its" : "their") +
                  " position in the stabilisation diagram: another mode may be missing nearby.");
  for (const std::string& why : result.remarks.unsettled)
    out.push_back("Not converged, do not trust these numbers yet: " + why);
  if (result.remarks.short_blocks)
    out.push_back("The record is short: it gives only " + std::to_string(result.blocks) +
                  " blocks of " + significant(result.block_seconds, 3) +
                  " s, so that the relative error of standard deviations is about " +
                  significant(100.0 / std::sqrt(2.0 * (result.blocks - 1)), 2) + " %.");
  if (const int n = result.remarks.longer_decays; n > 0)
    out.push_back("Blocks of " + significant(result.block_seconds, 3) +
                  " s are shorter than the decay time 1 / (ζω) of " + std::to_string(n) +
                  (n == 1 ? " mode: its" : " modes: their") +
                  " standard deviations are less accurate. Use a longer record.");
  if (result.remarks.order_cut > 0)
    out.push_back("Model orders stop at " + std::to_string(result.largest_order) + ", not at " +
                  std::to_string(result.remarks.order_cut) +
                  (result.method == signals::ModalMethod::polyreference
                       ? ": there are too few frequencies for higher model orders."
                       : ": the record is too short for the lags of higher model orders."));
  if (result.method != signals::ModalMethod::subspace) return out;
  if (result.blocks <= 2 * static_cast<int>(result.modes.size()))
    out.push_back("There are " + std::to_string(result.blocks) + " blocks for " +
                  std::to_string(2 * result.modes.size()) +
                  " frequencies and damping ratios: their joint covariance is singular, but the "
                  "individual standard deviations are valid.");
  if (result.references.size() == 1 && result.modes.size() > 1)
    out.emplace_back(
        "There is only one reference sensor: modes with little motion there may be missing, "
        "and two "
        "modes with the same frequency appear as one mode.");
  return out;
}

std::vector<std::string> cautions(const SetUp& set_up, const signals::ModalResult& result) {
  std::vector<std::string> out = warnings(result);
  out.insert(out.end(), set_up.oddities.begin(), set_up.oddities.end());
  return out;
}

std::vector<std::string> cautions(const ModalCaseFile& modal, const IdentifiedModes& found) {
  if (!found.merged) {
    std::vector<std::string> out = cautions(modal.set_ups[0], found.set_ups[0]);
    for (std::size_t s = 1; s < modal.set_ups.size(); ++s)
      for (const std::string& text : modal.set_ups[s].oddities)
        out.push_back(modal.set_ups[s].name + ": " + text);
    return out;
  }
  std::vector<std::string> out;
  // A warning that several set-ups share appears once.
  std::vector<std::pair<std::string, std::vector<std::string>>> said;
  for (std::size_t s = 0; s < found.set_ups.size(); ++s)
    for (const std::string& text : cautions(modal.set_ups[s], found.set_ups[s])) {
      auto same = std::ranges::find(said, text, &decltype(said)::value_type::first);
      if (same == said.end()) same = said.insert(said.end(), {text, {}});
      same->second.push_back(modal.set_ups[s].name);
    }
  for (const auto& [text, names] : said) {
    std::string where = names[0];
    if (names.size() == found.set_ups.size()) {
      where = "All set-ups";
    } else {
      for (std::size_t i = 1; i < names.size(); ++i) where += ", " + names[i];
    }
    out.push_back(where + ": " + text);
  }
  return out;
}

std::string merging_in_words(const signals::MergedModes& merged, std::size_t set_ups) {
  const std::size_t references = merged.references.size();
  return std::to_string(set_ups) +
         " set-ups were identified separately. Merged frequencies and damping ratios are "
         "weighted means; shapes are merged by the " +
         (references == 1 ? std::string("one sensor") : std::to_string(references) + " sensors") +
         " common to all set-ups.";
}

}  // namespace wheeltap::apps
