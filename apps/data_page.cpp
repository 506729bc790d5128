#include "apps/data_page.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "apps/words.hpp"
#include "base/number.hpp"
#include "io/text.hpp"

namespace wheeltap::apps {
namespace {

constexpr double kWidth = 560.0, kHeight = 180.0, kLeft = 64.0, kBottom = 34.0, kTop = 10.0;
constexpr std::size_t kColumns = 480;  // of pixels that hold data

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

std::string with_unit(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : name + " [" + unit + "]";
}

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

/// Axes and a line; marks are vertical hairs.
class Plot {
 public:
  Plot(double x0, double x1, double y0, double y1) : x0_(x0), x1_(x1), y0_(y0), y1_(y1) {
    if (!(x1_ > x0_)) x1_ = x0_ + 1.0;
    if (!(y1_ > y0_)) {
      y0_ -= 1.0;
      y1_ += 1.0;
    }
  }
  [[nodiscard]] double x(double value) const {
    return kLeft + (value - x0_) / (x1_ - x0_) * (kWidth - kLeft - 8.0);
  }
  [[nodiscard]] double y(double value) const {
    return kHeight - kBottom - (value - y0_) / (y1_ - y0_) * (kHeight - kBottom - kTop);
  }
  [[nodiscard]] std::string drawn(const std::string& label, const std::string& horizontal,
                                  const std::string& vertical, const std::string& path,
                                  const std::vector<double>& marks) const {
    std::string out = "<svg role=\"img\" aria-label=\"" + escaped(label) + "\" viewBox=\"0 0 " +
                      fixed(kWidth, 0) + " " + fixed(kHeight, 0) + "\">\n";
    for (const double t : ticks(x0_, x1_, 6))
      out += "<path class=\"grid\" d=\"M" + fixed(x(t), 1) + " " + fixed(kTop, 1) + "V" +
             fixed(kHeight - kBottom, 1) + "\"/><text text-anchor=\"middle\" x=\"" +
             fixed(x(t), 1) + "\" y=\"" + fixed(kHeight - kBottom + 13.0, 1) + "\">" +
             base::significant(t, 4) + "</text>\n";
    for (const double t : ticks(y0_, y1_, 4))
      out += "<path class=\"grid\" d=\"M" + fixed(kLeft, 1) + " " + fixed(y(t), 1) + "H" +
             fixed(kWidth - 8.0, 1) + "\"/><text text-anchor=\"end\" x=\"" + fixed(kLeft - 5.0, 1) +
             "\" y=\"" + fixed(y(t) + 4.0, 1) + "\">" + base::significant(t, 4) + "</text>\n";
    for (const double m : marks)
      out += "<path class=\"mark\" d=\"M" + fixed(x(m), 1) + " " + fixed(kTop, 1) + "V" +
             fixed(kHeight - kBottom, 1) + "\"/>\n";
    out += "<path class=\"line\" d=\"" + path + "\"/>\n";
    out += "<text text-anchor=\"middle\" x=\"" + fixed(0.5 * (kLeft + kWidth), 1) + "\" y=\"" +
           fixed(kHeight - 5.0, 1) + "\">" + escaped(horizontal) + "</text>\n";
    out += "<text transform=\"translate(12 " + fixed(0.5 * (kHeight - kBottom), 1) +
           ") rotate(-90)\" text-anchor=\"middle\">" + escaped(vertical) + "</text>\n";
    return out + "</svg>\n";
  }

 private:
  double x0_, x1_, y0_, y1_;
};

/// The lowest and highest value of each column of pixels.
std::string envelope(const Plot& plot, const std::vector<double>& values,
                     const std::function<double(std::size_t)>& at) {
  std::string path;
  const std::size_t n = values.size(), columns = std::min(n, 2 * kColumns);
  bool begun = false;
  for (std::size_t c = 0; c < columns; ++c) {
    const std::size_t from = n * c / columns, to = std::max(from + 1, n * (c + 1) / columns);
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t i = from; i < to; ++i) {
      if (!std::isfinite(values[i])) continue;
      low = std::min(low, values[i]);
      high = std::max(high, values[i]);
    }
    if (low > high) {
      begun = false;  // a gap
      continue;
    }
    const std::string x = fixed(plot.x(at((from + to - 1) / 2)), 1);
    path += (begun ? "L" : "M") + x + " " + fixed(plot.y(high), 1);
    if (low < high) path += "L" + x + " " + fixed(plot.y(low), 1);
    begun = true;
  }
  return path;
}

std::string history(const MeasuredTable& table, const MeasuredChannel& channel) {
  const std::size_t n = channel.values.size();
  const std::function<double(std::size_t)> at = [&](std::size_t i) {
    if (!table.x.empty()) return table.x[i];
    const auto sample = static_cast<double>(i);
    return table.sample_rate_hz ? sample / *table.sample_rate_hz : sample;
  };
  const std::string unit =
      !table.x.empty() ? table.abscissa_unit : (table.sample_rate_hz ? "s" : "");
  const std::string abscissa =
      !table.abscissa.empty() ? table.abscissa : (table.sample_rate_hz ? "time" : "sample");
  const Plot plot(at(0), at(n - 1), channel.quality.lowest, channel.quality.highest);
  return plot.drawn(channel.name + " over " + abscissa, with_unit(abscissa, unit),
                    with_unit(channel.name, channel.unit), envelope(plot, channel.values, at), {});
}

std::string spectrum(const MeasuredChannel& channel) {
  const signals::Spectrum& s = *channel.spectrum;
  std::vector<double> level;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double d : s.density) {
    level.push_back(d > 0.0 ? 10.0 * std::log10(d) : std::numeric_limits<double>::quiet_NaN());
    if (d > 0.0) {
      low = std::min(low, level.back());
      high = std::max(high, level.back());
    }
  }
  const Plot plot(s.frequencies_hz.front(), s.frequencies_hz.back(), low, high);
  std::vector<double> marks;
  for (const signals::SpectrumPeak& p : channel.peaks) marks.push_back(p.frequency_hz);
  return plot.drawn(
      "power spectral density of " + channel.name, "frequency [Hz]",
      "dB re 1 " + (channel.unit.empty() ? std::string("unit") : channel.unit) + "²/Hz",
      envelope(plot, level, [&](std::size_t i) { return s.frequencies_hz[i]; }), marks);
}

constexpr const char* kStyle = R"(
:root { color-scheme: light dark; }
body { font: 15px/1.5 system-ui, sans-serif; max-width: 72rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.1rem; margin: 2rem 0 .25rem; overflow-wrap: anywhere; }
p, ul { margin: .25rem 0; } .odd { color: light-dark(#9a3412, #fdba74); }
.pair { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(30rem, 100%), 1fr)); gap: 1rem; }
svg { width: 100%; height: auto; } svg text { font: 11px system-ui, sans-serif; fill: currentColor; }
.grid { stroke: light-dark(#e2e8f0, #334155); fill: none; }
.line { stroke: light-dark(#1d4ed8, #93c5fd); fill: none; stroke-width: 1; }
.mark { stroke: light-dark(#dc2626, #f87171); fill: none; stroke-dasharray: 3 3; }
)";

}  // namespace

std::string data_page(const MeasuredFile& file) {
  const std::string title = file.path.filename().string();
  std::string out =
      "<!doctype html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
      "<title>" +
      escaped(title) + "</title><style>" + kStyle + "</style></head>\n<body>\n<h1>" +
      escaped(title) + "</h1>\n<p>" + escaped(file.format) + "</p>\n";
  for (const MeasuredTable& table : file.tables) {
    std::string about = base::grouped(table.rows()) + " rows";
    if (table.sample_rate_hz)
      about += " at " + base::significant(*table.sample_rate_hz, 6) + " Hz (" +
               base::significant(static_cast<double>(table.rows()) / *table.sample_rate_hz, 4) +
               " s)";
    out += "<p>" + about + ".</p>\n";
    if (!table.sampling_fault.empty())
      out += "<p class=\"odd\">" + escaped(table.sampling_fault) + "</p>\n";
    for (const MeasuredChannel& channel : table.channels) {
      const signals::ChannelQuality& q = channel.quality;
      out += "<h2>" + escaped(with_unit(channel.name, channel.unit)) + "</h2>\n";
      out += "<p>Root mean square " + base::significant(q.rms, 4) + ", mean " +
             base::significant(q.mean, 3) + ", from " + base::significant(q.lowest, 4) + " to " +
             base::significant(q.highest, 4) + ".</p>\n";
      const auto odd = oddities(table, channel);
      if (!odd.empty()) {
        out += "<ul class=\"odd\">";
        for (const std::string& text : odd) out += "<li>The channel " + escaped(text) + ".</li>";
        out += "</ul>\n";
      }
      out += "<div class=\"pair\">";
      if (q.missing < q.samples) out += history(table, channel);
      if (channel.spectrum) out += spectrum(channel);
      out += "</div>\n";
      if (!channel.peaks.empty()) {
        std::vector<std::string> peaks;
        for (const signals::SpectrumPeak& p : channel.peaks)
          peaks.push_back(base::significant(p.frequency_hz, 4));
        out += "<p>Peaks of the spectrum at " + in_words(peaks) + " Hz.</p>\n";
      }
    }
  }
  return out + "</body>\n</html>\n";
}

}  // namespace wheeltap::apps
