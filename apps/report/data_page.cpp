#include "apps/report/data_page.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "apps/report/svg_plot.hpp"
#include "apps/words.hpp"
#include "base/number.hpp"

namespace wheeltap::apps {
namespace {

constexpr std::size_t kColumns = 480;  // largest number of pixel columns

std::string with_unit(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : name + " [" + unit + "]";
}

/// The lowest and highest value of each column of pixels.
std::string data_envelope(const Plot& plot, const std::vector<double>& values,
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
      begun = false;  // gap: start a new line
      continue;
    }
    const std::string x = fixed(plot.x(at((from + to - 1) / 2)), 1);
    path += (begun ? "L" : "M") + x + " " + fixed(plot.y(high), 1);
    if (low < high) path += "L" + x + " " + fixed(plot.y(low), 1);
    begun = true;
  }
  return path;
}

std::string channel_history(const MeasuredTable& table, const MeasuredChannel& channel) {
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
                    with_unit(channel.name, channel.unit), data_envelope(plot, channel.values, at),
                    {});
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
      data_envelope(plot, level, [&](std::size_t i) { return s.frequencies_hz[i]; }), marks);
}

std::string table_in_words(const MeasuredTable& table) {
  const std::size_t channels = table.channels.size();
  std::string text = std::to_string(channels) + (channels == 1 ? " channel, " : " channels, ") +
                     base::grouped(table.rows()) + (table.is_time ? " samples" : " rows");
  if (table.sample_rate_hz)
    text += " at " + base::significant(*table.sample_rate_hz, 6) + " Hz (" +
            base::significant(static_cast<double>(table.rows()) / *table.sample_rate_hz, 4) + " s)";
  return text;
}

std::string file_headline(const MeasuredFile& file) {
  if (file.tables.empty()) return "No table of measured channels";
  std::string text = table_in_words(file.tables[0]);
  if (file.tables.size() > 1)
    text += ", and " + std::to_string(file.tables.size() - 1) + " further tables";
  return text;
}

std::vector<std::string> file_details(const MeasuredFile& file) {
  std::size_t odd = 0;
  std::vector<std::string> names;
  for (const MeasuredTable& table : file.tables) {
    for (const MeasuredChannel& channel : table.channels) {
      if (oddities(table, channel).empty()) continue;
      ++odd;
      if (names.size() < 5) names.push_back(channel.name);
    }
  }
  std::vector<std::string> out{"Format: " + file.format + "."};
  if (odd == 0)
    out.emplace_back("No dropouts, spikes, offsets or drift were found.");
  else
    out.push_back(std::to_string(odd) + (odd == 1 ? " channel has" : " channels have") +
                  " a remark: " + in_words(names) + (odd > names.size() ? ", and others." : "."));
  return out;
}

}  // namespace

std::string data_page(const MeasuredFile& file) {
  const std::string title = file.path.filename().string();
  std::string out = page_head(title, file_headline(file), file_details(file));
  for (const MeasuredTable& table : file.tables) {
    if (file.tables.size() > 1) out += "<p>" + table_in_words(table) + ".</p>\n";
    for (const std::string& text : reading_in_words(table)) out += "<p>" + escaped(text) + "</p>\n";
    if (!table.sampling_fault.empty())
      out += "<p class=\"odd\">" + escaped(table.sampling_fault) + "</p>\n";
    for (const MeasuredChannel& channel : table.channels) {
      const signals::ChannelQuality& q = channel.quality;
      out += "<h2>" + escaped(with_unit(channel.name, channel.unit)) + "</h2>\n";
      const std::string unit = channel.unit.empty() ? "" : " " + escaped(channel.unit);
      out += "<p>Root mean square " + base::significant(q.rms, 4) + unit + ", mean " +
             base::significant(q.mean, 3) + unit + ", from " + base::significant(q.lowest, 4) +
             " to " + base::significant(q.highest, 4) + unit + ".</p>\n";
      const auto odd = oddities(table, channel);
      if (!odd.empty()) {
        out += "<ul class=\"odd\">";
        for (const std::string& text : odd) out += "<li>The channel " + escaped(text) + ".</li>";
        out += "</ul>\n";
      }
      out += "<div class=\"pair\">";
      if (q.missing < q.samples) out += channel_history(table, channel);
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
  return out + page_end();
}

}  // namespace wheeltap::apps
