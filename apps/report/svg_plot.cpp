#include "apps/report/svg_plot.hpp"

#include <cmath>

#include "apps/report/assets.hpp"
#include "apps/words.hpp"
#include "base/number.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {
namespace {

constexpr double kWidth = 560.0, kLeft = 64.0, kBottom = 40.0, kTop = 26.0;

/// Round numbers across a range.
std::vector<double> ticks(double low, double high, int about) {
  const double raw = (high - low) / about;
  if (!(raw > 0.0) || !std::isfinite(raw)) return {low};
  const double unit = std::pow(10.0, std::floor(std::log10(raw)));
  double step = 10.0 * unit;
  for (const double s : {1.0, 2.0, 5.0})
    if (s * unit >= raw) {
      step = s * unit;
      break;
    }
  std::vector<double> out;
  for (double t = std::ceil(low / step) * step; t <= high + 1e-9 * step; t += step)
    out.push_back(std::abs(t) < 1e-9 * step ? 0.0 : t);
  return out;
}

// Beside report.css, whose design these pages share.
constexpr const char* kPageStyle = R"(
.odd { color: var(--caution); }
ul.odd { list-style: none; padding: 0; margin: .75rem 0; display: grid; gap: .5rem; }
ul.odd li { color: var(--ink); border-left: 3px solid var(--caution); background: var(--caution-paper); padding: .5rem .9rem;
  border-radius: 0 6px 6px 0; max-width: 54rem; }
main h3 { margin: 1.5rem 0 .25rem; }
.pair { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(26rem, 100%), 1fr)); gap: 1rem 2rem; }
main svg { width: 100%; height: auto; } main svg text { font: 11px system-ui, sans-serif; fill: currentColor; }
svg.plot { max-width: 46rem; display: block; }
.grid { stroke: var(--line); fill: none; } .spectrum { stroke: var(--soft); fill: none; }
.line { stroke: var(--accent); fill: none; stroke-width: 1; }
.pole { fill: var(--soft); } .kept { fill: var(--accent); stroke: var(--accent); }
.chosen { fill: none; stroke: var(--caution); stroke-width: 1.5; }
.line.bar { fill: var(--accent); fill-opacity: .45; } .doubt.bar { fill: var(--caution); fill-opacity: .35; }
.doubt { stroke: var(--caution); fill: none; } .whisker { stroke: currentColor; fill: none; }
.cell { fill: var(--accent); }
td.odd { white-space: normal; min-width: 14rem; text-align: left; }
.small { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(11rem, 100%), 1fr)); gap: .5rem; }
.mark { stroke: var(--caution); fill: none; stroke-dasharray: 3 3; }
.panel { background: #fff; border-radius: 10px; padding: .5rem; max-width: 40rem; }
.panel svg text { fill: #222; }
@media (max-width: 40rem) { svg.plot text { font-size: 16px; } svg.plot .between { display: none; } }
)";

}  // namespace

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : io::printable(text))
    out += c == '<'   ? "&lt;"
           : c == '>' ? "&gt;"
           : c == '&' ? "&amp;"
           : c == '"' ? "&quot;"
                      : std::string(1, c);
  return out;
}

std::string page_head(const std::string& title, const std::string& headline,
                      const std::vector<std::string>& details) {
  std::string out =
      "<!doctype html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
      "<meta name=\"color-scheme\" content=\"light dark\"><link rel=\"icon\" href=\"data:,\">"
      "<title>" +
      escaped(title) + "</title><style>" + std::string(assets::kStyle) + kPageStyle +
      "</style></head>\n<body>\n<header>\n<p class=\"brand\">Wheeltap report</p>\n"
      "<h1 dir=\"auto\">" +
      escaped(title) + "</h1>\n<section class=\"answer\" aria-label=\"The answer\">\n" +
      "<p class=\"headline\">" + escaped(headline) + "</p>\n";
  for (const std::string& detail : details)
    out += "<p class=\"detail\">" + escaped(detail) + "</p>\n";
  return out + "</section>\n</header>\n<main>\n";
}

std::string page_end() {
  return "</main>\n</body>\n</html>\n";
}

Plot::Plot(double x0, double x1, double y0, double y1, double height)
    : x0_(x0), x1_(x1), y0_(y0), y1_(y1), height_(height) {
  if (!(x1_ > x0_)) x1_ = x0_ + 1.0;
  if (!(y1_ > y0_)) {
    y0_ -= 1.0;
    y1_ += 1.0;
  }
}

double Plot::x(double value) const {
  return kLeft + (value - x0_) / (x1_ - x0_) * (kWidth - kLeft - 8.0);
}

double Plot::y(double value) const {
  return height_ - kBottom - (value - y0_) / (y1_ - y0_) * (height_ - kBottom - kTop);
}

std::string Plot::framed(const std::string& label, const std::string& horizontal,
                         const std::string& vertical, const std::string& inside) const {
  std::string out = "<svg class=\"plot\" role=\"img\" aria-label=\"" + escaped(label) +
                    "\" viewBox=\"0 0 " + fixed(kWidth, 0) + " " + fixed(height_, 0) + "\">\n";
  // On narrow screens every second label goes (class "between"), so that larger ones have room.
  int number = 0;
  for (const double t : ticks(x0_, x1_, 6))
    out += "<path class=\"grid\" d=\"M" + fixed(x(t), 1) + " " + fixed(kTop, 1) + "V" +
           fixed(height_ - kBottom, 1) + "\"/><text" +
           (number++ % 2 == 1 ? " class=\"between\"" : "") + " text-anchor=\"middle\" x=\"" +
           fixed(x(t), 1) + "\" y=\"" + fixed(height_ - kBottom + 15.0, 1) + "\">" +
           base::significant(t, 4) + "</text>\n";
  for (const double t : ticks(y0_, y1_, 4))
    out += "<path class=\"grid\" d=\"M" + fixed(kLeft, 1) + " " + fixed(y(t), 1) + "H" +
           fixed(kWidth - 8.0, 1) + "\"/><text text-anchor=\"end\" x=\"" + fixed(kLeft - 5.0, 1) +
           "\" y=\"" + fixed(y(t) + 4.0, 1) + "\">" + base::significant(t, 4) + "</text>\n";
  out += inside;
  out += "<text text-anchor=\"middle\" x=\"" + fixed(0.5 * (kLeft + kWidth), 1) + "\" y=\"" +
         fixed(height_ - 5.0, 1) + "\">" + escaped(horizontal) + "</text>\n";
  out += "<text x=\"4\" y=\"14\">" + escaped(vertical) + "</text>\n";
  return out + "</svg>\n";
}

std::string Plot::hairs(const std::vector<double>& marks) const {
  std::string out;
  for (const double m : marks)
    out += "<path class=\"mark\" d=\"M" + fixed(x(m), 1) + " " + fixed(kTop, 1) + "V" +
           fixed(height_ - kBottom, 1) + "\"/>\n";
  return out;
}

std::string Plot::drawn(const std::string& label, const std::string& horizontal,
                        const std::string& vertical, const std::string& path,
                        const std::vector<double>& marks) const {
  return framed(label, horizontal, vertical,
                hairs(marks) + "<path class=\"line\" d=\"" + path + "\"/>\n");
}

}  // namespace wheeltap::apps
