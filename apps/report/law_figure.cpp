#include "apps/report/law_figure.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apps/law_words.hpp"
#include "apps/report/svg_plot.hpp"
#include "apps/words.hpp"

namespace wheeltap::apps {
namespace {

using dynamics::CyclePoint;

struct Line {
  std::string name;  ///< empty for a single line
  std::vector<CyclePoint> points;
};

struct Axis {
  std::string title;
  double limit = 1.0;  ///< the axis goes from -limit to limit
  double step = 1.0;   ///< distance of the ticks
  double scale = 1.0;  ///< from SI to the unit of the ticks
};

constexpr double kFigureWidth = 250.0, kPanelHeight = 180.0;  // inside of a panel [px]
constexpr double kPanelLeft = 62.0, kPanelTop = 14.0, kBelow = 44.0, kApart = 28.0;

std::vector<Line> lines_of(const dynamics::LawInfo& info) {
  std::vector<dynamics::Coefficient> coefficients;
  for (int i = 0; i < info.size(); ++i) {
    const auto& c = info.coefficients[static_cast<std::size_t>(i)];
    coefficients.emplace_back(c.required() ? c.example : c.otherwise);
  }
  const auto line = [&](const char* name, dynamics::Side side) {
    return Line{name, law_cycle(dynamics::make_law(info.name, coefficients, side), kPictured)};
  };
  if (!info.one_sided) return {line("", dynamics::Side::opening)};
  return {line("opening", dynamics::Side::opening), line("closing", dynamics::Side::closing)};
}

/// True if the tension of a law without memory differs between opening and closing.
bool depends_on_rate(const dynamics::LawInfo& info, const std::vector<CyclePoint>& points) {
  // The cycle starts at e = 0: points i and n/2 - i have equal extensions and opposite rates.
  const std::size_t half = (points.size() - 1) / 2, i = half / 4;
  return !info.memory && std::abs(points[i].tension - points[half - i].tension) >
                             1e-6 * (std::abs(points[i].tension) + 1e-300);
}

std::string panel(double left, const Axis& across, const Axis& up, const std::vector<Line>& lines,
                  double CyclePoint::*abscissa) {
  const auto x = [&](double v) { return left + kFigureWidth * (0.5 + 0.5 * v / across.limit); };
  const auto y = [&](double v) { return kPanelTop + kPanelHeight * (0.5 - 0.5 * v / up.limit); };
  std::string svg;
  const auto stroke_of = [](double v) {
    return "stroke=\"" + std::string(v == 0.0 ? "#888" : "#e4e4e4") + "\"";
  };
  const auto each_tick = [](const Axis& axis, const auto& draw) {
    const int n = static_cast<int>(std::floor(axis.limit * axis.scale / axis.step + 1e-9));
    for (int i = -n; i <= n; ++i) {
      draw(i * axis.step / axis.scale, i == 0 ? "0" : significant(i * axis.step, 3));
    }
  };
  const double bottom = kPanelTop + kPanelHeight;
  each_tick(across, [&](double v, const std::string& label) {
    svg += svg_line(stroke_of(v), x(v), kPanelTop, x(v), bottom) +
           svg_text(x(v), bottom + 16, label, kMiddle);
  });
  each_tick(up, [&](double v, const std::string& label) {
    svg += svg_line(stroke_of(v), left, y(v), left + kFigureWidth, y(v)) +
           svg_text(left - 6, y(v) + 4, label, kEnd);
  });
  svg += svg_text(left + kFigureWidth / 2, bottom + 36, across.title, kMiddle);
  const std::string middle = fixed(kPanelTop + kPanelHeight / 2, 1), beside = fixed(left - 46, 1);
  svg +=
      svg_text(left - 46, kPanelTop + kPanelHeight / 2, up.title,
               kMiddle + std::string(" transform=\"rotate(-90 " + beside + " " + middle + ")\""));
  for (std::size_t l = 0; l < lines.size(); ++l) {
    const char* colour = l == 0 ? "#1f5fa8" : "#c2571a";
    std::string path;
    for (const CyclePoint& p : lines[l].points) {
      path += (path.empty() ? "M" : "L") + fixed(x(p.*abscissa), 1) + " " + fixed(y(p.tension), 1);
    }
    svg += "<path d=\"" + path + "\" fill=\"none\" stroke=\"" + colour + "\" stroke-width=\"2\"" +
           (l == 0 ? "" : " stroke-dasharray=\"6 3\"") + "/>\n";
    if (!lines[l].name.empty()) {
      svg += svg_text(left + 8, kPanelTop + 16 + 16 * static_cast<double>(l), lines[l].name,
                      std::string(" text-anchor=\"start\" fill=\"") + colour + "\"");
    }
  }
  return svg;
}

}  // namespace

std::string law_figure_name(const dynamics::LawInfo& info) {
  return "law-" + std::string(info.name) + ".svg";
}

std::string law_caption(const dynamics::LawInfo& info) {
  std::string values;
  for (int i = 0; i < info.size(); ++i) {
    const auto& c = info.coefficients[static_cast<std::size_t>(i)];
    values += (values.empty() ? "" : ", ") + std::string(c.symbol) + " = " +
              plain_number(c.required() ? c.example : c.otherwise) +
              (c.unit == "1" ? "" : " " + std::string(c.unit));
  }
  return "Tension for a sinusoidal extension with amplitude 10 mm and frequency 5 Hz; " + values;
}

std::string law_figure(const dynamics::LawInfo& info) {
  const std::vector<Line> lines = lines_of(info);
  double largest = 0.0;
  for (const Line& line : lines) {
    for (const CyclePoint& p : line.points) largest = std::max(largest, std::abs(p.tension));
  }
  const Axis tension{
      .title = "tension T [N]", .limit = 1.1 * largest, .step = round_step(largest / 4.0)};
  const double speed = 2.0 * std::numbers::pi * kPictured.amplitude / kPictured.period;
  const bool two = depends_on_rate(info, lines[0].points);
  std::string body = panel(
      kPanelLeft,
      {.title = "extension e [mm]", .limit = 1.1 * kPictured.amplitude, .step = 5.0, .scale = 1e3},
      tension, lines, &CyclePoint::extension);
  if (two) {
    body += panel(2 * kPanelLeft + kFigureWidth + kApart,
                  {.title = "rate ė [m/s]", .limit = 1.1 * speed, .step = round_step(speed / 4.0)},
                  tension, lines, &CyclePoint::rate);
  }
  return svg_sheet((two ? 2.0 : 1.0) * (kPanelLeft + kFigureWidth) + kApart + (two ? 16 : 0),
                   kPanelTop + kPanelHeight + kBelow,
                   std::string(info.name) + ": " + law_caption(info), body);
}

}  // namespace wheeltap::apps
