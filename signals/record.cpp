#include "signals/record.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <sstream>

#ifdef WHEELTAP_MATIO
#include <matio.h>

#include <memory>
#endif

namespace wheeltap::signals {

namespace {

std::string_view trim(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\r' || c == '\t'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"')
    text = text.substr(1, text.size() - 2);
  return text;
}

std::optional<double> number(std::string_view text) {
  if (text.empty()) return std::numeric_limits<double>::quiet_NaN();
  if (text.front() == '+') text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Calls visit(index, cell) for every cell of a line and returns how many there are.
template <class Visitor>
std::size_t split(std::string_view line, char separator, Visitor visit) {
  std::size_t index = 0;
  for (;;) {
    const std::size_t end = line.find(separator);
    visit(index++, trim(line.substr(0, end)));
    if (end == std::string_view::npos) return index;
    line.remove_prefix(end + 1);
  }
}

char separator_of(std::string_view line) {
  char best = ',';
  for (char candidate : {';', '\t'})
    if (std::count(line.begin(), line.end(), candidate) >
        std::count(line.begin(), line.end(), best))
      best = candidate;
  return best;
}

Column parse_header(std::string_view header) {
  Column column{
      .header = std::string(header), .name = std::string(header), .unit = {}, .values = {}};
  for (const char* brackets : {"[]", "()"}) {
    const std::size_t open = header.rfind(brackets[0]);
    if (open == std::string_view::npos || header.back() != brackets[1]) continue;
    column.name = std::string(trim(header.substr(0, open)));
    column.unit = std::string(trim(header.substr(open + 1, header.size() - open - 2)));
    break;
  }
  return column;
}

/// Digits printed after the point, and significant digits.
void count_digits(std::string_view text, Column& column) {
  int significant = 0, after_point = 0, exponent = 0;
  bool point = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == 'e' || c == 'E') {
      const char* begin = text.data() + i + (i + 1 < text.size() && text[i + 1] == '+' ? 2 : 1);
      std::from_chars(begin, text.data() + text.size(), exponent);
      break;
    }
    if (c == '.') point = true;
    if (c < '0' || c > '9') continue;
    if (significant > 0 || c != '0') ++significant;
    if (point) ++after_point;
  }
  column.decimals = std::max(column.decimals, after_point - exponent);
  column.digits = std::max(column.digits, significant);
}

/// By how much a printed value may differ from the one meant.
double resolution(const Column& column, double value) {
  if (column.digits < 0) return 0.0;
  const double by_point = std::pow(10.0, -column.decimals);
  if (value == 0.0) return by_point;
  return std::max(by_point,
                  std::pow(10.0, std::floor(std::log10(std::abs(value))) - column.digits + 1));
}

std::string place(const Record& record, std::size_t sample) {
  if (record.first_line == 0) return record.file + ", sample " + std::to_string(sample);
  return record.file + ", line " +
         std::to_string(static_cast<std::size_t>(record.first_line) + sample);
}

std::string show(double value) {
  std::ostringstream out;
  out.precision(9);
  out << value;
  return out.str();
}

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return result;
}

}  // namespace

int Record::find(std::string_view column) const {
  std::vector<int> found;
  for (auto field : {&Column::header, &Column::name}) {
    for (std::size_t i = 0; i < columns.size(); ++i)
      if (columns[i].*field == column) found.push_back(static_cast<int>(i));
    if (found.size() == 1) return found.front();
    if (found.size() > 1)
      throw DataError(file + ": " + std::to_string(found.size()) + " columns are called '" +
                      std::string(column) + "'; use the column's number");
  }
  int place = 0;
  const auto [end, error] = std::from_chars(column.data(), column.data() + column.size(), place);
  if (error == std::errc() && end == column.data() + column.size() && place >= 1 &&
      place <= static_cast<int>(columns.size()))
    return place - 1;
  std::string known;
  for (const Column& c : columns) known += (known.empty() ? "'" : ", '") + c.header + "'";
  throw DataError(file + ": no column '" + std::string(column) + "', there are " + known);
}

int Record::find_time() const {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::string name = lower(columns[i].name);
    if (name == "t" || name.starts_with("time")) return static_cast<int>(i);
  }
  return -1;
}

Record read_csv(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream || std::filesystem::is_directory(path))
    throw FileError(path.string() + ": no such file, or it cannot be read");
  std::ostringstream buffer;
  buffer << stream.rdbuf();
  const std::string content = std::move(buffer).str();
  std::string_view rest = content;
  if (rest.starts_with("\xEF\xBB\xBF")) rest.remove_prefix(3);

  Record record{.file = path.string(), .columns = {}, .scalars = {}};
  int line_number = 0;
  char separator = 0;
  while (!rest.empty()) {
    const std::size_t end = rest.find('\n');
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    ++line_number;
    if (separator == 0) {
      if (trim(line).empty() || trim(line).front() == '#') continue;
      separator = separator_of(line);
      bool numeric = true;
      split(line, separator, [&](std::size_t, std::string_view cell) {
        numeric = numeric && number(cell).has_value();
      });
      split(line, separator, [&](std::size_t i, std::string_view cell) {
        record.columns.push_back(parse_header(numeric ? std::to_string(i + 1) : cell));
      });
      record.first_line = numeric ? line_number : line_number + 1;
      if (!numeric) continue;
    }
    if (trim(line).empty()) {
      if (rest.find_first_not_of(" \t\r\n") == std::string_view::npos) break;
      throw DataError(record.file + ", line " + std::to_string(line_number) + ": empty line");
    }
    const std::size_t cells = split(line, separator, [&](std::size_t i, std::string_view cell) {
      if (i >= record.columns.size()) return;
      const std::optional<double> value = number(cell);
      if (!value)
        throw DataError(record.file + ", line " + std::to_string(line_number) + ", column " +
                        std::to_string(i + 1) + " ('" + record.columns[i].header + "'): '" +
                        std::string(cell.substr(0, 40)) + "' is not a number");
      record.columns[i].values.push_back(*value);
      count_digits(cell, record.columns[i]);
    });
    if (cells != record.columns.size())
      throw DataError(record.file + ", line " + std::to_string(line_number) + ": " +
                      std::to_string(cells) + " columns, must be " +
                      std::to_string(record.columns.size()) + " as in the first line");
  }
  if (record.samples() == 0) throw DataError(record.file + ": no data");
  return record;
}

#ifdef WHEELTAP_MATIO

namespace {

template <class T>
void append(const matvar_t& variable, std::vector<double>& out) {
  const auto* data = static_cast<const T*>(variable.data);
  const std::size_t count = variable.nbytes / static_cast<std::size_t>(variable.data_size);
  out.reserve(count);
  for (std::size_t i = 0; i < count; ++i) out.push_back(static_cast<double>(data[i]));
}

/// The values of a real numeric array, column by column; empty for anything else.
std::vector<double> real_values(const matvar_t& variable) {
  std::vector<double> values;
  if (variable.isComplex || variable.rank != 2 || variable.data == nullptr) return values;
  switch (variable.class_type) {
    case MAT_C_DOUBLE:
      append<double>(variable, values);
      break;
    case MAT_C_SINGLE:
      append<float>(variable, values);
      break;
    case MAT_C_INT64:
      append<std::int64_t>(variable, values);
      break;
    case MAT_C_INT32:
      append<std::int32_t>(variable, values);
      break;
    case MAT_C_INT16:
      append<std::int16_t>(variable, values);
      break;
    case MAT_C_INT8:
      append<std::int8_t>(variable, values);
      break;
    case MAT_C_UINT64:
      append<std::uint64_t>(variable, values);
      break;
    case MAT_C_UINT32:
      append<std::uint32_t>(variable, values);
      break;
    case MAT_C_UINT16:
      append<std::uint16_t>(variable, values);
      break;
    case MAT_C_UINT8:
      append<std::uint8_t>(variable, values);
      break;
    default:
      break;
  }
  return values;
}

}  // namespace

Record read_matlab(const std::filesystem::path& path) {
  const std::unique_ptr<mat_t, int (*)(mat_t*)> file(Mat_Open(path.c_str(), MAT_ACC_RDONLY),
                                                     Mat_Close);
  if (!file) throw FileError(path.string() + ": no such file, or no MATLAB file");
  Record record{.file = path.string(), .columns = {}, .scalars = {}};
  for (;;) {
    const std::unique_ptr<matvar_t, void (*)(matvar_t*)> variable(Mat_VarReadNext(file.get()),
                                                                  Mat_VarFree);
    if (!variable) break;
    const std::vector<double> values = real_values(*variable);
    if (values.empty() || variable->name == nullptr) continue;
    const std::string name = variable->name;
    const std::size_t rows = variable->dims[0], columns = variable->dims[1];
    if (rows * columns != values.size()) continue;
    if (values.size() == 1) {
      record.scalars[name] = values[0];
      continue;
    }
    const bool is_vector = rows == 1 || columns == 1;
    const std::size_t length = is_vector ? values.size() : rows;
    for (std::size_t j = 0; j < (is_vector ? 1 : columns); ++j) {
      const std::string header = is_vector ? name : name + "(:," + std::to_string(j + 1) + ")";
      const auto begin = values.begin() + static_cast<std::ptrdiff_t>(j * length);
      record.columns.push_back({.header = header,
                                .name = header,
                                .unit = {},
                                .values = {begin, begin + static_cast<std::ptrdiff_t>(length)}});
    }
  }
  std::size_t longest = 0;
  for (const Column& column : record.columns) longest = std::max(longest, column.values.size());
  std::erase_if(record.columns, [&](const Column& c) { return c.values.size() != longest; });
  if (record.columns.empty()) throw DataError(record.file + ": no real numeric arrays");
  return record;
}

#else

Record read_matlab(const std::filesystem::path& path) {
  throw FileError(path.string() + ": this program was built without libmatio");
}

#endif

Record read_record(const std::filesystem::path& path) {
  return lower(path.extension().string()) == ".mat" ? read_matlab(path) : read_csv(path);
}

double sample_rate_hz(const Record& record, int time_column, std::optional<double> stated) {
  const Column& column = record.columns.at(static_cast<std::size_t>(time_column));
  const std::vector<double>& t = column.values;
  const std::string name = " ('" + column.header + "')";
  if (t.size() < 2) throw DataError(record.file + name + ": one sample has no sampling rate");
  for (std::size_t n = 0; n < t.size(); ++n)
    if (!std::isfinite(t[n]))
      throw DataError(place(record, n) + ", column " + std::to_string(time_column + 1) + name +
                      ": time is not a finite number");
  const auto steps = static_cast<double>(t.size() - 1);
  const double mean = (t.back() - t.front()) / steps;
  std::vector<double> sorted;
  for (std::size_t n = 1; n < t.size(); ++n) sorted.push_back(t[n] - t[n - 1]);
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2),
                   sorted.end());
  const double median = sorted[sorted.size() / 2];
  bool uneven = !(mean > 0.0);
  for (std::size_t n = 1; n < t.size() && !uneven; ++n)
    uneven = std::abs(t[n] - t[n - 1] - mean) > 1e-3 * mean + 1.01 * resolution(column, t[n]);
  // Where a step is as small as the digits printed, rounding could explain a missing row; but then
  // not in one step of hundreds only.
  const auto odd = std::count_if(sorted.begin(), sorted.end(), [&](double step) {
    return std::abs(step - median) > 0.5 * median;
  });
  uneven = uneven || (odd > 0 && 50 * odd < std::ssize(sorted));
  if (uneven) {
    // A gap shifts the mean, not the median: the step farthest from the median is the one to name.
    std::size_t worst = 1;
    for (std::size_t n = 1; n < t.size(); ++n)
      if (std::abs(t[n] - t[n - 1] - median) > std::abs(t[worst] - t[worst - 1] - median))
        worst = n;
    throw DataError(place(record, worst) + ", column " + std::to_string(time_column + 1) + name +
                    ": time goes from " + show(t[worst - 1]) + " to " + show(t[worst]) +
                    " s, must advance by the same step everywhere (" + show(median) +
                    " s elsewhere)");
  }
  const double rate = 1.0 / mean;
  const double rounding = 2.0 * resolution(column, t.back()) / (steps * mean);
  if (stated && !(std::abs(*stated / rate - 1.0) <= 1e-3 + rounding))
    throw DataError(record.file + ", column " + std::to_string(time_column + 1) + name + ": says " +
                    show(rate) + " Hz, which contradicts the stated sampling rate of " +
                    show(*stated) + " Hz");
  return rate;
}

std::vector<double> window(const Record& record, int column, int begin, int end) {
  if (begin < 0 || begin >= end || end > record.samples())
    throw DataError(record.file + ": samples [" + std::to_string(begin) + ", " +
                    std::to_string(end) + "), must be a window within [0, " +
                    std::to_string(record.samples()) + ")");
  const Column& source = record.columns.at(static_cast<std::size_t>(column));
  std::vector<double> values(source.values.begin() + begin, source.values.begin() + end);
  for (std::size_t n = 0; n < values.size(); ++n)
    if (!std::isfinite(values[n]))
      throw DataError(place(record, n + static_cast<std::size_t>(begin)) + ", column " +
                      std::to_string(column + 1) + " ('" + source.header +
                      "'): not a finite number");
  return values;
}

std::string record_csv(const Record& record, const std::string& comment) {
  std::string text = "# " + comment + "\n";
  for (std::size_t c = 0; c < record.columns.size(); ++c) {
    text += (c > 0 ? "," : "") + record.columns[c].header;
  }
  text += '\n';
  char cell[40];
  for (std::size_t n = 0; n < record.columns[0].values.size(); ++n) {
    for (std::size_t c = 0; c < record.columns.size(); ++c) {
      std::snprintf(cell, sizeof cell, "%s%.10g", c > 0 ? "," : "", record.columns[c].values[n]);
      text += cell;
    }
    text += '\n';
  }
  return text;
}

}  // namespace wheeltap::signals
