#include "signals/measured_file.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/number.hpp"
#include "base/parallel.hpp"
#include "io/bytes.hpp"
#include "io/formats/formats.hpp"
#include "signals/units.hpp"

namespace wheeltap::signals {
namespace {

constexpr int kPeaks = 8;
constexpr long kRecord = 1000;  // smallest number of rows of a record without a rate

// The segment length is an eighth of the record. The spectral lines are then narrow enough for
// peaks, and several segments are averaged.
void add_spectrum(MeasuredChannel& channel, double rate) {
  const ChannelQuality& q = channel.quality;
  if (q.missing > 0 || q.constant || q.samples < 64) return;
  int segment = 64;
  while (segment * 8 <= q.samples && segment < 65536) segment *= 2;
  channel.spectrum = welch(channel.values, rate, {.segment = segment});
  // The lowest lines contain the remainder of the mean.
  Spectrum rest = *channel.spectrum;
  const auto from = std::min<std::size_t>(2, rest.density.size() - 1);
  rest.density.erase(rest.density.begin(),
                     rest.density.begin() + static_cast<std::ptrdiff_t>(from));
  rest.frequencies_hz.erase(rest.frequencies_hz.begin(),
                            rest.frequencies_hz.begin() + static_cast<std::ptrdiff_t>(from));
  channel.peaks = spectrum_peaks(rest, kPeaks);
}

// Lists the columns that are not channels: texts and additional time stamps.
std::vector<LeftOutColumn> left_out(const Record& record, int time) {
  std::vector<LeftOutColumn> out;
  for (std::size_t c = 0; c < record.columns.size(); ++c) {
    const io::Column& column = record.columns[c];
    if (static_cast<int>(c) == time || column.cells == io::CellKind::number) continue;
    const bool text = column.cells == io::CellKind::text;
    out.push_back({.number = static_cast<int>(c) + 1,
                   .header = column.header,
                   .is_time_stamp = !text,
                   .maybe_time = text && time < 0});
  }
  return out;
}

MeasuredTable table_of(io::Columns columns, std::optional<double> stated, bool resample = false) {
  Record record;
  static_cast<io::Columns&>(record) = std::move(columns);
  MeasuredTable out;
  out.sample_rate_hz = stated;
  out.layout = record.layout;
  const int time = record.find_time();
  out.left_out = left_out(record, time);
  if (resample && time >= 0) record = resampled(record, time, stated);
  if (time >= 0) {
    const io::Column& column = record.columns[static_cast<std::size_t>(time)];
    out.abscissa = column.name;
    out.abscissa_unit = column.unit;
    out.x = column.values;
    try {
      out.sampling = sampling_of(record, time, stated);
      out.sample_rate_hz = out.sampling.rate_hz;
      if (out.abscissa_unit.empty()) out.abscissa_unit = out.sampling.unit;
    } catch (const io::FileError& error) {
      out.sampling_fault = error.what();
      out.sample_rate_hz.reset();
    }
  }
  if (time < 0 && !stated)
    if (const std::optional<Sampling> stated_sampling = sampling_from_header(record)) {
      out.sampling = *stated_sampling;
      out.sample_rate_hz = stated_sampling->rate_hz;
    }
  for (std::size_t c = 0; c < record.columns.size(); ++c) {
    if (static_cast<int>(c) == time || record.columns[c].values.empty() ||
        record.columns[c].cells != io::CellKind::number)
      continue;
    io::Column& column = record.columns[c];
    std::string unit = unit_of(column);
    std::string possible = possible_unit_of(column);
    out.channels.push_back({.name = column.name,
                            .unit = std::move(unit),
                            .number = static_cast<int>(c) + 1,
                            .possible_unit = std::move(possible),
                            .values = std::move(column.values)});
  }
  return out;
}

// Functions with the same abscissa form one table.
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
        table.channels.push_back(
            {.name = column.name, .unit = column.unit, .values = std::move(column.values)});
        if (part > 0 || table.x.size() < 8) continue;
        Spectrum power{.frequencies_hz = table.x, .density = {}};
        for (const auto& y : f.y) power.density.push_back(std::norm(y));
        table.channels.back().peaks = spectrum_peaks(power, kPeaks);
      }
    out.push_back(std::move(table));
  }
  return out;
}

}  // namespace

long MeasuredTable::rows() const {
  return !x.empty() ? static_cast<long>(x.size())
                    : (channels.empty() ? 0 : static_cast<long>(channels[0].values.size()));
}

bool MeasuredTable::is_record(const MeasuredChannel& channel) const {
  return is_time && (sample_rate_hz || channel.quality.samples >= kRecord);
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
  if (reading.check) check_channels(out);
  return out;
}

void check_channels(MeasuredFile& file) {
  for (MeasuredTable& table : file.tables)
    base::parallel_for(static_cast<int>(table.channels.size()), 0, [&](int c) {
      MeasuredChannel& channel = table.channels[static_cast<std::size_t>(c)];
      channel.quality = channel_quality(channel.values);
      if (table.is_time && table.sample_rate_hz) add_spectrum(channel, *table.sample_rate_hz);
    });
}

}  // namespace wheeltap::signals
