#include "apps/cases/records/measured_file.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "apps/cases/records/record_reading.hpp"
#include "apps/words.hpp"
#include "base/number.hpp"
#include "io/bytes.hpp"
#include "io/formats/formats.hpp"
#include "signals/units.hpp"

namespace wheeltap::apps {
namespace {

constexpr int kPeaks = 8;
constexpr long kRecord = 1000;     // rows of what is taken for a record though it says no rate
constexpr std::size_t kShown = 5;  // dropouts or spikes that are named

MeasuredChannel channel_of(const std::string& name, const std::string& unit,
                           std::vector<double> values) {
  MeasuredChannel out{.name = name, .unit = unit, .values = std::move(values)};
  out.quality = signals::channel_quality(out.values);
  return out;
}

// Segments of an eighth of the record: lines narrow enough for peaks, and some to average.
void add_spectrum(MeasuredChannel& channel, double rate) {
  const signals::ChannelQuality& q = channel.quality;
  if (q.missing > 0 || q.constant || q.samples < 64) return;
  int segment = 64;
  while (segment * 8 <= q.samples && segment < 65536) segment *= 2;
  channel.spectrum = signals::welch(channel.values, rate, {.segment = segment});
  // The lowest lines hold what is left of the mean.
  signals::Spectrum rest = *channel.spectrum;
  const auto from = std::min<std::size_t>(2, rest.density.size() - 1);
  rest.density.erase(rest.density.begin(),
                     rest.density.begin() + static_cast<std::ptrdiff_t>(from));
  rest.frequencies_hz.erase(rest.frequencies_hz.begin(),
                            rest.frequencies_hz.begin() + static_cast<std::ptrdiff_t>(from));
  channel.peaks = signals::spectrum_peaks(rest, kPeaks);
}

// Columns of texts are named; so are further time stamps, which are no channels.
std::vector<std::string> left_out(const signals::Record& record, int time) {
  std::vector<std::string> out;
  for (std::size_t c = 0; c < record.columns.size(); ++c) {
    const io::Column& column = record.columns[c];
    if (static_cast<int>(c) == time || column.cells == io::CellKind::number) continue;
    out.push_back(
        "Column " + std::to_string(c + 1) + " (" + column.header + ") holds " +
        (column.cells == io::CellKind::text ? "texts or nothing" : "further time stamps") +
        " and is left out" +
        (column.cells == io::CellKind::text && time < 0
             ? "; if they are times, state their form by --time-format"
             : "") +
        ".");
  }
  return out;
}

MeasuredTable table_of(io::Columns columns, std::optional<double> stated, bool resample = false) {
  signals::Record record;
  static_cast<io::Columns&>(record) = std::move(columns);
  MeasuredTable out;
  out.sample_rate_hz = stated;
  out.layout = record.layout;
  const int time = record.find_time();
  out.left_out = left_out(record, time);
  if (resample && time >= 0) record = signals::resampled(record, time, stated);
  if (time >= 0) {
    const io::Column& column = record.columns[static_cast<std::size_t>(time)];
    out.abscissa = column.name;
    out.abscissa_unit = column.unit;
    out.x = column.values;
    try {
      out.sampling = signals::sampling_of(record, time, stated);
      out.sample_rate_hz = out.sampling.rate_hz;
      if (out.abscissa_unit.empty()) out.abscissa_unit = out.sampling.unit;
    } catch (const io::FileError& error) {
      out.sampling_fault = error.what();
      out.sample_rate_hz.reset();
    }
  }
  if (time < 0 && !stated)
    if (const std::optional<signals::Sampling> said = signals::sampling_from_header(record)) {
      out.sampling = *said;
      out.sample_rate_hz = said->rate_hz;
    }
  for (std::size_t c = 0; c < record.columns.size(); ++c) {
    if (static_cast<int>(c) == time || record.columns[c].values.empty() ||
        record.columns[c].cells != io::CellKind::number)
      continue;
    io::Column& column = record.columns[c];
    std::string unit = signals::unit_of(column);
    if (std::string possible = signals::possible_unit_of(column); !possible.empty())
      out.possible_units.push_back(
          column.name + ": if its numbers are in " + possible + ", state \"unit\": \"" + possible +
          "\" in its channel, or call it \"" + column.name + " [" + possible + "]\".");
    out.channels.push_back(channel_of(column.name, unit, std::move(column.values)));
    if (out.sample_rate_hz) add_spectrum(out.channels.back(), *out.sample_rate_hz);
  }
  return out;
}

// Functions of one abscissa make one table.
std::vector<MeasuredTable> tables_of(const io::UniversalFile& file,
                                     const std::filesystem::path& path) {
  constexpr int kTime = 17;
  std::vector<MeasuredTable> out;
  std::vector<bool> taken(file.functions.size());
  for (std::size_t i = 0; i < file.functions.size(); ++i) {
    if (taken[i]) continue;
    io::UniversalFile together{.units = file.units};
    const io::UniversalFunction& first = file.functions[i];
    for (std::size_t j = i; j < file.functions.size(); ++j) {
      const io::UniversalFunction& f = file.functions[j];
      const bool same = f.type == first.type && f.even == first.even && f.first == first.first &&
                        f.step == first.step && f.y.size() == first.y.size() &&
                        (f.even || f.x == first.x);
      if (taken[j] || !same) continue;
      taken[j] = true;
      together.functions.push_back(f);
    }
    io::Columns columns = io::universal_columns(together, path);
    if (first.type == 1 || first.abscissa.quantity == kTime) {
      columns.columns[0].name = "time";
      out.push_back(table_of(std::move(columns), first.even && first.step > 0.0
                                                     ? std::optional(1.0 / first.step)
                                                     : std::nullopt));
      continue;
    }
    MeasuredTable table{.abscissa = columns.columns[0].name,
                        .abscissa_unit = columns.columns[0].unit,
                        .x = columns.columns[0].values,
                        .is_time = false};
    std::size_t c = 1;
    for (const io::UniversalFunction& f : together.functions)
      for (int part = 0; part < (f.is_complex ? 2 : 1); ++part, ++c) {
        io::Column& column = columns.columns[c];
        table.channels.push_back(channel_of(column.name, column.unit, std::move(column.values)));
        if (part > 0 || table.x.size() < 8) continue;
        signals::Spectrum power{.frequencies_hz = table.x, .density = {}};
        for (const auto& y : f.y) power.density.push_back(std::norm(y));
        table.channels.back().peaks = signals::spectrum_peaks(power, kPeaks);
      }
    out.push_back(std::move(table));
  }
  return out;
}

std::string where(long sample, std::optional<double> rate) {
  return rate ? base::significant(static_cast<double>(sample) / *rate, 5) + " s"
              : "sample " + std::to_string(sample);
}

}  // namespace

long MeasuredTable::rows() const {
  return !x.empty() ? static_cast<long>(x.size())
                    : (channels.empty() ? 0 : static_cast<long>(channels[0].values.size()));
}

MeasuredFile look_at(const std::filesystem::path& path, const MeasuredReading& reading) {
  if (reading.sample_rate_hz && !(*reading.sample_rate_hz > 0.0))
    throw std::invalid_argument("sample rate = " + base::number(*reading.sample_rate_hz) +
                                ": must be positive");
  constexpr std::size_t kBeginning = 512;
  const io::Format& format = io::format_of(path, io::first_bytes(path, kBeginning));
  MeasuredFile out{.path = path, .format = std::string(format.name)};
  if (format.parse == io::parse_universal_columns) {
    out.universal = io::read_universal_file(path);
    out.tables = tables_of(*out.universal, path);
  } else {
    const io::Wanted no_texts = [](const io::Columns& table, std::size_t column) {
      return table.columns[column].cells != io::CellKind::text;
    };
    io::Columns columns =
        io::read_columns(path, no_texts, io::formats(), reading.layout, reading.arrays);
    out.others = std::move(columns.others);
    out.tables.push_back(table_of(std::move(columns), reading.sample_rate_hz, reading.resample));
  }
  return out;
}

std::vector<std::string> reading_in_words(const MeasuredTable& table) {
  std::vector<std::string> out;
  if (table.layout) out.push_back(layout_in_words(*table.layout));
  for (const std::string& text :
       {sampling_in_words(table.sampling), jitter_in_words(table.sampling)})
    if (!text.empty()) out.push_back(text);
  std::vector<std::string> units;
  for (const MeasuredChannel& c : table.channels) {
    const signals::Conversion conversion = signals::conversion_of(c.unit);
    if (conversion.basis != signals::Conversion::Basis::unit || conversion.factor == 1.0) continue;
    std::string text = conversion_in_words(conversion);
    if (std::ranges::find(units, text) == units.end()) units.push_back(std::move(text));
  }
  if (!units.empty()) {
    std::string text = "Cases convert to SI: ";
    for (std::size_t i = 0; i < units.size(); ++i) text += (i > 0 ? "; " : "") + units[i];
    out.push_back(text + ".");
  }
  for (const std::string& text : table.possible_units) out.push_back(text);
  for (const std::string& text : table.left_out) out.push_back(text);
  return out;
}

std::vector<std::string> oddities(const MeasuredTable& table, const MeasuredChannel& channel) {
  const std::optional<double> rate = table.sample_rate_hz;
  const signals::ChannelQuality& q = channel.quality;
  std::vector<std::string> out;
  if (q.missing > 0)
    out.push_back(std::to_string(q.missing) + " of " + std::to_string(q.samples) +
                  " samples are missing (not a number)");
  if (q.missing == q.samples) return out;
  if (!table.is_time || (!rate && q.samples < kRecord)) return out;  // no record
  if (q.constant) {
    out.push_back("never changes: it stands at " + base::significant(q.mean, 4) +
                  ", as a sensor that is not connected does");
    return out;
  }
  const auto first_of = [&](auto&& list, auto&& begin) {
    std::vector<std::string> places;
    for (std::size_t i = 0; i < std::min(list.size(), kShown); ++i)
      places.push_back(where(begin(list[i]), rate));
    if (list.size() > kShown) places.push_back(std::to_string(list.size() - kShown) + " more");
    return in_words(places);
  };
  if (!q.dropouts.empty()) {
    long samples = 0;
    for (const signals::Stretch& d : q.dropouts) samples += d.end - d.begin;
    out.push_back(
        "stands still " +
        std::string(q.dropouts.size() == 1 ? "once"
                                           : std::to_string(q.dropouts.size()) + " times") +
        " for longer than chance would have it (" + std::to_string(samples) + " samples, from " +
        first_of(q.dropouts, [](const signals::Stretch& d) { return d.begin; }) + "): dropouts?");
  }
  if (q.clipped_high + q.clipped_low > 0)
    out.push_back("is clipped: " + std::to_string(q.clipped_high) + " samples stand on " +
                  base::significant(q.highest, 4) + " and " + std::to_string(q.clipped_low) +
                  " on " + base::significant(q.lowest, 4) + "; its range was too small");
  if (!q.spikes.empty())
    out.push_back("has " + std::to_string(q.spikes.size()) +
                  (q.spikes.size() == 1 ? " spike" : " spikes") + " of a single sample, at " +
                  first_of(q.spikes, [](long s) { return s; }));
  if (std::isinf(q.drift)) return {"counts up evenly: an index or a time rather than a channel"};
  if (std::abs(q.drift) > 1.0)
    out.push_back("drifts: over the record its mean " +
                  std::string(q.drift > 0.0 ? "rises" : "falls") + " by " +
                  base::significant(std::abs(q.drift), 2) + " standard deviations");
  else if (q.wander > 0.3)
    out.push_back("wanders: the means of twenty blocks scatter by " +
                  base::significant(100.0 * q.wander, 2) + " % of its standard deviation");
  if (std::abs(q.mean) > 3.0 * q.sd)
    out.push_back("stands off zero by " + base::significant(std::abs(q.mean) / q.sd, 2) +
                  " of its standard deviations");
  if (q.step > 0.05 * q.sd)
    out.push_back("is coarse: one step of its converter is " +
                  base::significant(100.0 * q.step / q.sd, 2) + " % of its standard deviation");
  return out;
}

}  // namespace wheeltap::apps
