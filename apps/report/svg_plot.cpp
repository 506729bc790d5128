#include "apps/report/svg_plot.hpp"

#include <cmath>

#include "apps/report/assets.hpp"
#include "apps/report/report.hpp"
#include "apps/words.hpp"
#include "base/number.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {
namespace {

constexpr double kWidth = 560.0, kLeft = 64.0, kBottom = 40.0, kTop = 26.0;

/// Round numbers in a range, as positions of ticks.
std::vector<double> ticks(double low, double high, int about) {
  const double raw = (high - low) / about;
  if (!(raw > 0.0) || !std::isfinite(raw)) return {low};
  const double step = round_step(raw);
  std::vector<double> out;
  for (double t = std::ceil(low / step) * step; t <= high + 1e-9 * step; t += step)
    out.push_back(std::abs(t) < 1e-9 * step ? 0.0 : t);
  return out;
}

// Styles in addition to report.css.
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
  return html_text(io::printable(text));
}

std::string svg_text(double x, double y, const std::string& words, const std::string& attributes) {
  return "<text x=\"" + fixed(x, 1) + "\" y=\"" + fixed(y, 1) + "\"" + attributes + ">" + words +
         "</text>\n";
}

std::string svg_line(const std::string& attributes, double x0, double y0, double x1, double y1) {
  return "<path d=\"M" + fixed(x0, 1) + " " + fixed(y0, 1) + "L" + fixed(x1, 1) + " " +
         fixed(y1, 1) + "\" " + attributes + "/>\n";
}

std::string svg_dot(const std::string& attributes, double x, double y, double radius) {
  return "<circle cx=\"" + fixed(x, 1) + "\" cy=\"" + fixed(y, 1) + "\" r=\"" + fixed(radius, 1) +
         "\" " + attributes + "/>\n";
}

std::string svg_sheet(double width, double height, const std::string& title,
                      const std::string& body) {
  const std::string w = fixed(width, 0), h = fixed(height, 0);
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + w + "\" height=\"" + h +
         "\" viewBox=\"0 0 " + w + " " + h +
         "\" font-family=\"sans-serif\" font-size=\"12\" fill=\"#222\">\n<title>" + title +
         "</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n" + body + "</svg>\n";
}

double round_step(double least) {
  const double unit = std::pow(10.0, std::floor(std::log10(least)));
  for (const double s : {1.0, 2.0, 5.0})
    if (s * unit >= least) return s * unit;
  return 10.0 * unit;
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
  return "</main>\n<script>\n" + std::string(assets::kExport) + "</script>\n</body>\n</html>\n";
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
  // Narrow screens hide every second label (class "between"), because labels are larger there.
  int number = 0;
  for (const double t : ticks(x0_, x1_, 6))
    out += svg_line("class=\"grid\"", x(t), kTop, x(t), height_ - kBottom) +
           svg_text(x(t), height_ - kBottom + 15.0, base::significant(t, 4),
                    (number++ % 2 == 1 ? " class=\"between\"" : "") + std::string(kMiddle));
  for (const double t : ticks(y0_, y1_, 4))
    out += svg_line("class=\"grid\"", kLeft, y(t), kWidth - 8.0, y(t)) +
           svg_text(kLeft - 5.0, y(t) + 4.0, base::significant(t, 4), kEnd);
  out += inside;
  out += svg_text(0.5 * (kLeft + kWidth), height_ - 5.0, escaped(horizontal), kMiddle);
  out += svg_text(4.0, 14.0, escaped(vertical));
  return out + "</svg>\n";
}

std::string Plot::hairs(const std::vector<double>& marks) const {
  std::string out;
  for (const double m : marks)
    out += svg_line("class=\"mark\"", x(m), kTop, x(m), height_ - kBottom);
  return out;
}

std::string Plot::drawn(const std::string& label, const std::string& horizontal,
                        const std::string& vertical, const std::string& path,
                        const std::vector<double>& marks) const {
  return framed(label, horizontal, vertical,
                hairs(marks) + "<path class=\"line\" d=\"" + path + "\"/>\n");
}

}  // namespace wheeltap::apps
