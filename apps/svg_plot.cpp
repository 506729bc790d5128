#include "apps/svg_plot.hpp"

#include <cmath>

#include "apps/words.hpp"
#include "base/number.hpp"
#include "io/text.hpp"

namespace wheeltap::apps {
namespace {

constexpr double kWidth = 560.0, kLeft = 64.0, kBottom = 34.0, kTop = 10.0;

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

constexpr const char* kPageStyle = R"(
:root { color-scheme: light dark; }
body { font: 15px/1.5 system-ui, sans-serif; max-width: 72rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.1rem; margin: 2rem 0 .25rem; overflow-wrap: anywhere; }
p, ul { margin: .25rem 0; } .odd { color: light-dark(#9a3412, #fdba74); }
.pair { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(30rem, 100%), 1fr)); gap: 1rem; }
svg { width: 100%; height: auto; } svg text { font: 11px system-ui, sans-serif; fill: currentColor; }
.grid { stroke: light-dark(#e2e8f0, #334155); fill: none; }
.line { stroke: light-dark(#1d4ed8, #93c5fd); fill: none; stroke-width: 1; }
.pole { fill: light-dark(#94a3b8, #64748b); } .kept { fill: light-dark(#1d4ed8, #93c5fd); stroke: light-dark(#1d4ed8, #93c5fd); }
.chosen { fill: none; stroke: light-dark(#dc2626, #f87171); }
table { border-collapse: collapse; } td, th { padding: .2rem .7rem; text-align: right; }
.line.bar { fill: light-dark(#93b4f5, #3b5b9e); } .doubt.bar { fill: light-dark(#f3c1a5, #7c3a1c); }
.doubt { stroke: light-dark(#c2410c, #fdba74); fill: none; } .whisker { stroke: currentColor; fill: none; }
.cell { fill: light-dark(#1d4ed8, #93c5fd); } table { font-variant-numeric: tabular-nums; } td { white-space: nowrap; } td.odd { white-space: normal; min-width: 14rem; text-align: left; }
.small { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(11rem, 100%), 1fr)); gap: .5rem; }
.scroll { overflow-x: auto; } figure { margin: 0; } figcaption { font-size: .9rem; }
.tools { display: flex; flex-wrap: wrap; gap: .25rem 1rem; } svg.shape { display: block; max-height: 26rem; }
svg.shape path { fill: none; stroke-linejoin: round; stroke-linecap: round; }
svg.shape .rest { stroke: light-dark(#94a3b8, #64748b); stroke-width: var(--unit); }
svg.shape .moving { stroke: light-dark(#1d4ed8, #93c5fd); stroke-width: calc(2.5 * var(--unit)); }
svg.turns { cursor: grab; touch-action: none; } select, button { font: inherit; max-width: 100%; }
.mark { stroke: light-dark(#dc2626, #f87171); fill: none; stroke-dasharray: 3 3; }
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

std::string page_head(const std::string& title) {
  return "<!doctype html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\">"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
         "<title>" +
         escaped(title) + "</title><style>" + kPageStyle + "</style></head>\n<body>\n<h1>" +
         escaped(title) + "</h1>\n";
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
  std::string out = "<svg role=\"img\" aria-label=\"" + escaped(label) + "\" viewBox=\"0 0 " +
                    fixed(kWidth, 0) + " " + fixed(height_, 0) + "\">\n";
  for (const double t : ticks(x0_, x1_, 6))
    out += "<path class=\"grid\" d=\"M" + fixed(x(t), 1) + " " + fixed(kTop, 1) + "V" +
           fixed(height_ - kBottom, 1) + "\"/><text text-anchor=\"middle\" x=\"" + fixed(x(t), 1) +
           "\" y=\"" + fixed(height_ - kBottom + 13.0, 1) + "\">" + base::significant(t, 4) +
           "</text>\n";
  for (const double t : ticks(y0_, y1_, 4))
    out += "<path class=\"grid\" d=\"M" + fixed(kLeft, 1) + " " + fixed(y(t), 1) + "H" +
           fixed(kWidth - 8.0, 1) + "\"/><text text-anchor=\"end\" x=\"" + fixed(kLeft - 5.0, 1) +
           "\" y=\"" + fixed(y(t) + 4.0, 1) + "\">" + base::significant(t, 4) + "</text>\n";
  out += inside;
  out += "<text text-anchor=\"middle\" x=\"" + fixed(0.5 * (kLeft + kWidth), 1) + "\" y=\"" +
         fixed(height_ - 5.0, 1) + "\">" + escaped(horizontal) + "</text>\n";
  out += "<text transform=\"translate(12 " + fixed(0.5 * (height_ - kBottom), 1) +
         ") rotate(-90)\" text-anchor=\"middle\">" + escaped(vertical) + "</text>\n";
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
