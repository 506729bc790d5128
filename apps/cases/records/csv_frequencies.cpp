#include "apps/cases/records/csv_frequencies.hpp"

#include <charconv>
#include <cmath>
#include <limits>
#include <sstream>

#include "io/bytes.hpp"
#include "io/file_error.hpp"
#include "io/tables/delimited_text.hpp"
#include "signals/units.hpp"

namespace wheeltap::apps {

FrequencyTable parse_frequency_csv(std::string bytes, const std::filesystem::path& path,
                                   const FrequencyCells& cells) {
  const auto refuse = [&](int line, std::size_t column, const std::string& message) {
    std::string place = path.string() + ":" + std::to_string(line);
    if (column > 0) place += ":" + std::to_string(column);
    throw Failure(Exit::bad_input, place + ": " + message);
  };
  const io::DelimitedText text(std::move(bytes), path, io::FirstRow::header);
  const std::vector<io::Column>& headers = text.headers();
  if (text.rows() < 1)
    refuse(text.header_line(), 0, "must have a header line and at least one row");

  const auto column_of = [&](const std::string& name) -> std::size_t {
    for (std::size_t c = 0; c < headers.size(); ++c) {
      if (headers[c].header == name || headers[c].name == name) return c;
    }
    std::size_t index = 0;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), index);
    if (error == std::errc() && end == name.data() + name.size() && index >= 1 &&
        index <= headers.size()) {
      return index - 1;
    }
    return std::string::npos;
  };
  const auto names = [&] {
    std::string list;
    for (const io::Column& c : headers) list += (list.empty() ? "" : ", ") + c.header;
    return list;
  };
  const auto in_hz = [&](std::size_t column) {
    const std::string unit = signals::unit_of(headers[column]);
    const signals::Conversion found = signals::conversion_of(unit, signals::Dimension::frequency);
    if (found.basis == signals::Conversion::Basis::foreign)
      refuse(text.header_line(), column + 1,
             "the unit of \"" + headers[column].header + "\" must be one of " +
                 signals::known_units(signals::Dimension::frequency) + ", or left out for Hz");
    return found.factor;
  };
  const auto cell = [&](int row, std::size_t column) {
    const std::vector<std::string> found = text.cells(row);
    if (column >= found.size()) {
      refuse(text.line(row), 0,
             "has " + std::to_string(found.size()) + " cells, the header has " +
                 std::to_string(headers.size()));
    }
    if (found[column].empty()) return std::numeric_limits<double>::quiet_NaN();
    const double value = text.number(found[column]).value_or(-1.0) * in_hz(column);
    if (std::isnan(value)) return value;
    if (!std::isfinite(value) || value <= 0.0) {
      refuse(text.line(row), column + 1,
             "\"" + found[column] +
                 "\": must be a number > 0 in Hz, or empty for a mode not measured");
    }
    return value;
  };

  FrequencyTable table;
  if (cells.columns.empty()) {
    const std::size_t frequency = column_of("frequency");
    const std::size_t sd = column_of("sd");
    if (frequency == std::string::npos) {
      refuse(text.header_line(), 0,
             "no column \"frequency\" among " + names() +
                 "; name the columns in the case's data.columns");
    }
    for (int row = 0; row < text.rows(); ++row) {
      table.frequencies_hz.push_back(cell(row, frequency));
      if (sd != std::string::npos) table.sd_hz.push_back(cell(row, sd));
    }
    return table;
  }
  if (cells.row > text.rows()) {
    refuse(text.header_line(), 0,
           "row " + std::to_string(cells.row) + " is requested, but there are " +
               std::to_string(text.rows()) + " rows below the header");
  }
  for (const std::string& name : cells.columns) {
    const std::size_t column = column_of(name);
    if (column == std::string::npos) {
      refuse(text.header_line(), 0, "no column \"" + name + "\" among " + names());
    }
    table.frequencies_hz.push_back(cell(cells.row - 1, column));
  }
  return table;
}

FrequencyTable read_frequency_csv(const std::filesystem::path& path, const FrequencyCells& cells) {
  return parse_frequency_csv(io::read_bytes(path), path, cells);
}

std::string frequency_csv(const FrequencyTable& table, const std::string& comment) {
  std::ostringstream text;
  text.precision(17);
  text << "# " << comment << "\nmode,frequency [Hz],sd [Hz]\n";
  for (std::size_t i = 0; i < table.frequencies_hz.size(); ++i) {
    text << i + 1 << ',' << table.frequencies_hz[i] << ',' << table.sd_hz[i] << '\n';
  }
  return text.str();
}

}  // namespace wheeltap::apps
