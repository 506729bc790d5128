#include "apps/report/plan_page.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/report/svg_plot.hpp"
#include "apps/results/planning/plan_summary.hpp"
#include "apps/words.hpp"
#include "base/constants.hpp"

namespace wheeltap::apps {
namespace {

constexpr double kDiagramWidth = 640.0, kDiagramMargin = 46.0;

/// Maps locations [m] to the drawing; three-dimensional structures are seen obliquely from above.
class View {
 public:
  explicit View(const Report& plan) : space_(plan.at("drawing").at("dimension").get<int>() == 3) {
    double x0 = kInfinity, x1 = -kInfinity, y0 = kInfinity, y1 = -kInfinity;
    const auto stretch = [&](const Report& p) {
      const auto [u, v] = flat(p);
      x0 = std::min(x0, u);
      x1 = std::max(x1, u);
      y0 = std::min(y0, v);
      y1 = std::max(y1, v);
    };
    for (const Report& p : plan.at("drawing").at("points")) stretch(p);
    for (const Report& row : plan.at("detection_map"))
      if (!row.at("at").is_null()) stretch(row.at("at"));
    const double width = std::max(x1 - x0, 1e-9), height = y1 - y0;
    scale_ = std::min((kDiagramWidth - 2 * kDiagramMargin) / width, 420.0 / std::max(height, 1e-9));
    left_ = x0 - 0.5 * ((kDiagramWidth - 2 * kDiagramMargin) / scale_ - width);
    top_ = y1;
    height_ = std::max(height * scale_, 20.0) + 2 * kDiagramMargin;
  }
  [[nodiscard]] double height() const { return height_; }
  [[nodiscard]] std::array<double, 2> at(const Report& p) const {
    const auto [u, v] = flat(p);
    return {kDiagramMargin + (u - left_) * scale_, kDiagramMargin + (top_ - v) * scale_};
  }
  /// A direction on the drawing, as a unit vector in the plane of the drawing.
  [[nodiscard]] std::array<double, 2> along(const Report& d) const {
    const auto [u, v] = flat(d);
    const double size = std::max(std::hypot(u, v), 1e-9);
    return {u / size, -v / size};
  }

 private:
  [[nodiscard]] std::array<double, 2> flat(const Report& p) const {
    const double x = p[0].get<double>(), y = p[1].get<double>(), z = p[2].get<double>();
    return space_ ? std::array{x + 0.45 * y, z + 0.3 * y} : std::array{x, y};
  }
  bool space_;
  double scale_ = 1.0, left_ = 0.0, top_ = 0.0, height_ = 0.0;
};

std::string severity_of(const Report& plan, std::size_t i) {
  return plan.at("detection_map")[i].at("severity").get<std::string>();
}

/// Shade of a location: dark if a small severity is detectable, light if no severity is detectable.
std::string shade(double share) {
  return " class=\"cell\" fill-opacity=\"" + fixed(0.12 + 0.88 * share, 2) + "\"";
}

std::string drawing(const Report& plan) {
  if (plan.at("drawing").is_null()) return {};
  const View view(plan);
  std::string body;
  const Report& points = plan.at("drawing").at("points");
  for (const Report& line : plan.at("drawing").at("lines"))
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
      const auto a = view.at(points[line[i].get<std::size_t>()]);
      const auto b = view.at(points[line[i + 1].get<std::size_t>()]);
      body += svg_line(" class=\"grid\" stroke-width=\"2\"", a[0], a[1], b[0], b[1]);
    }
  for (std::size_t i = 0; i < plan.at("detection_map").size(); ++i) {
    const Report& row = plan.at("detection_map")[i];
    if (row.at("at").is_null()) continue;
    const std::string key = severity_of(plan, i);
    const Report& least = plan.at("smallest_detectable")[i];
    const auto at = view.at(row.at("at"));
    double share = 0.0;
    std::string words = row.at("place").get<std::string>() + ": not detected with probability 0.9";
    if (!least.at(key).is_null()) {
      const double most =
          row.at("severities").back().is_null() ? 1.0 : row.at("severities").back().get<double>();
      share = 1.0 - least.at(key).get<double>() / std::max(most, 1e-300);
      words = row.at("place").get<std::string>() + ": " + key + " " +
              significant(least.at(key).get<double>(), 2) + " detected with probability 0.9";
    }
    std::string dot = svg_dot(shade(share), at[0], at[1], 5.0);
    dot.insert(dot.find("/>"), ">");
    dot.replace(dot.find(">/>"), 3, "><title>" + escaped(words) + "</title></circle>");
    body += dot;
  }
  const Report& best = plan.at("designs")[0];
  for (std::size_t c = 0; c < plan.at("candidate_places").size(); ++c) {
    const Report& place = plan.at("candidate_places")[c];
    if (place.is_null()) continue;
    const bool chosen =
        std::ranges::find(best.at("sensors"), Report(c)) != best.at("sensors").end();
    const auto at = view.at(place.at("at"));
    const auto along = view.along(place.at("direction"));
    if (!chosen) {
      body += svg_dot(" class=\"pole\"", at[0], at[1], 1.8);
      continue;
    }
    const double x = at[0] + 24.0 * along[0], y = at[1] + 24.0 * along[1];
    body += svg_line(" class=\"doubt\" stroke-width=\"2.5\"", at[0], at[1], x, y);
    body += svg_dot(" class=\"doubt\" fill=\"currentColor\"", x, y, 3.5);
    body += svg_text(x + 6.0, y - 4.0, std::to_string(c));
  }
  return "<svg class=\"plot\" role=\"img\" aria-label=\"structure with recommended sensors and "
         "detectable damage\" viewBox=\"0 0 " +
         fixed(kDiagramWidth, 0) + " " + fixed(view.height(), 0) + "\">\n" + body + "</svg>\n" +
         "<p>Arrows: recommended sensors with their number and direction. Small points: other "
         "candidates. The darker a location, the smaller the damage that the test detects there "
         "with probability 0.9.</p>\n";
}

std::string polyline(const Plot& plot, const std::vector<std::pair<double, double>>& points,
                     const std::string& kind) {
  std::string d;
  for (const auto& [x, y] : points)
    d += (d.empty() ? "M" : "L") + fixed(plot.x(x), 1) + " " + fixed(plot.y(y), 1);
  return "<path class=\"" + kind + "\" d=\"" + d + "\"/>\n";
}

/// Chart of the smallest detectable severity along the beam, with 95 % intervals.
std::string curve_along(const Report& plan) {
  const Report& list = plan.at("smallest_detectable");
  if (list.empty() || list[0].contains("member") || !list[0].contains("location")) return {};
  const std::string key = severity_of(plan, 0);
  double end = 0.0, most = 0.0;
  for (std::size_t i = 0; i < list.size(); ++i) {
    end = std::max(end, list[i].at("location").get<double>());
    const Report& severities = plan.at("detection_map")[i].at("severities");
    if (!severities.back().is_null()) most = std::max(most, severities.back().get<double>());
  }
  const Plot plot(0.0, end, 0.0, most, 240.0);
  std::string inside;
  std::vector<std::pair<double, double>> run;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (list[i].at("kind") != list[0].at("kind")) continue;
    const double x = list[i].at("location").get<double>();
    if (list[i].at(key).is_null()) {
      inside += polyline(plot, run, "line");
      run.clear();
      inside += svg_dot(" class=\"chosen\"", plot.x(x), plot.y(most), 2.5);
      continue;
    }
    run.emplace_back(x, list[i].at(key).get<double>());
    const auto bound = [&](const char* which, double otherwise) {
      return list[i].at(which).is_null() ? otherwise : list[i].at(which).get<double>();
    };
    inside += svg_line(" class=\"spectrum\"", plot.x(x), plot.y(bound("low", 0.0)), plot.x(x),
                       plot.y(bound("high", most)));
  }
  inside += polyline(plot, run, "line");
  return plot.framed("smallest " + key + " detected with probability 0.9", "location [m]", key,
                     inside) +
         "<p>Line: smallest " + escaped(key) +
         " detected with probability 0.9; grey: 95 % intervals. Circles at the upper edge: not "
         "detected.</p>\n";
}

/// Chart of P(detected) against severity at the easiest, a typical and the hardest location.
std::string detection_curves(const Report& plan) {
  const Report& map = plan.at("detection_map");
  if (map.empty()) return {};
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map[i].at("kind") != map[0].at("kind") || map[i].at("severities").size() < 2) continue;
    double sum = 0.0;
    for (const Report& p : map[i].at("detection")) sum += p.get<double>();
    order.emplace_back(-sum, i);
  }
  if (order.empty()) return {};
  std::ranges::sort(order);
  const std::string key = severity_of(plan, 0);
  const Report& severities = map[order[0].second].at("severities");
  const Plot plot(severities.front().get<double>(), severities.back().get<double>(), 0.0, 1.0,
                  240.0);
  std::string inside, words;
  const std::array<std::size_t, 3> chosen = {0, order.size() / 2, order.size() - 1};
  const std::array<const char*, 3> names = {"easiest location", "typical location",
                                            "hardest location"};
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    const Report& row = map[order[chosen[k]].second];
    std::vector<std::pair<double, double>> points;
    for (std::size_t i = 0; i < row.at("severities").size(); ++i)
      points.emplace_back(row.at("severities")[i].get<double>(),
                          row.at("detection")[i].get<double>());
    inside += polyline(plot, points, "line");
    const auto& [x, y] = points[points.size() / 2];
    inside += svg_text(plot.x(x) + 4.0, plot.y(y) - 4.0, std::to_string(k + 1));
    words += (k > 0 ? "; " : "") + std::to_string(k + 1) + ": " + names[k] + ", " +
             escaped(row.at("place").get<std::string>());
  }
  return plot.framed("probability of detection", key, "P(detected)", inside) + "<p>" + words +
         ".</p>\n";
}

std::string design_table(const Report& plan, const std::vector<const Report*>& rows, bool sensors) {
  std::string out = "<div class=\"scroll\"><table><tr><th>design</th>" +
                    std::string(sensors ? "<th>sensors</th>" : "") +
                    "<th>information [nat]</th><th>detected</th><th>right location</th></tr>\n";
  for (const Report* d : rows) {
    const auto cell = [&](const char* key) {
      return percent(d->at(key).get<double>(), d->at("mcse").at(key).get<double>());
    };
    out += "<tr><td>" + escaped(d->at("name").get<std::string>()) + "</td>" +
           (sensors ? "<td class=\"odd\" style=\"color:inherit\">" +
                          escaped(sensors_in_words(plan, *d)) + "</td>"
                    : "") +
           "<td>" + significant(d->at("information").get<double>(), 4) + " ± " +
           significant(d->at("mcse").at("information").get<double>(), 1) + "</td><td>" +
           cell("detection") + "</td><td>" + cell("right_place") + "</td></tr>\n";
  }
  return out + "</table></div>\n";
}

std::vector<const Report*> pointers(const Report& list) {
  std::vector<const Report*> out;
  for (const Report& d : list) out.push_back(&d);
  return out;
}

std::string further_sensors(const Report& plan) {
  const Report& path = plan.at("by_sensors");
  if (path.size() < 3) return {};
  double most = 0.0;
  std::vector<std::pair<double, double>> points;
  for (const Report& d : path) {
    points.emplace_back(static_cast<double>(d.at("sensors").size()),
                        d.at("information").get<double>());
    most = std::max(most, points.back().second);
  }
  const Plot plot(0.0, points.back().first, 0.0, 1.05 * most, 220.0);
  return "<h3>Number of sensors</h3>\n" +
         plot.framed("information by number of sensors", "sensors", "information [nat]",
                     polyline(plot, points, "line")) +
         design_table(plan, pointers(path), true);
}

std::string value_section(const Report& plan) {
  if (!plan.contains("value")) return {};
  std::string out = "<h2>Value of the test</h2>\n";
  for (const std::string& text : value_sentences(plan)) out += "<p>" + escaped(text) + "</p>\n";
  out +=
      "<div class=\"scroll\"><table><tr><th>test</th><th>cost of the test</th><th>saving</th>"
      "<th>best false-alarm probability</th><th>detected</th></tr>\n";
  for (const Report& o : plan.at("value").at("options"))
    out += "<tr><td>" + escaped(o.at("name").get<std::string>()) + "</td><td>" +
           significant(o.at("test_cost").get<double>(), 4) + "</td><td>" +
           significant(o.at("saving").get<double>(), 4) + " ± " +
           significant(o.at("mcse").get<double>(), 1) + "</td><td>" +
           percent(o.at("false_alarm").get<double>()) + "</td><td>" +
           percent(o.at("detection").get<double>()) + "</td></tr>\n";
  return out + "</table></div>\n";
}

}  // namespace

std::string plan_page(const Report& summary) {
  const Report& plan = summary.at("plan");
  std::string out =
      page_head(summary.at("title").get<std::string>(), plan_headline(plan), plan_details(plan));
  out += "<h2>Recommended design</h2>\n" + drawing(plan) + curve_along(plan) +
         "<p>damage.json in this folder is a damage case with the sensors of this design.</p>\n";
  out += "<h2>Probability of detection</h2>\n" + detection_curves(plan);
  std::vector<const Report*> designs = pointers(plan.at("designs"));
  for (const Report& d : plan.at("others")) designs.push_back(&d);
  designs.push_back(&plan.at("frequencies_alone"));
  out +=
      "<h2>Ranking of designs</h2>\n" + design_table(plan, designs, true) +
      "<p>The designs are sorted by the probability of the right location. Information: expected "
      "information about count and location. Detected: P(at least one damage) exceeds a "
      "threshold. Tests of the intact structure exceed this threshold with the false-alarm "
      "probability. ± is one Monte Carlo standard error.</p>\n";
  out += "<h2>Value of more sensors, longer records, more modes</h2>\n" + further_sensors(plan);
  for (const auto& [key, title] :
       {std::pair{"by_length", "Length of the record"}, std::pair{"by_modes", "Number of modes"},
        std::pair{"by_mass", "Added masses"}})
    if (!plan.at(key).empty())
      out += "<h3>" + std::string(title) + "</h3>\n" +
             design_table(plan, pointers(plan.at(key)), false);
  out += value_section(plan);
  if (const std::string words = check_sentence(plan); !words.empty())
    out += "<h2>Check by the full engine</h2>\n<p>" + escaped(words) + "</p>\n";
  const Report& warnings = summary.at("diagnostics").at("warnings");
  out += "<h2 id=\"warnings\">Warnings</h2>\n";
  if (warnings.empty()) out += "<p>No warnings.</p>\n";
  for (const Report& w : warnings)
    out += "<p class=\"odd\">" + escaped(w.get<std::string>()) + "</p>\n";
  return out + page_end();
}

}  // namespace wheeltap::apps
