#include "apps/cases/records/csv_frequencies.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <sstream>

#include "apps/whole_number.hpp"
#include "base/constants.hpp"
#include "io/bytes.hpp"
#include "io/file_error.hpp"
#include "io/tables/delimited_text.hpp"
#include "io/text/words.hpp"
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
    refuse_line(text_.header_line(), 0, message);
  }

  /// Index of the column with this name or 1-based number; empty if no column has it.
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

  /// The cells of a row. Throws Failure if the row has fewer cells than the header; with `exactly`,
  /// also if it has more.
  [[nodiscard]] std::vector<std::string> cells(int row, std::size_t least, bool exactly) const {
    std::vector<std::string> found = text_.cells(row);
    if (found.size() < least || (exactly && found.size() > headers().size())) {
      refuse_line(text_.line(row), 0,
                  "has " + std::to_string(found.size()) + " cells, the header has " +
                      std::to_string(headers().size()));
    }
    return found;
  }
  /// The value of a cell in Hz; NaN for an empty cell.
  [[nodiscard]] double frequency(int row, std::size_t column, const std::string& cell) const {
    if (cell.empty()) return kNaN;
    const double value = text_.number(cell).value_or(-1.0) * in_hz(column);
    if (std::isnan(value)) return value;
    if (!std::isfinite(value) || value <= 0.0) {
      refuse(row, column,
             "\"" + cell + "\": must be a number > 0 in Hz, or empty for a mode not measured");
    }
    return value;
  }
  [[nodiscard]] double frequency(int row, std::size_t column) const {
    return frequency(row, column, cells(row, column + 1, false)[column]);
  }

  /// Index of the column with the mode numbers; empty if no column has them.
  [[nodiscard]] std::optional<std::size_t> mode_column() const {
    for (const char* const name : {"mode", "number"})
      for (std::size_t c = 0; c < headers().size(); ++c)
        if (io::lower(headers()[c].name) == name && headers()[c].unit.empty()) return c;
    return {};
  }
  /// The mode number in a cell. Throws Failure for a cell that is not a whole number.
  [[nodiscard]] int mode(int row, std::size_t column) const {
    const std::string cell = cells(row, column + 1, false)[column];
    if (const auto found = whole_number(text_.number(cell).value_or(0.0), 1, kMostModes))
      return static_cast<int>(*found);
    refuse(row, column,
           "\"" + cell + "\": must be the number of a mode, a whole number from 1 to " +
               std::to_string(kMostModes) + "; rename the column \"" + headers()[column].header +
               "\" if it does not hold mode numbers");
  }
  /// True if the cells of the column are increasing whole numbers from 1, as mode numbers are.
  [[nodiscard]] bool may_hold_modes(std::size_t column) const {
    std::int64_t before = 0;
    for (int row = 0; row < rows(); ++row) {
      const std::vector<std::string> found = text_.cells(row);
      if (column >= found.size()) return false;
      const auto mode = whole_number(text_.number(found[column]).value_or(0.0), 1, kMostModes);
      if (!mode || *mode <= before) return false;
      before = *mode;
    }
    return true;
  }
  /// Rejects an empty line between the rows: it could be a mode that was not measured.
  void refuse_empty_line() const {
    if (const std::optional<int> line = text_.empty_line())
      refuse_line(*line, 0,
                  "empty line between the frequencies: write \"nan\" in this line for a mode not "
                  "measured, or delete the line");
  }
  [[noreturn]] void refuse(int row, std::size_t column, const std::string& message) const {
    refuse_line(text_.line(row), column + 1, message);
  }

 private:
  static constexpr int kMostModes = 10'000;

  [[noreturn]] void refuse_line(int line, std::size_t column, const std::string& message) const {
    std::string place = path_.string() + ":" + std::to_string(line);
    if (column > 0) place += ":" + std::to_string(column);
    throw Failure(Exit::bad_input, place + ": " + message);
  }

  [[nodiscard]] double in_hz(std::size_t column) const {
    const signals::Conversion found = conversion(column);
    if (found.basis == signals::Conversion::Basis::foreign)
      refuse_line(text_.header_line(), column + 1,
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

/// Rejects another column that could contain mode numbers, because the row numbers would replace
/// them.
void refuse_possible_modes(const FrequencyText& text, const std::vector<std::size_t>& used) {
  for (std::size_t c = 0; c < text.headers().size(); ++c) {
    const io::Column& column = text.headers()[c];
    if (std::ranges::find(used, c) == used.end() && signals::unit_of(column).empty() &&
        text.may_hold_modes(c))
      text.refuse_header("the column \"" + column.header +
                         "\" may hold mode numbers: if so, rename it to \"mode\"; if not, delete "
                         "it or state its unit as in \"" +
                         column.header + " [%]\"");
  }
}

/// The unit of frequency in the header of a column: "f [kHz]", "frequency_hz". Empty if the header
/// states none.
std::string frequency_unit(const io::Column& column) {
  const auto is_frequency = [](const std::string& unit) {
    const auto found = signals::find_unit(unit);
    return found && found->dimension == signals::Dimension::frequency;
  };
  if (const std::string unit = signals::unit_of(column); !unit.empty())
    return is_frequency(unit) ? unit : "";
  const std::string last = column.name.substr(column.name.find_last_of("_ ./") + 1);
  const std::string unit = last == "hz" ? "Hz" : last == "khz" ? "kHz" : last;
  return last != column.name && is_frequency(unit) ? unit : "";
}

/// Rejects a file without a column "frequency". A file with one column of frequencies has one mode
/// per row; with several columns, one test per row.
[[noreturn]] void refuse_names(const FrequencyText& text) {
  const auto modes = text.mode_column();
  const auto sd = text.find("sd");
  std::vector<std::size_t> others, stated;
  for (std::size_t c = 0; c < text.headers().size(); ++c) {
    if (modes == c || sd == c) continue;
    others.push_back(c);
    if (!frequency_unit(text.headers()[c]).empty()) stated.push_back(c);
  }
  const std::vector<std::size_t>& possible = stated.empty() ? others : stated;
  const std::string start = "no column \"frequency\" among " + text.names();
  if (possible.size() == 1) {
    const io::Column& column = text.headers()[possible[0]];
    const std::string unit = frequency_unit(column);
    text.refuse_header(start + "; rename the column \"" + column.header + "\" to \"frequency [" +
                       (unit.empty() ? "Hz" : unit) + "]\" if it holds one mode per row");
  }
  text.refuse_header(start + "; name the columns of modes 1, 2, … in the case's data.columns");
}

FrequencyTable one_mode_per_row(const FrequencyText& text) {
  const auto frequency = text.find("frequency");
  const auto sd = text.find("sd");
  if (!frequency) refuse_names(text);
  text.refuse_empty_line();
  const auto modes = text.mode_column();
  if (!modes) refuse_possible_modes(text, {*frequency, sd.value_or(*frequency)});
  FrequencyTable table;
  for (int row = 0; row < text.rows(); ++row) {
    if (modes) {
      const int mode = text.mode(row, *modes),
                before = static_cast<int>(table.frequencies_hz.size());
      if (mode <= before)
        text.refuse(row, *modes,
                    "mode " + std::to_string(mode) + " follows mode " + std::to_string(before) +
                        ": mode numbers must increase from row to row");
      const auto missing = static_cast<std::size_t>(mode - 1);
      table.frequencies_hz.resize(missing, kNaN);
      if (sd) table.sd_hz.resize(missing, kNaN);
    }
    table.frequencies_hz.push_back(text.frequency(row, *frequency));
    if (sd) table.sd_hz.push_back(text.frequency(row, *sd));
  }
  return table;
}

}  // namespace

FrequencyTable parse_frequency_csv(std::string bytes, const std::filesystem::path& path,
                                   const FrequencyCells& cells) {
  const FrequencyText text(std::move(bytes), path);
  if (cells.columns.empty()) return one_mode_per_row(text);
  FrequencyTable table;
  if (!cells.row && text.rows() > 1)
    text.refuse_header(
        "has " + std::to_string(text.rows()) +
        " rows: state \"row\", the number of the test, or give the tests as "
        "\"repeats\"" +
        (cells.columns.size() == 1
             ? "; if each row is a mode, rename the column to \"frequency [Hz]\" and "
               "leave out \"columns\""
             : ""));
  const int row = cells.row.value_or(1);
  if (row > text.rows()) {
    text.refuse_header("row " + std::to_string(row) + " is requested, but there are " +
                       std::to_string(text.rows()) + " rows below the header");
  }
  for (const std::string& name : cells.columns)
    table.frequencies_hz.push_back(text.frequency(row - 1, text.column(name)));
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
