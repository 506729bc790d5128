#include "io/formats/workbook_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/file_error.hpp"
#include "io/formats/xml_events.hpp"
#include "io/formats/zip_archive.hpp"
#include "io/tables/delimited_text.hpp"
#include "io/text/text.hpp"
#include "io/text/text_number.hpp"

namespace wheeltap::io {
namespace {

constexpr std::uint64_t kLargestPart = std::uint64_t{1} << 30U;
constexpr std::uint64_t kLargestTable = 200'000'000;  // cells, including empty ones
constexpr std::uint32_t kMostRows = 1'048'576, kMostColumns = 16'384;
constexpr double kSecondsADay = 86400.0;

using Attributes = std::map<std::string, std::string>;

std::string attribute(const Attributes& all, const std::string& name) {
  const auto found = all.find(name);
  return found == all.end() ? std::string() : found->second;
}

std::uint32_t whole(std::string_view text, std::uint32_t otherwise) {
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? value : otherwise;
}

enum class NumberFormat { number, date, elapsed };

/// Classifies a format code: dates have date letters outside quotes and brackets. "[h]:mm" is an
/// elapsed time, which may exceed one day.
NumberFormat format_of_code(std::string_view code) {
  bool date = false;
  for (std::size_t i = 0; i < code.size(); ++i) {
    const char c = code[i];
    if (c == ';') break;  // end of the first section; others are for negative numbers and texts
    if (c == '"') {
      i = std::min(code.find('"', i + 1), code.size());
    } else if (c == '\\' || c == '_' || c == '*') {
      ++i;
    } else if (c == '[') {
      const std::size_t end = std::min(code.find(']', i), code.size());
      const std::string_view within = code.substr(i + 1, end - i - 1);
      if (!within.empty() && within.find_first_not_of("hHmMsS") == std::string_view::npos)
        return NumberFormat::elapsed;
      i = end;
    } else if (std::string_view("yYmMdDhHsS").find(c) != std::string_view::npos) {
      date = true;
    } else if (c == 'G' || c == 'g') {
      break;  // G: "General"
    }
  }
  return date ? NumberFormat::date : NumberFormat::number;
}

NumberFormat builtin_format(std::uint32_t id) {
  if (id == 46) return NumberFormat::elapsed;
  const bool date = (id >= 14 && id <= 22) || (id >= 27 && id <= 36) || id == 45 || id == 47 ||
                    (id >= 50 && id <= 58);
  return date ? NumberFormat::date : NumberFormat::number;
}

/// A spreadsheet's date [days] as a time stamp; below one day, the time of day only.
std::string stamp_of(double days, bool since_1904) {
  constexpr double kMost = 2'958'466.0;  // days; end of the year 9999
  if (!(days >= 0.0) || days >= kMost) return "#NUM!";
  double whole_days = std::floor(days);
  auto micros = std::llround((days - whole_days) * kSecondsADay * 1e6);
  constexpr long long kMicrosADay = 86'400'000'000;
  if (micros >= kMicrosADay) {
    micros -= kMicrosADay;
    whole_days += 1.0;
  }
  char text[64];
  std::string out;
  if (days >= 1.0 || since_1904) {
    // Day 60 is 29 February 1900, which did not exist: earlier days are shifted by one.
    const double shift = since_1904 ? 24107.0 : whole_days < 60.0 ? 25568.0 : 25569.0;
    // Days from 1970 to a date (H. Hinnant, chrono-compatible low-level date algorithms).
    const auto z = static_cast<long long>(whole_days - shift) + 719468;
    const long long era = z / 146097, doe = z - era * 146097;
    const long long yoe = (doe - doe / 1460 + doe / 36524 - doe / 146096) / 365;
    const long long doy = doe - (365 * yoe + yoe / 4 - yoe / 100), mp = (5 * doy + 2) / 153;
    const long long day = doy - (153 * mp + 2) / 5 + 1, month = mp < 10 ? mp + 3 : mp - 9;
    const long long year = yoe + era * 400 + (month <= 2 ? 1 : 0);
    std::snprintf(text, sizeof text, "%04lld-%02lld-%02lld ", year, month, day);
    out = text;
  }
  std::snprintf(text, sizeof text, "%02lld:%02lld:%02lld.%06lld", micros / 3'600'000'000,
                micros / 60'000'000 % 60, micros / 1'000'000 % 60, micros % 1'000'000);
  return out + text;
}

/// The text of a cell, escaped so that it can be a cell of a line separated by tabs.
std::string cell_text(std::string_view text) {
  std::string out;
  bool quoted = false;
  for (const char c : text) {
    quoted = quoted || c == '"';
    if (c == '"') out += '"';
    out += c == '\t' || c == '\n' || c == '\r' ? ' ' : c;
  }
  return quoted ? "\"" + out + "\"" : out;
}

struct Cell {
  std::uint32_t row = 0, column = 0;  ///< from 0
  std::uint64_t begin = 0, size = 0;  ///< position and length of its text
};

struct Sheet {
  std::string name, part;
  bool hidden = false;
};

class Workbook {
 public:
  Workbook(const std::string& bytes, const std::filesystem::path& name)
      : name_(name), archive_(bytes, name) {
    if (archive_.find("xl/workbook.xml") == nullptr)
      throw FileError(FileError::Kind::foreign, name,
                      "is a ZIP archive without a workbook (xl/workbook.xml): save it as .xlsx");
    read_sheets();
    read_styles();
    read_strings();
  }

  [[nodiscard]] const std::vector<Sheet>& sheets() const { return sheets_; }

  /// The sheet as text, with cells separated by tabs.
  [[nodiscard]] std::string text_of(const Sheet& sheet) {
    cells_.clear();
    texts_.clear();
    read_cells(sheet);
    return lines(sheet);
  }

 private:
  [[noreturn]] void corrupt(const std::string& why) const {
    throw FileError(FileError::Kind::corrupt, name_, why);
  }

  void read(const std::string& part, const XmlEvents& events) const {
    const ZipMember* member = archive_.find(part);
    if (member == nullptr) corrupt("lacks its part " + printable(in_utf8(part)));
    const std::string why = read_xml(archive_.read(*member, kLargestPart), events);
    if (!why.empty())
      corrupt("is corrupt: its part " + printable(in_utf8(part)) + " is not XML: " + why);
  }
  static void nothing(const std::string&) {}
  static void no_text(std::string_view) {}

  void read_sheets() {
    std::map<std::string, std::string> parts;  // targets of relations
    const auto relation = [&](const std::string& name, const Attributes& a) {
      std::string target = attribute(a, "Target");
      target = target.starts_with('/') ? target.substr(1) : "xl/" + target;
      if (name == "Relationship") parts[attribute(a, "Id")] = target;
    };
    read("xl/_rels/workbook.xml.rels", {relation, nothing, no_text});
    const auto sheet = [&](const std::string& name, const Attributes& a) {
      if (name == "workbookPr")
        since_1904_ = attribute(a, "date1904") == "1" || attribute(a, "date1904") == "true";
      if (name != "sheet") return;
      const std::string state = attribute(a, "state");
      sheets_.push_back({.name = attribute(a, "name"),
                         .part = parts[attribute(a, "id")],
                         .hidden = !state.empty() && state != "visible"});
    };
    read("xl/workbook.xml", {sheet, nothing, no_text});
    // Charts are sheets without cells.
    std::erase_if(sheets_,
                  [](const Sheet& s) { return s.part.find("worksheets/") == s.part.npos; });
    if (sheets_.empty()) corrupt("holds no sheet");
  }

  void read_styles() {
    if (archive_.find("xl/styles.xml") == nullptr) return;
    std::map<std::uint32_t, NumberFormat> own;
    bool of_cells = false;
    const auto begin = [&](const std::string& name, const Attributes& a) {
      if (name == "numFmt")
        own[whole(attribute(a, "numFmtId"), 0)] = format_of_code(attribute(a, "formatCode"));
      if (name == "cellXfs") of_cells = true;
      if (name != "xf" || !of_cells) return;
      const std::uint32_t id = whole(attribute(a, "numFmtId"), 0);
      const auto found = own.find(id);
      styles_.push_back(found == own.end() ? builtin_format(id) : found->second);
    };
    const auto end = [&](const std::string& name) {
      if (name == "cellXfs") of_cells = false;
    };
    read("xl/styles.xml", {begin, end, no_text});
  }

  void read_strings() {
    if (archive_.find("xl/sharedStrings.xml") == nullptr) return;
    bool in_text = false;
    int phonetic = 0;
    const auto begin = [&](const std::string& name, const Attributes&) {
      if (name == "si") strings_.emplace_back();
      phonetic += name == "rPh";
      in_text = name == "t" && phonetic == 0;
    };
    const auto end = [&](const std::string& name) {
      phonetic -= name == "rPh";
      in_text = false;
    };
    const auto text = [&](std::string_view piece) {
      if (in_text && !strings_.empty()) strings_.back() += piece;
    };
    read("xl/sharedStrings.xml", {begin, end, text});
  }

  /// Converts a reference: "B3" is row 2, column 1. Returns false for other strings.
  static bool place(std::string_view reference, Cell& cell) {
    std::uint32_t column = 0;
    std::size_t i = 0;
    for (; i < reference.size() && reference[i] >= 'A' && reference[i] <= 'Z' && i < 4; ++i)
      column = 26 * column + static_cast<std::uint32_t>(reference[i] - 'A' + 1);
    const std::uint32_t row = whole(reference.substr(i), 0);
    if (column == 0 || row == 0) return false;
    cell.column = column - 1;
    cell.row = row - 1;
    return true;
  }

  void read_cells(const Sheet& sheet) {
    Cell cell;
    std::uint32_t next_row = 0, next_column = 0;
    std::string type, value;
    std::uint32_t style = 0;
    bool in_value = false;
    const auto begin = [&](const std::string& name, const Attributes& a) {
      if (name == "row") {
        const std::uint32_t stated = whole(attribute(a, "r"), 0);
        cell.row = stated > 0 ? stated - 1 : next_row;
        next_row = cell.row + 1;
        next_column = 0;
      } else if (name == "c") {
        cell.column = next_column;
        const std::string reference = attribute(a, "r");
        if (!reference.empty() && !place(reference, cell))
          corrupt("is corrupt: a cell is at '" + printable(reference) + "'");
        if (cell.row >= kMostRows || cell.column >= kMostColumns)
          corrupt("is corrupt: a cell lies outside the sheet");
        next_column = cell.column + 1;
        type = attribute(a, "t");
        style = whole(attribute(a, "s"), 0);
        value.clear();
      }
      in_value = name == "v" || name == "t";
    };
    const auto end = [&](const std::string& name) {
      in_value = false;
      if (name != "c" || value.empty()) return;
      const std::string shown = shown_as(value, type, style);
      if (shown.empty()) return;
      cell.begin = texts_.size();
      cell.size = shown.size();
      texts_ += shown;
      cells_.push_back(cell);
    };
    const auto text = [&](std::string_view piece) {
      if (in_value) value += piece;
    };
    read(sheet.part, {begin, end, text});
    if (cells_.empty()) corrupt("its sheet \"" + printable(sheet.name) + "\" is empty");
    std::ranges::stable_sort(cells_, [](const Cell& a, const Cell& b) {
      return std::pair(a.row, a.column) < std::pair(b.row, b.column);
    });
  }

  [[nodiscard]] std::string shown_as(const std::string& value, const std::string& type,
                                     std::uint32_t style) const {
    if (type == "s") {
      const std::uint32_t which = whole(value, kLargest);
      if (which >= strings_.size())
        corrupt("is corrupt: a cell has text " + printable(value) + " of " +
                std::to_string(strings_.size()));
      return cell_text(strings_[which]);
    }
    if (!type.empty() && type != "n") return cell_text(value);
    const auto number = parse_number(value);
    const NumberFormat format = style < styles_.size() ? styles_[style] : NumberFormat::number;
    if (!number || format == NumberFormat::number) return cell_text(value);
    if (format == NumberFormat::date) return stamp_of(*number, since_1904_);
    char seconds[64];
    std::snprintf(seconds, sizeof seconds, "%.9g", *number * kSecondsADay);
    return seconds;
  }

  [[nodiscard]] std::string lines(const Sheet& sheet) const {
    std::set<std::uint32_t> used;
    for (const Cell& cell : cells_) used.insert(cell.column);
    const std::uint64_t rows = cells_.back().row + 1;
    if (rows * used.size() > kLargestTable)
      corrupt("its sheet \"" + printable(sheet.name) + "\" has " + std::to_string(rows) +
              " rows of " + std::to_string(used.size()) + " columns: at most " +
              std::to_string(kLargestTable) + " cells are read");
    std::string out;
    auto cell = cells_.begin();
    for (std::uint32_t row = 0; row < rows; ++row) {
      if (cell->row == row)
        for (const std::uint32_t column : used) {
          if (column != *used.begin()) out += '\t';
          bool first = true;
          for (; cell != cells_.end() && cell->row == row && cell->column == column; ++cell) {
            if (first) out.append(texts_, cell->begin, cell->size);
            first = false;
          }
        }
      out += '\n';
    }
    return out;
  }

  static constexpr std::uint32_t kLargest = 0xFFFFFFFF;
  const std::filesystem::path& name_;
  ZipArchive archive_;
  bool since_1904_ = false;
  std::vector<Sheet> sheets_;
  std::vector<NumberFormat> styles_;  // of cells
  std::vector<std::string> strings_;
  std::vector<Cell> cells_;
  std::string texts_;
};

std::string listed(const std::vector<Sheet>& sheets) {
  std::string out;
  for (const Sheet& sheet : sheets)
    out += (out.empty() ? "\"" : ", \"") + printable(sheet.name) + "\"";
  return out;
}

}  // namespace

Columns parse_workbook(std::string bytes, const std::filesystem::path& name, const Wanted& wanted,
                       const TextLayout& stated) {
  if (bytes.starts_with("\xD0\xCF\x11\xE0"))
    throw FileError(FileError::Kind::foreign, name,
                    "is a workbook of Excel 97 to 2003, or encrypted: save it as .xlsx without a "
                    "password, or as .csv");
  if (stated.separator)
    throw FileError(
        FileError::Kind::mismatch, name,
        "is an Excel workbook: leave out separator, which applies to delimited text only");
  Workbook workbook(bytes, name);
  const std::vector<Sheet>& sheets = workbook.sheets();
  auto chosen = stated.sheet.empty() ? std::ranges::find(sheets, false, &Sheet::hidden)
                                     : std::ranges::find(sheets, stated.sheet, &Sheet::name);
  if (chosen == sheets.end() && stated.sheet.empty()) chosen = sheets.begin();
  if (chosen == sheets.end())
    throw FileError(
        FileError::Kind::corrupt, name,
        "has no sheet \"" + printable(stated.sheet) + "\"; its sheets are " + listed(sheets));
  TextLayout layout = stated;
  layout.separator = '\t';
  layout.decimal = stated.decimal.value_or('.');
  Columns out;
  try {
    out = parse_delimited_text(workbook.text_of(*chosen), name, wanted, layout);
  } catch (const FileError& error) {
    if (sheets.size() == 1) throw;
    throw FileError(error.kind(), name, error.place(),
                    error.reason() + " (in the sheet \"" + printable(chosen->name) +
                        "\"; the key \"sheet\" selects another of " + listed(sheets) + ")");
  }
  if (out.layout) out.layout->used.sheet = chosen->name;
  for (const Sheet& sheet : sheets)
    if (&sheet != &*chosen)
      out.others.push_back("the sheet \"" + printable(sheet.name) +
                           "\" (to read it, state \"sheet\": \"" + printable(sheet.name) + "\")");
  return out;
}

}  // namespace wheeltap::io
