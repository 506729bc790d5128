#include "io/text/text_cells.hpp"

#include <algorithm>

#include "io/text/text.hpp"
#include "io/text/text_number.hpp"
#include "io/text/words.hpp"

namespace wheeltap::io {
namespace {

/// True for a mark for "no unit". "TS" and "RN" are in the line of units of Campbell's loggers.
bool is_neutral(std::string_view cell) {
  return cell.empty() || cell == "-" || cell == "TS" || cell == "RN" || cell == "[-]" ||
         cell == "(-)" || cell == "[]" || cell == "()";
}

/// "Unit;s;g": true if the first cell describes the line and is not a unit.
bool is_units_label(std::string_view cell) {
  std::string low = lower(cell);
  if (low.ends_with(':')) low.pop_back();
  return low == "unit" || low == "units" || low == "einheit" || low == "einheiten" ||
         low == "unité" || low == "unités" || low == "unidad";
}

bool is_open(std::string_view header) {
  return std::ranges::count(header, '[') > std::ranges::count(header, ']') ||
         std::ranges::count(header, '(') > std::ranges::count(header, ')');
}

/// The cells of a line in which two or more blanks separate cells.
std::vector<std::string> wide_cells(std::string_view line) {
  std::vector<std::string> out;
  line = trimmed(line);
  while (!line.empty()) {
    std::size_t end = std::min(line.find("  "), line.find('\t'));
    end = std::min(end, line.size());
    out.push_back(in_utf8(trimmed(line.substr(0, end))));
    line = trimmed(line.substr(end));
  }
  return out;
}

}  // namespace

bool all_digits(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, is_digit);
}

bool is_comment_line(std::string_view line) {
  line = trimmed(line);
  if (line.empty()) return false;
  if (line.starts_with("//") || line.starts_with("***")) return true;
  if (std::string_view("#%!$&>~@").find(line.front()) == std::string_view::npos) return false;
  const std::string_view first = trimmed(line.substr(0, line.find_first_of(",;\t|")));
  const bool error = first.starts_with('#') && first.find('!') != std::string_view::npos;
  return !(is_missing_value(first) && (error || first == "#N/A" || first == "#NV"));
}

std::string_view without_comment_mark(std::string_view text) {
  text = trimmed(text);
  if (text.empty()) return text;
  const std::size_t end = text.find_first_not_of("#%!$&>~@*/;: \t");
  if (end != 0) {
    text.remove_prefix(std::min(end, text.size()));
  } else if (text.starts_with("--")) {
    text.remove_prefix(std::min(text.find_first_not_of("- \t"), text.size()));
  } else if ((text.front() == '"' || text.front() == '\'') &&
             std::ranges::count(text, text.front()) % 2 == 1) {
    text = trimmed(text.substr(1));
  }
  return text;
}

bool take_cell(std::string_view& line, char separator, std::string_view& cell) {
  std::size_t at = 0;
  const std::size_t first = line.find_first_not_of(" \t");
  if (first != std::string_view::npos && line[first] == '"') {
    // The cell ends at the closing quote; "" stands for a quote within the cell.
    for (at = first + 1; at < line.size(); ++at) {
      if (line[at] != '"') continue;
      if (at + 1 == line.size() || line[at + 1] != '"') break;
      ++at;
    }
  }
  const std::size_t end = separator == ' ' ? line.find_first_of(" \t", std::min(at, line.size()))
                                           : line.find(separator, std::min(at, line.size()));
  cell = line.substr(0, end);
  if (end == std::string_view::npos) return false;
  line.remove_prefix(end + 1);
  if (separator == ' ') line = line.substr(std::min(line.find_first_not_of(" \t"), line.size()));
  return true;
}

std::vector<std::string> loose_cells(std::string_view line, char separator) {
  std::vector<std::string> out;
  if (separator == ' ') line = trimmed(line);
  std::string_view cell;
  for (bool more = true; more;) {
    more = take_cell(line, separator, cell);
    cell = trimmed(cell);
    if (cell.size() > 1 && cell.front() == cell.back() &&
        (cell.front() == '"' || cell.front() == '\''))
      cell = trimmed(cell.substr(1, cell.size() - 2));
    out.push_back(in_utf8(cell));
  }
  return out;
}

std::size_t filled(const std::vector<std::string>& cells) {
  return static_cast<std::size_t>(
      std::ranges::count_if(cells, [](const std::string& cell) { return !cell.empty(); }));
}

std::vector<std::string> joined_names(const std::vector<std::string>& cells) {
  std::vector<std::string> out;
  for (const std::string& cell : cells) {
    const bool joins =
        !out.empty() && (cell.starts_with('[') || cell.starts_with('(') || is_open(out.back()));
    if (joins) {
      out.back() += " " + cell;
    } else {
      out.push_back(cell);
    }
  }
  return out;
}

std::vector<std::string> names_in(std::string_view line, char separator, std::size_t columns) {
  const auto fits = [&](std::vector<std::string>& names) {
    if (names.size() == columns + 1 && names.back().empty()) names.pop_back();
    // "Headers, time, Ax": the first cell describes the line and is not a name.
    if (names.size() == columns + 1) {
      const std::string low = lower(names.front());
      if (low == "headers" || low == "header" || low == "columns" || low == "names")
        names.erase(names.begin());
    }
    return names.size() == columns && filled(names) > 0;
  };
  std::vector<std::string> names = loose_cells(line, separator);
  if (separator == ' ') {
    if (fits(names)) return names;
    names = joined_names(names);
  }
  if (fits(names)) return names;
  names = wide_cells(line);
  if (columns > 1 && fits(names)) return names;
  // The line of names may have a different separator than the rows.
  for (const char other : {',', ';', '\t'}) {
    if (other == separator || columns < 2) continue;
    names = loose_cells(line, other);
    if (fits(names)) return names;
  }
  return {};
}

bool is_units_line(const std::vector<std::string>& cells) {
  std::size_t units = 0;
  for (const std::string& cell : cells) {
    if (is_neutral(cell)) continue;
    if (&cell == &cells.front() && is_units_label(cell)) continue;
    if (!spells_unit(cell)) return false;
    ++units;
  }
  return units > 0;
}

bool is_remarks_name(std::string_view name) {
  const std::string low = lower(name);
  for (const std::string_view known :
       {"comment", "comments", "remark", "remarks", "note", "notes", "bemerkung", "bemerkungen",
        "kommentar", "kommentare", "commentaire", "event", "events", "marker", "markers",
        "annotation", "annotations", "status"})
    if (low == known) return true;
  return false;
}

bool spells_unit(std::string_view text) {
  text = trimmed(text);
  for (const std::string_view brackets : {"[]", "()", "<>", "{}"})
    if (text.size() > 2 && text.front() == brackets[0] && text.back() == brackets[1])
      text = trimmed(text.substr(1, text.size() - 2));
  static constexpr std::string_view kKnown[] = {
      "s",     "ms",   "us",   "µs",     "μs",    "ns",   "sec",   "seconds", "second",   "min",
      "h",     "hr",   "d",    "days",   "hz",    "khz",  "1/s",   "rpm",     "g",        "mg",
      "ug",    "µg",   "n",    "kn",     "mn",    "lbf",  "lb",    "kip",     "kips",     "kgf",
      "m",     "mm",   "cm",   "um",     "µm",    "μm",   "nm",    "km",      "in",       "inch",
      "ft",    "v",    "mv",   "uv",     "µv",    "a",    "ma",    "w",       "kw",       "pa",
      "kpa",   "mpa",  "gpa",  "bar",    "mbar",  "psi",  "ksi",   "°c",      "c",        "degc",
      "deg c", "°f",   "degf", "k",      "°",     "deg",  "rad",   "mrad",    "%",        "gal",
      "kg",    "t",    "µm/m", "um/m",   "μm/m",  "µe",   "ue",    "ustrain", "µstrain",  "strain",
      "mv/v",  "none", "cnt",  "counts", "count", "volt", "volts", "ohm",     "db",       "mm/m",
      "nm/m",  "n·m",  "n*m",  "n-m",    "knm",   "kn·m", "kn*m",  "milli-g", "milli-gs", "gs",
      "g's"};
  std::string low(text);
  for (char& c : low)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  if (std::ranges::find(kKnown, low) != std::end(kKnown)) return true;
  // Powers and quotients: "m/s²", "m/s^2", "m/s**2", "m s^-2", "mm/sec", "deg/s", "in/s2".
  const std::size_t slash = low.find('/');
  if (slash != std::string::npos) {
    const std::string above = low.substr(0, slash), below = low.substr(slash + 1);
    static constexpr std::string_view kBelow[] = {"s",   "s2",   "s^2",     "s²",   "s**2",
                                                  "sec", "sec2", "sec^2",   "sec²", "h",
                                                  "min", "s/s",  "sec/sec", "hz"};
    const bool known_above = std::ranges::find(kKnown, above) != std::end(kKnown);
    if (known_above && std::ranges::find(kBelow, below) != std::end(kBelow)) return true;
  }
  for (const std::string_view power : {"m s^-2", "ms^-2", "m·s^-2", "m s-2", "ms-2", "m s⁻²",
                                       "m·s⁻²", "ms⁻²", "m/s/s", "m.s-2", "mm s^-1", "m s^-1"})
    if (low == power) return true;
  return false;
}

}  // namespace wheeltap::io
