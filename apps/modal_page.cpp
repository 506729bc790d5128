#include "apps/modal_page.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/modal_words.hpp"
#include "apps/svg_plot.hpp"
#include "apps/words.hpp"
#include "signals/spectra.hpp"

namespace wheeltap::apps {
namespace {

using signals::ModalResult;
using signals::Mode;
using signals::Pole;

constexpr double kInterval = 1.96;

std::string line(const std::string& kind, double x0, double y0, double x1, double y1) {
  return "<path class=\"" + kind + "\" d=\"M" + fixed(x0, 1) + " " + fixed(y0, 1) + "L" +
         fixed(x1, 1) + " " + fixed(y1, 1) + "\"/>\n";
}

std::string dot(const std::string& kind, double x, double y, double radius) {
  return "<circle class=\"" + kind + "\" cx=\"" + fixed(x, 1) + "\" cy=\"" + fixed(y, 1) +
         "\" r=\"" + fixed(radius, 1) + "\"/>\n";
}

/// Mean of the channels' spectra, each over its variance, in decibels, within the band.
std::vector<std::pair<double, double>> levels(const SetUp& modal, const ModalResult& result) {
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

std::string diagram(const SetUp& modal, const ModalResult& result) {
  constexpr double kHeight = 320.0;
  const int top = std::max(result.largest_order, 1);
  const Plot plot(result.lowest_hz, result.highest_hz, 0.0, result.largest_order + 2.0, kHeight);
  const auto spectrum = levels(modal, result);
  std::string inside;
  if (spectrum.size() > 1) {
    const auto [low, high] = std::ranges::minmax(spectrum, {}, [](auto& p) { return p.second; });
    std::string path;
    for (const auto& [f, level] : spectrum)
      path +=
          (path.empty() ? "M" : "L") + fixed(plot.x(f), 1) + " " +
          fixed(plot.y(top * (level - low.second) / std::max(high.second - low.second, 1e-9)), 1);
    inside += "<path class=\"grid\" d=\"" + path + "\"/>\n";
  }
  std::vector<bool> kept(result.diagram.poles.size());
  for (const signals::ModeCluster& c : result.diagram.modes)
    for (const int m : c.members) kept[static_cast<std::size_t>(m)] = true;
  for (std::size_t i = 0; i < result.diagram.poles.size(); ++i) {
    const Pole& p = result.diagram.poles[i];
    const double y = plot.y(p.order);
    const auto at = [&](double f) {
      return plot.x(std::clamp(f, result.lowest_hz, result.highest_hz));
    };
    if (kept[i])
      inside += line("kept", at(p.frequency_hz - kInterval * p.frequency_sd), y,
                     at(p.frequency_hz + kInterval * p.frequency_sd), y);
    inside += dot(kept[i] ? "kept" : "pole", at(p.frequency_hz), y, kept[i] ? 2.0 : 1.2);
  }
  std::vector<double> marks;
  for (const Mode& mode : result.modes) {
    marks.push_back(mode.pole.frequency_hz);
    inside += dot("chosen", plot.x(mode.pole.frequency_hz), plot.y(mode.pole.order), 4.0);
  }
  return plot.framed("stabilisation diagram", "frequency [Hz]", "order",
                     plot.hairs(marks) + inside);
}

std::string damping(const ModalResult& result) {
  double highest = 0.0, lowest = 0.0;
  for (const Mode& m : result.modes) {
    highest = std::max(highest, 100.0 * (m.pole.damping + kInterval * m.pole.damping_sd));
    lowest = std::min(lowest, 100.0 * (m.pole.damping - kInterval * m.pole.damping_sd));
  }
  highest = std::min(highest, 20.0);
  lowest = std::max(lowest, -2.0);
  const Plot plot(result.lowest_hz, result.highest_hz, lowest, highest);
  std::string inside;
  for (const Mode& m : result.modes) {
    const double x = plot.x(m.pole.frequency_hz);
    const auto y = [&](double zeta) { return plot.y(std::clamp(100.0 * zeta, lowest, highest)); };
    inside += line("kept", x, y(m.pole.damping - kInterval * m.pole.damping_sd), x,
                   y(m.pole.damping + kInterval * m.pole.damping_sd));
    inside += dot(m.doubts.empty() ? "kept" : "chosen", x, y(m.pole.damping), 3.0);
  }
  return plot.framed("damping ratios with 95 % intervals", "frequency [Hz]", "damping [%]", inside);
}

std::string table(const ModalResult& result) {
  std::string out =
      "<table><tr><th>mode</th><th>f [Hz]</th><th>damping [%]</th><th>MPC</th><th>MPD [°]</th>"
      "<th>orders</th><th>doubts</th></tr>\n";
  int number = 0;
  for (const Mode& m : result.modes) {
    std::string why;
    for (const std::string& text : doubts_in_words(m)) why += (why.empty() ? "" : "; ") + text;
    out += "<tr><td>" + std::to_string(++number) + "</td><td>" +
           with_sd(m.pole.frequency_hz, m.pole.frequency_sd) + "</td><td>" +
           with_sd(100.0 * m.pole.damping, 100.0 * m.pole.damping_sd) + "</td><td>" +
           fixed(m.collinearity, 3) + "</td><td>" +
           fixed(m.phase_deviation * 180.0 / std::numbers::pi, 1) + "</td><td>" +
           orders_in_words(m) + "</td><td class=\"odd\">" + escaped(why) + "</td></tr>\n";
  }
  return out + "</table>\n";
}

std::string table(const signals::MergedModes& merged) {
  std::string out =
      "<table><tr><th>mode</th><th>f [Hz]</th><th>damping [%]</th><th>MPC</th><th>set-ups</th>"
      "<th>between set-ups [Hz]</th><th>least MAC of references</th><th>doubts</th></tr>\n";
  int number = 0;
  for (const signals::MergedMode& m : merged.modes) {
    std::string why;
    for (const std::string& text : doubts_in_words(m)) why += (why.empty() ? "" : "; ") + text;
    out += "<tr><td>" + std::to_string(++number) + "</td><td>" +
           with_sd(m.frequency_hz, m.frequency_sd) + "</td><td>" +
           with_sd(100.0 * m.damping, 100.0 * m.damping_sd) + "</td><td>" +
           fixed(m.collinearity, 3) + "</td><td>" + std::to_string(m.found()) + " of " +
           std::to_string(m.places.size()) + "</td><td>" +
           (m.between_hz > 0.0 ? significant(m.between_hz, 2) : "0") + "</td><td>" +
           fixed(m.reference_mac, 3) + "</td><td class=\"odd\">" + escaped(why) + "</td></tr>\n";
  }
  return out + "</table>\n";
}

/// The merged frequency of each mode over what each set-up says of it, in standard deviations of
/// the set-ups: as wide as the numbers allow.
std::string agreement(const ModalCaseFile& modal, const IdentifiedModes& found) {
  const auto sets = static_cast<double>(found.set_ups.size());
  const double reach = 6.0;
  const Plot plot(0.5, static_cast<double>(found.merged->modes.size()) + 0.5, -reach, reach);
  std::string inside =
      line("grid", plot.x(0.5), plot.y(0.0),
           plot.x(static_cast<double>(found.merged->modes.size()) + 0.5), plot.y(0.0));
  for (std::size_t m = 0; m < found.merged->modes.size(); ++m) {
    const signals::MergedMode& mode = found.merged->modes[m];
    for (std::size_t s = 0; s < modal.set_ups.size(); ++s) {
      if (mode.places[s] < 0) continue;
      const Pole& p = found.set_ups[s].modes[static_cast<std::size_t>(mode.places[s])].pole;
      const double z =
          std::clamp((p.frequency_hz - mode.frequency_hz) / p.frequency_sd, -reach, reach);
      inside += dot("kept",
                    plot.x(static_cast<double>(m) + 1.0 +
                           0.6 * ((static_cast<double>(s) + 0.5) / sets - 0.5)),
                    plot.y(z), 2.5);
    }
  }
  return plot.framed("set-ups against the merged frequencies", "mode",
                     "deviation of a set-up, in its standard deviations", inside);
}

std::string list(const std::vector<std::string>& items) {
  if (items.empty()) return {};
  std::string out = "<ul class=\"odd\">";
  for (const std::string& item : items) out += "<li>" + escaped(item) + "</li>";
  return out + "</ul>\n";
}

std::string of_record(const SetUp& set_up, const ModalResult& result, const std::string& level) {
  std::string out;
  if (!result.modes.empty()) out += "<" + level + ">Modes</" + level + ">\n" + table(result);
  out += "<p>± is one standard deviation.</p>\n";
  const bool orders = result.method != signals::ModalMethod::bayesian;
  out += "<" + level + ">" + (orders ? "Stabilisation diagram" : "Spectrum") + "</" + level +
         ">\n" + diagram(set_up, result);
  if (!orders)
    out += "<p>The mean spectrum of the channels, in decibels; lines mark the modes.</p>\n";
  if (orders)
    out +=
        "<p>A dot a pole, blue those that make a mode, with 95 % intervals; ringed the pole that "
        "stands for it. Behind, in decibels, the mean spectrum of the channels, or the sum of the "
        "frequency responses' squares.</p>\n";
  if (!result.modes.empty())
    out += "<" + level + ">Damping, with 95 % intervals</" + level + ">\n" + damping(result);
  for (const std::string& text : procedure_in_words(result))
    out += "<p>" + escaped(text) + "</p>\n";
  return out;
}

}  // namespace

std::string modal_page(const ModalCaseFile& modal, const IdentifiedModes& found) {
  std::string out = page_head(modal.title) + list(cautions(modal, found));
  if (found.merged) {
    out += "<h2>Modes</h2>\n" + table(*found.merged);
    out += "<p>± is one standard deviation. " +
           escaped(merging_in_words(*found.merged, found.set_ups.size())) + "</p>\n";
    if (!found.merged->modes.empty())
      out += "<h2>Set-ups against the whole</h2>\n" + agreement(modal, found);
    for (std::size_t s = 0; s < found.set_ups.size(); ++s)
      out += "<h2>" + escaped(modal.set_ups[s].name) + "</h2>\n" +
             of_record(modal.set_ups[s], found.set_ups[s], "h3");
  } else {
    out += of_record(modal.set_ups[0], found.set_ups[0], "h2");
  }
  return out + "</body>\n</html>\n";
}

}  // namespace wheeltap::apps
