#include "apps/application/record_view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>
#include <utility>

#include "signals/spectra.hpp"

namespace wheeltap::apps {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kOpen = 2;  // largest number of files in memory
constexpr std::size_t kPeaks = 8;
constexpr long kMostWindowPoints = 20'000;

const MeasuredTable& table_in(const MeasuredFile& file, const RecordWindow& window) {
  if (window.table >= file.tables.size()) throw std::invalid_argument("the file has no such table");
  return file.tables[window.table];
}

const MeasuredChannel& channel_of(const MeasuredTable& table, std::size_t channel) {
  if (channel >= table.channels.size()) throw std::invalid_argument("there is no such channel");
  return table.channels[channel];
}

struct Extremes {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
};

/// The smallest and the largest of the finite values.
Extremes extremes(std::span<const double> values) {
  Extremes out;
  for (const double x : values) {
    if (!std::isfinite(x)) continue;
    out.low = std::min(out.low, x);
    out.high = std::max(out.high, x);
  }
  return out;
}

Report short_number(double x) {
  return std::isfinite(x) ? Report(compact(x)) : Report();
}

double share_of(long part, long all) {
  return all > 0 ? static_cast<double>(part) / static_cast<double>(all) : 0.0;
}

Report checks_of(const MeasuredTable& table) {
  Report out = Report::array();
  for (const MeasuredChannel& channel : table.channels) {
    Report peaks = Report::array();
    for (const signals::SpectrumPeak& peak : channel.peaks)
      if (peaks.size() < kPeaks) peaks.push_back(finite(peak.frequency_hz));
    const bool is_empty = channel.quality.missing == channel.quality.samples;
    out.push_back({{"rms", is_empty ? Report() : finite(channel.quality.rms)},
                   {"faults", oddities(table, channel)},
                   {"peaks_hz", peaks},
                   {"missing", share_of(channel.quality.missing, channel.quality.samples)},
                   {"lowest", is_empty ? Report() : finite(channel.quality.lowest)},
                   {"highest", is_empty ? Report() : finite(channel.quality.highest)}});
  }
  return out;
}

/// The first row of a window of the table, and one past its last row.
std::pair<long, long> rows_of_window(const MeasuredTable& table, const RecordWindow& window) {
  const long begin = std::max(0L, window.begin);
  const long end = std::min(window.end > 0 ? window.end : table.rows(), table.rows());
  if (begin >= end) throw std::invalid_argument("the window has no rows");
  return {begin, end};
}

}  // namespace

std::shared_ptr<const MeasuredFile> OpenRecords::open(const RecordSource& source) {
  const std::lock_guard lock(mutex_);
  return entry_of(source).file;
}

Report OpenRecords::checked(const RecordSource& source) {
  const std::lock_guard one_at_a_time(checking_);
  std::shared_ptr<MeasuredFile> file;
  {
    const std::lock_guard lock(mutex_);
    const Opened& one = entry_of(source);
    if (!one.checked.is_null()) return one.checked;
    file = one.file;
  }
  // This is safe: other requests meanwhile read only the values of the channels.
  signals::check_channels(*file);
  Report tables = Report::array();
  for (const MeasuredTable& table : file->tables) tables.push_back(checks_of(table));
  Report out = {{"tables", tables}};
  const std::lock_guard lock(mutex_);
  for (Opened& one : opened_)
    if (one.file == file) one.checked = out;
  return out;
}

OpenRecords::Opened& OpenRecords::entry_of(const RecordSource& source) {
  const fs::path& path = source.path;
  std::error_code error;
  Opened now{.path = path, .stated = source.stated, .bytes = fs::file_size(path, error)};
  now.changed = fs::last_write_time(path, error);
  const auto is_current = [&](const Opened& one) {
    return one.bytes == now.bytes && one.changed == now.changed;
  };
  const auto found = std::ranges::find_if(opened_, [&](const Opened& one) {
    return one.path == now.path && one.stated == now.stated && is_current(one);
  });
  if (found != opened_.end()) {
    opened_.splice(opened_.begin(), opened_, found);
    return opened_.front();
  }
  std::erase_if(opened_, [&](const Opened& one) { return one.path == path && !is_current(one); });
  while (opened_.size() >= kOpen) opened_.pop_back();  // free memory before another file is read
  now.file = std::make_shared<MeasuredFile>(look_at(path, {.sample_rate_hz = source.sample_rate_hz,
                                                           .layout = source.layout,
                                                           .arrays = source.arrays,
                                                           .resample = source.resample,
                                                           .check = false}));
  opened_.push_front(std::move(now));
  return opened_.front();
}

Report record_contents(const MeasuredFile& file) {
  Report tables = Report::array();
  for (const MeasuredTable& table : file.tables) {
    Report channels = Report::array();
    for (const MeasuredChannel& channel : table.channels)
      channels.push_back({{"name", channel.name},
                          {"unit", channel.unit},
                          {"number", file.universal ? 0 : channel.number}});
    Report one = {{"rows", table.rows()},
                  {"is_time", table.is_time},
                  {"time_column", table.is_time ? table.abscissa : std::string()},
                  {"reading", reading_in_words(table)},
                  {"fault", table.sampling_fault},
                  {"channels", channels},
                  {"left_out", Report::array()}};
    if (table.is_time && !table.x.empty())
      one["times"] = {{"from", finite(table.x.front())},
                      {"to", finite(table.x.back())},
                      {"unit", table.abscissa_unit},
                      {"start", table.layout ? table.layout->start : std::string()}};
    for (const signals::LeftOutColumn& column : table.left_out)
      one["left_out"].push_back({{"name", column.header},
                                 {"number", column.number},
                                 {"is_time_stamp", column.is_time_stamp}});
    if (table.sample_rate_hz) one["sample_rate_hz"] = *table.sample_rate_hz;
    tables.push_back(std::move(one));
  }
  return {{"format", file.format}, {"tables", tables}, {"others", file.others}};
}

Report record_window(const MeasuredFile& file, const RecordWindow& window) {
  const MeasuredTable& table = table_in(file, window);
  const auto [begin, end] = rows_of_window(table, window);
  const long points = std::clamp(window.points, 1L, kMostWindowPoints);
  const long step = (end - begin + points - 1) / points;
  Report channels = Report::array();
  for (const std::size_t c : window.channels) {
    const std::span<const double> all(channel_of(table, c).values);
    Report low = Report::array(), high = Report::array();
    for (long from = begin; from < end; from += step) {
      const long to = std::min({from + step, end, std::ssize(all)});
      const Extremes found = from < to ? extremes(all.subspan(static_cast<std::size_t>(from),
                                                              static_cast<std::size_t>(to - from)))
                                       : Extremes();
      low.push_back(step == 1 ? finite(found.low) : short_number(found.low));
      if (step > 1) high.push_back(short_number(found.high));
    }
    Report one = {{"low", low}};
    if (step > 1) one["high"] = high;
    channels.push_back(std::move(one));
  }
  return {
      {"begin", begin}, {"end", end}, {"step", step}, {"exact", step == 1}, {"channels", channels}};
}

Report record_spectrum(const MeasuredFile& file, const RecordWindow& window) {
  const MeasuredTable& table = table_in(file, window);
  if (window.channels.size() != 1) throw std::invalid_argument("name one channel");
  const std::vector<double>& all = channel_of(table, window.channels[0]).values;
  Report frequencies = Report::array(), density = Report::array();
  const auto [begin, end] = rows_of_window(table, window);
  std::vector<double> x(all.begin() + begin, all.begin() + std::min(end, std::ssize(all)));
  const std::optional<double> rate =
      table.sample_rate_hz ? table.sample_rate_hz : window.sample_rate_hz;
  const bool usable =
      rate && x.size() >= 16 && std::ranges::all_of(x, [](double v) { return std::isfinite(v); });
  if (usable) {
    signals::detrend(x, 0);
    int segment = 16;
    while (static_cast<std::size_t>(segment) * 8 < x.size() && segment < 8192) segment *= 2;
    const signals::Spectrum spectrum = signals::welch(x, *rate, {.segment = segment});
    for (std::size_t i = 0; i < spectrum.density.size(); ++i) {
      frequencies.push_back(compact(spectrum.frequencies_hz[i]));
      density.push_back(short_number(spectrum.density[i]));
    }
  }
  return {{"frequencies_hz", frequencies}, {"density", density}};
}

}  // namespace wheeltap::apps
