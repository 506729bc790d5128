#include "apps/report/modal_page.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "apps/cases/records/modal_geometry.hpp"
#include "apps/report/assets.hpp"
#include "apps/report/modal_figures.hpp"
#include "apps/report/report.hpp"
#include "apps/report/svg_plot.hpp"
#include "apps/text/modal_words.hpp"
#include "apps/words.hpp"

namespace wheeltap::apps {
namespace {

constexpr double kPageInterval = 1.96;

double number(const Report& value) {
  return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
}

double number(const Report& object, const char* key) {
  return number(object.at(key));
}

const Report& list_at(const Report& object, const char* key) {
  const Report& found = object.at(key);
  if (!found.is_array()) throw std::invalid_argument(std::string(key) + " must be a list");
  return found;
}

std::string line(const std::string& kind, double x0, double y0, double x1, double y1) {
  return svg_line("class=\"" + kind + "\"", x0, y0, x1, y1);
}

std::string dot(const std::string& kind, double x, double y, double radius) {
  return svg_dot("class=\"" + kind + "\"", x, y, radius);
}

struct Band {
  double lowest = 0.0, highest = 0.0;
  [[nodiscard]] double within(double f) const { return std::clamp(f, lowest, highest); }
};

Band band_of(const Report& set_up) {
  const Report& band = set_up.at("procedure").at("band");
  const Band out{.lowest = number(band.at(0)), .highest = number(band.at(1))};
  if (!(out.lowest < out.highest)) throw std::invalid_argument("a band must be ascending");
  return out;
}

bool has_poles(const Report& set_up) {
  return set_up.at("procedure").value("largest_order", 0) > 0;
}

std::string spectrum_path(const Report& spectrum, const Plot& plot, double top) {
  const Report &f = spectrum.at("frequencies_hz"), &level = spectrum.at("level_db");
  if (f.size() < 2) return {};
  double low = number(level.at(0)), high = low;
  for (const Report& l : level) {
    low = std::min(low, number(l));
    high = std::max(high, number(l));
  }
  std::string path;
  for (std::size_t i = 0; i < f.size(); ++i)
    path += (path.empty() ? "M" : "L") + fixed(plot.x(number(f.at(i))), 1) + " " +
            fixed(plot.y(top * (number(level.at(i)) - low) / std::max(high - low, 1e-9)), 1);
  return "<path class=\"spectrum\" d=\"" + path + "\"/>\n";
}

std::string diagram(const Report& set_up) {
  constexpr double kHeight = 320.0;
  const int largest = set_up.at("procedure").value("largest_order", 0);
  const double top = std::max(largest, 1);
  const Band band = band_of(set_up);
  const Plot plot(band.lowest, band.highest, 0.0, has_poles(set_up) ? top + 2.0 : 1.0, kHeight);
  std::string inside = spectrum_path(set_up.at("spectrum"), plot, top);
  for (const Report& p : list_at(set_up.at("stabilisation"), "poles")) {
    const double y = plot.y(number(p.at(0))), f = number(p.at(1)), sd = number(p.at(3));
    const bool kept = !p.at(5).is_null();
    if (kept && std::isfinite(sd))
      inside += line("kept", plot.x(band.within(f - kPageInterval * sd)), y,
                     plot.x(band.within(f + kPageInterval * sd)), y);
    inside += dot(kept ? "kept" : "pole", plot.x(band.within(f)), y, kept ? 2.0 : 1.2);
  }
  std::vector<double> marks;
  for (const Report& mode : list_at(set_up, "modes")) {
    marks.push_back(number(mode, "frequency_hz"));
    if (has_poles(set_up))
      inside += dot("chosen", plot.x(marks.back()), plot.y(number(mode, "order")), 4.0);
  }
  return plot.framed(has_poles(set_up) ? "stabilisation diagram" : "spectrum", "frequency [Hz]",
                     has_poles(set_up) ? "model order" : "level, from least to largest",
                     plot.hairs(marks) + inside);
}

std::string damping(const Report& modes, const Band& band) {
  double highest = 0.0, lowest = 0.0;
  const auto ends = [](const Report& m) {
    const double at = 100.0 * number(m, "damping"), sd = 100.0 * number(m, "damping_sd");
    const double reach = std::isfinite(sd) ? kPageInterval * sd : 0.0;
    return std::pair{at - reach, at + reach};
  };
  for (const Report& m : modes) {
    if (m.at("damping").is_null()) continue;
    lowest = std::min(lowest, ends(m).first);
    highest = std::max(highest, ends(m).second);
  }
  highest = std::min(1.05 * highest, 20.0);
  lowest = std::max(lowest, -2.0);
  const Plot plot(band.lowest, band.highest, lowest, highest);
  std::string inside;
  for (const Report& m : modes) {
    if (m.at("damping").is_null()) continue;
    const double x = plot.x(band.within(number(m, "frequency_hz")));
    const auto y = [&](double percent) { return plot.y(std::clamp(percent, lowest, highest)); };
    inside += line("kept", x, y(ends(m).first), x, y(ends(m).second));
    inside +=
        dot(m.at("doubts").empty() ? "kept" : "chosen", x, y(100.0 * number(m, "damping")), 3.0);
  }
  return plot.framed("damping ratios with 95 % intervals", "frequency [Hz]", "damping [%]", inside);
}

std::string why(const Report& doubts) {
  std::string out;
  for (const Report& text : doubts) out += (out.empty() ? "" : "; ") + text.get<std::string>();
  return "<td class=\"odd\">" + escaped(out) + "</td>";
}

std::string first_cells(const Report& m, int mode) {
  return "<tr><td>" + std::to_string(mode) + "</td><td>" +
         with_sd(number(m, "frequency_hz"), number(m, "frequency_sd")) + "</td><td>" +
         with_sd(100.0 * number(m, "damping"), 100.0 * number(m, "damping_sd")) + "</td><td>" +
         fixed(number(m, "collinearity"), 3) + "</td><td>";
}

std::string table(const Report& modes) {
  std::string out =
      "<div class=\"scroll\"><table><tr><th>mode</th><th>f [Hz]</th><th>damping [%]</th>"
      "<th>MPC</th><th>MPD [°]</th><th>model orders</th><th>doubts</th></tr>\n";
  int mode = 0;
  for (const Report& m : modes)
    out += first_cells(m, ++mode) +
           fixed(number(m, "phase_deviation") * 180.0 / std::numbers::pi, 1) + "</td><td>" +
           orders_in_words(m.at("orders").at("present").get<int>(),
                           m.at("orders").at("possible").get<int>()) +
           "</td>" + why(m.at("doubts")) + "</tr>\n";
  return out + "</table></div>\n";
}

std::string merged_table(const Report& modes) {
  std::string out =
      "<div class=\"scroll\"><table><tr><th>mode</th><th>f [Hz]</th><th>damping [%]</th>"
      "<th>MPC</th><th>set-ups</th><th>between set-ups [Hz]</th>"
      "<th>lowest MAC at references</th><th>doubts</th></tr>\n";
  int mode = 0;
  for (const Report& m : modes) {
    const Report& places = m.at("places");
    const auto found = std::ranges::count_if(places, [](const Report& p) { return !p.is_null(); });
    const double between = number(m, "between_hz");
    out += first_cells(m, ++mode) + std::to_string(found) + " of " + std::to_string(places.size()) +
           "</td><td>" + (between > 0.0 ? significant(between, 2) : "0") + "</td><td>" +
           fixed(number(m, "reference_mac"), 3) + "</td>" + why(m.at("doubts")) + "</tr>\n";
  }
  return out + "</table></div>\n";
}

/// Plots the frequency of each mode in each set-up minus the merged frequency, in standard
/// deviations of the set-up.
std::string agreement(const Report& modes, const Report& set_ups) {
  const auto sets = static_cast<double>(set_ups.size());
  const double reach = 6.0, end = static_cast<double>(modes.size()) + 0.5;
  const Plot plot(0.5, end, -reach, reach);
  std::string inside = line("grid", plot.x(0.5), plot.y(0.0), plot.x(end), plot.y(0.0));
  for (std::size_t m = 0; m < modes.size(); ++m) {
    for (std::size_t s = 0; s < set_ups.size(); ++s) {
      const Report& place = modes.at(m).at("places").at(s);
      if (place.is_null()) continue;
      const Report& own = set_ups.at(s).at("modes").at(place.get<std::size_t>());
      const double z = (number(own, "frequency_hz") - number(modes.at(m), "frequency_hz")) /
                       number(own, "frequency_sd");
      if (!std::isfinite(z)) continue;
      inside += dot("kept",
                    plot.x(static_cast<double>(m) + 1.0 +
                           0.6 * ((static_cast<double>(s) + 0.5) / sets - 0.5)),
                    plot.y(std::clamp(z, -reach, reach)), 2.5);
    }
  }
  return plot.framed("set-ups against the merged frequencies", "mode",
                     "deviation of a set-up, in units of its standard deviation", inside);
}

std::string list(const Report& items) {
  if (items.empty()) return {};
  std::string out = "<ul class=\"odd\">";
  for (const Report& item : items) out += "<li>" + escaped(item.get<std::string>()) + "</li>";
  return out + "</ul>\n";
}

std::string headed(const std::string& level, const std::string& words) {
  return "<" + level + ">" + words + "</" + level + ">\n";
}

/// Table of the rejected poles of a record, with reasons.
std::string rejected(const Report& set_up, const std::string& level) {
  const Report& clusters = list_at(set_up, "rejected");
  const std::string poles = set_up.at("rejected_poles").get<std::string>();
  if (clusters.empty() && poles.empty()) return {};
  std::string out = headed(level, "Rejected poles");
  if (!clusters.empty()) {
    out +=
        "<div class=\"scroll\"><table><tr><th>f [Hz]</th><th>damping [%]</th><th>model orders</th>"
        "<th>why</th></tr>\n";
    for (const Report& r : clusters)
      out += "<tr><td>" + significant(number(r, "frequency_hz"), 5) + "</td><td>" +
             significant(100.0 * number(r, "damping"), 3) + "</td><td>" +
             orders_in_words(r.at("orders").at("present").get<int>(),
                             r.at("orders").at("possible").get<int>()) +
             "</td><td>" + escaped(r.at("why").get<std::string>()) + "</td></tr>\n";
    out += "</table></div>\n";
  }
  return out + "<p>" + escaped(poles) + "</p>\n";
}

std::string of_record(const Report& set_up, const std::string& level, bool alone) {
  const Report& modes = list_at(set_up, "modes");
  const bool orders = has_poles(set_up);
  std::string out;
  if (!alone && !modes.empty()) out += headed(level, "Modes") + table(modes);
  out += headed(level, orders ? "Stabilisation diagram" : "Spectrum") + diagram(set_up);
  out +=
      orders
          ? "<p>Each dot is a pole. Blue poles belong to a mode and have 95 % intervals; a ring "
            "marks the pole that represents the mode. Behind the poles: the mean spectrum of the "
            "channels, or the sum of the squared frequency response functions, in decibels.</p>\n"
          : "<p>The mean spectrum of the channels, or the first singular value of their "
            "spectra, in decibels; lines mark the modes.</p>\n";
  if (std::ranges::any_of(modes, [](const Report& m) { return !m.at("damping").is_null(); }))
    out += headed(level, "Damping, with 95 % intervals") + damping(modes, band_of(set_up));
  return out;
}

/// Text on the analysis of a record.
std::string procedure(const Report& set_up) {
  std::string out;
  for (const Report& text : list_at(set_up.at("procedure"), "in_words"))
    out += "<p>" + escaped(text.get<std::string>()) + "</p>\n";
  return out;
}

std::string headline_of(const Report& modes) {
  if (modes.empty()) return "No modes were identified";
  const auto hz = [](const Report& m) { return significant(number(m, "frequency_hz"), 4); };
  if (modes.size() == 1) return "One mode at " + hz(modes.front()) + " Hz";
  return std::to_string(modes.size()) + " modes from " + hz(modes.front()) + " to " +
         hz(modes.back()) + " Hz";
}

std::vector<std::string> details_of(const Report& modes, std::size_t warnings) {
  constexpr std::size_t kMost = 6;
  std::vector<std::string> parts, doubtful;
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const Report& m = modes.at(i);
    std::string part = with_sd(number(m, "frequency_hz"), number(m, "frequency_sd")) + " Hz";
    if (!m.at("damping").is_null())
      part += " (damping " +
              with_sd(100.0 * number(m, "damping"), 100.0 * number(m, "damping_sd")) + " %)";
    if (i < kMost) parts.push_back(part);
    if (!m.at("doubts").empty()) doubtful.push_back(std::to_string(i + 1));
  }
  std::vector<std::string> out;
  if (!parts.empty())
    out.push_back(
        (modes.size() > kMost ? "The first " + std::to_string(kMost) + ": " : std::string()) +
        in_words(parts) + ".");
  if (!doubtful.empty())
    out.push_back((doubtful.size() == 1 ? "Doubtful: mode " : "Doubtful: modes ") +
                  in_words(doubtful) + ".");
  if (warnings > 0)
    out.push_back(std::to_string(warnings) + (warnings == 1 ? " warning is" : " warnings are") +
                  " near the end of this page.");
  return out;
}

/// The script that animates mode shapes, and the parts of the chart scripts that it needs.
std::string moving(const Report& drawing) {
  if (drawing.is_null()) return {};
  return "<div id=\"moving\"></div>\n<script>\n"
         "const charts = { number: (x, digits) => String(Number(x.toPrecision(digits))) };\n" +
         std::string(assets::kShapes) +
         "\n{\nconst element = (name, properties = {}, ...children) => {\n"
         "  const node = document.createElement(name);\n"
         "  for (const [key, value] of Object.entries(properties)) node.setAttribute(key, value);\n"
         "  node.append(...children);\n  return node;\n};\n"
         "document.getElementById('moving').append(shapeView(" +
         script_safe(drawing) + ", element));\n}\n</script>\n";
}

std::string shapes(const ModesFile& modes) {
  if (modes.frequencies_hz.size() == 0) return {};
  std::string out = "<h2>Mode shapes by channel</h2>\n" + bar_figures(modes);
  out +=
      "<p>Bars: shapes by channel, scaled to a largest entry of 1 and rotated in the complex plane "
      "to the smallest imaginary parts";
  out += modes.shape_covariance.empty() ? ". Doubtful modes in red.</p>\n"
                                        : ", with 95 % intervals. Doubtful modes in red.</p>\n";
  out += "<h2>Modal assurance criterion</h2>\n" + mac_figure(modes);
  out +=
      "<p>1: two modes have the same shape at these sensors; 0: their shapes are orthogonal. "
      "Large values off the diagonal mean that there are too few sensors to distinguish the modes, "
      "or that one mode was identified twice.</p>\n";
  out += "<h2>Complexity</h2>\n" + complexity_figures(modes);
  out +=
      "<p>The entries of each shape in the complex plane. For a lightly damped mode, the entries "
      "lie on "
      "one line (MPC 1, MPD 0°). Other patterns indicate noise, two close modes identified as one, "
      "dampers, or channels that were not sampled simultaneously.</p>\n";
  return out;
}

}  // namespace

std::string modal_page(const Report& summary, const ModesFile& modes) {
  const Report& list_of_modes = list_at(summary, "modes");
  const Report& warnings = list_at(summary.at("diagnostics"), "warnings");
  std::string out = page_head(modes.title, headline_of(list_of_modes),
                              details_of(list_of_modes, warnings.size()));
  const bool merged = summary.contains("set_ups");
  if (summary.contains("geometry") && modes.frequencies_hz.size() > 0)
    out += "<h2>Mode shapes</h2>\n" +
           moving(modal_drawing(geometry_of(summary.at("geometry")), modes));
  if (!list_of_modes.empty())
    out += "<h2>Modes</h2>\n" + (merged ? merged_table(list_of_modes) : table(list_of_modes));
  out += modes.covariance.size() > 0 ? "<p>± is one standard deviation." : "<p>";
  if (merged) out += " " + escaped(summary.at("merging").at("in_words").get<std::string>());
  out += "</p>\n";
  if (!merged) {
    out += of_record(summary, "h2", true) + shapes(modes);
  } else {
    const Report& set_ups = list_at(summary, "set_ups");
    if (!list_of_modes.empty())
      out += "<h2>Damping, with 95 % intervals</h2>\n" +
             damping(list_of_modes, band_of(set_ups.at(0))) +
             "<h2>Agreement of the set-ups</h2>\n" + agreement(list_of_modes, set_ups);
    out += shapes(modes);
    for (const Report& set_up : set_ups)
      out += "<h2>" + escaped(set_up.at("file").get<std::string>()) + "</h2>\n" +
             of_record(set_up, "h3", false);
  }
  out += "<h2 id=\"warnings\">Warnings</h2>\n" +
         (warnings.empty() ? std::string("<p>No warnings.</p>\n") : list(warnings));
  if (!merged) return out + rejected(summary, "h2") + procedure(summary) + page_end();
  for (const Report& set_up : list_at(summary, "set_ups"))
    out += "<h2>" + escaped(set_up.at("file").get<std::string>()) + ": diagnostics</h2>\n" +
           rejected(set_up, "h3") + procedure(set_up);
  return out + page_end();
}

}  // namespace wheeltap::apps
