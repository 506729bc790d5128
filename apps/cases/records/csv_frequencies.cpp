#include "apps/cases/records/csv_frequencies.hpp"

#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>

#include "io/bytes.hpp"
#include "io/file_error.hpp"
#include "io/tables/delimited_text.hpp"
#include "signals/units.hpp"

namespace wheeltap::apps {

namespace {

/// The cells of a delimited text with a header line, as frequencies in Hz. Errors state the line
/// and the column.
class FrequencyText {
 public:
  FrequencyText(std::string bytes, const std::filesystem::path& path)
      : path_(path), text_(std::move(bytes), path, io::FirstRow::header) {
    if (rows() < 1) refuse_header("must have a header line and at least one row");
  }

  [[nodiscard]] int rows() const { return text_.rows(); }
  [[nodiscard]] const std::vector<io::Column>& headers() const { return text_.headers(); }

  [[noreturn]] void refuse_header(const std::string& message) const {
    refuse(text_.header_line(), 0, message);
  }

  /// Index of the column with this header, name or 1-based number; empty if there is none.
  [[nodiscard]] std::optional<std::size_t> find(const std::string& name) const {
    for (std::size_t c = 0; c < headers().size(); ++c) {
      if (headers()[c].header == name || headers()[c].name == name) return c;
    }
    std::size_t index = 0;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), index);
    if (error == std::errc() && end == name.data() + name.size() && index >= 1 &&
        index <= headers().size()) {
      return index - 1;
    }
    return {};
  }
  [[nodiscard]] std::size_t column(const std::string& name) const {
    if (const auto found = find(name)) return *found;
    refuse_header("no column \"" + name + "\" among " + names());
  }
  [[nodiscard]] std::string names() const {
    std::string list;
    for (const io::Column& c : headers()) list += (list.empty() ? "" : ", ") + c.header;
    return list;
  }
  [[nodiscard]] signals::Conversion conversion(std::size_t column) const {
    return signals::conversion_of(signals::unit_of(headers()[column]),
                                  signals::Dimension::frequency);
  }

  /// The cells of a row. Throws Failure if the row has fewer cells than the header, or, with
  /// `exactly`, more.
  [[nodiscard]] std::vector<std::string> cells(int row, std::size_t least, bool exactly) const {
    std::vector<std::string> found = text_.cells(row);
    if (found.size() < least || (exactly && found.size() > headers().size())) {
      refuse(text_.line(row), 0,
             "has " + std::to_string(found.size()) + " cells, the header has " +
                 std::to_string(headers().size()));
    }
    return found;
  }
  /// The number of a cell in Hz; NaN for an empty cell.
  [[nodiscard]] double frequency(int row, std::size_t column, const std::string& cell) const {
    if (cell.empty()) return std::numeric_limits<double>::quiet_NaN();
    const double value = text_.number(cell).value_or(-1.0) * in_hz(column);
    if (std::isnan(value)) return value;
    if (!std::isfinite(value) || value <= 0.0) {
      refuse(text_.line(row), column + 1,
             "\"" + cell + "\": must be a number > 0 in Hz, or empty for a mode not measured");
    }
    return value;
  }
  [[nodiscard]] double frequency(int row, std::size_t column) const {
    return frequency(row, column, cells(row, column + 1, false)[column]);
  }

 private:
  [[noreturn]] void refuse(int line, std::size_t column, const std::string& message) const {
    std::string place = path_.string() + ":" + std::to_string(line);
    if (column > 0) place += ":" + std::to_string(column);
    throw Failure(Exit::bad_input, place + ": " + message);
  }

  [[nodiscard]] double in_hz(std::size_t column) const {
    const signals::Conversion found = conversion(column);
    if (found.basis == signals::Conversion::Basis::foreign)
      refuse(text_.header_line(), column + 1,
             "the unit of \"" + headers()[column].header + "\" must be one of " +
                 signals::known_units(signals::Dimension::frequency) + ", or left out for Hz");
    return found.factor;
  }

  const std::filesystem::path& path_;
  io::DelimitedText text_;
};

/// The columns with a unit of frequency; all columns if no column has a unit of frequency.
std::vector<std::size_t> frequency_columns(const FrequencyText& text) {
  std::vector<std::size_t> all, stated;
  for (std::size_t c = 0; c < text.headers().size(); ++c) {
    all.push_back(c);
    const bool has_unit = !signals::unit_of(text.headers()[c]).empty();
    if (has_unit && text.conversion(c).basis != signals::Conversion::Basis::foreign)
      stated.push_back(c);
  }
  return stated.empty() ? all : stated;
}

}  // namespace

FrequencyTable parse_frequency_csv(std::string bytes, const std::filesystem::path& path,
                                   const FrequencyCells& cells) {
  const FrequencyText text(std::move(bytes), path);
  FrequencyTable table;
  if (cells.columns.empty()) {
    const auto frequency = text.find("frequency");
    const auto sd = text.find("sd");
    if (!frequency) {
      text.refuse_header("no column \"frequency\" among " + text.names() +
                         "; name the columns in the case's data.columns");
    }
    for (int row = 0; row < text.rows(); ++row) {
      table.frequencies_hz.push_back(text.frequency(row, *frequency));
      if (sd) table.sd_hz.push_back(text.frequency(row, *sd));
    }
    return table;
  }
  if (cells.row > text.rows()) {
    text.refuse_header("row " + std::to_string(cells.row) + " is requested, but there are " +
                       std::to_string(text.rows()) + " rows below the header");
  }
  for (const std::string& name : cells.columns)
    table.frequencies_hz.push_back(text.frequency(cells.row - 1, text.column(name)));
  return table;
}

std::vector<std::vector<double>> parse_repeats_csv(std::string bytes,
                                                   const std::filesystem::path& path,
                                                   const std::vector<std::string>& columns) {
  const FrequencyText text(std::move(bytes), path);
  std::vector<std::size_t> chosen;
  for (const std::string& name : columns) chosen.push_back(text.column(name));
  if (columns.empty()) chosen = frequency_columns(text);
  std::vector<std::vector<double>> out;
  for (int row = 0; row < text.rows(); ++row) {
    const std::vector<std::string> cells = text.cells(row, text.headers().size(), true);
    out.emplace_back();
    for (const std::size_t c : chosen) out.back().push_back(text.frequency(row, c, cells[c]));
  }
  return out;
}

std::vector<std::vector<double>> read_repeats_csv(const std::filesystem::path& path,
                                                  const std::vector<std::string>& columns) {
  return parse_repeats_csv(io::read_bytes(path), path, columns);
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
