#include "io/drawings/outline_file.hpp"

#include <algorithm>
#include <cmath>

#include "io/bytes.hpp"
#include "io/file_error.hpp"
#include "io/tables/delimited_text.hpp"
#include "io/text/words.hpp"

namespace wheeltap::io {
namespace {

/// Entry i is true if line i (from 1) is empty.
std::vector<bool> empty_lines(const std::string& bytes) {
  std::vector<bool> empty = {false, true};
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const char c = bytes[i];
    const bool pair = c == '\r' && i + 1 < bytes.size() && bytes[i + 1] == '\n';
    if (c == '\n' || (c == '\r' && !pair))
      empty.push_back(true);
    else if (c != ' ' && c != '\t' && c != '\r' && c != ',' && c != ';')
      empty.back() = false;
  }
  return empty;
}

}  // namespace

Drawing parse_outline_table(const std::string& bytes, const std::filesystem::path& name) {
  const DelimitedText table(bytes, name);
  const auto fail = [&](Place place, const std::string& reason) {
    throw FileError(FileError::Kind::corrupt, name, std::move(place), reason);
  };
  std::ptrdiff_t y = 0, z = 1, part = -1;
  Drawing drawing;
  if (table.header_line() > 0) {
    y = z = -1;
    std::vector<std::string> units(2);
    for (std::size_t i = 0; i < table.headers().size(); ++i) {
      const Column& column = table.headers()[i];
      const std::string word = lower(column.name);
      const auto at = static_cast<std::ptrdiff_t>(i);
      if (word == "y") y = at, units[0] = column.unit;
      if (word == "z") z = at, units[1] = column.unit;
      if (word == "part") part = at;
    }
    if (y < 0 || z < 0)
      fail({.line = table.header_line()},
           "an outline needs the columns y and z (the column part is optional)");
    if (units[0] != units[1])
      fail({.line = table.header_line()}, "y is in '" + units[0] + "' and z in '" + units[1] + "'");
    if (!units[0].empty()) {
      drawing.unit = metres(units[0]);
      if (drawing.unit == 0.0)
        fail({.line = table.header_line()},
             "'" + units[0] + "': the units known are m, cm, mm, in, ft");
    }
  }
  const std::vector<bool> empty = empty_lines(bytes);
  std::string current;
  for (int row = 0; row < table.rows(); ++row) {
    const auto cells = table.cells(row);
    const int line = table.line(row);
    const auto number = [&](std::ptrdiff_t column) {
      if (column >= std::ssize(cells))
        fail({.line = line}, "has " + std::to_string(cells.size()) + " cells, needs y and z");
      const std::string& cell = cells[static_cast<std::size_t>(column)];
      const auto value = table.number(cell);
      if (!value || !std::isfinite(*value))
        fail({.line = line, .column = column + 1},
             "'" + cell.substr(0, 40) + "': must be a number");
      return *value;
    };
    bool begins = row == 0;
    if (part >= 0) {
      if (part >= std::ssize(cells)) fail({.line = line}, "has no part");
      const std::string& now = cells[static_cast<std::size_t>(part)];
      begins = begins || now != current;
      current = now;
    } else if (row > 0) {
      for (int k = table.line(row - 1) + 1; k < line; ++k)
        begins = begins || (k < std::ssize(empty) && empty[static_cast<std::size_t>(k)]);
    }
    if (begins) drawing.outlines.emplace_back();
    drawing.outlines.back().push_back({number(y), number(z)});
  }
  if (drawing.outlines.empty()) fail({}, "holds no corners");
  return drawing;
}

Drawing read_outlines(const std::filesystem::path& path) {
  const std::string bytes = read_bytes(path);
  if (lower(path.extension().string()) == ".dxf") return parse_dxf(bytes, path);
  return parse_outline_table(bytes, path);
}

}  // namespace wheeltap::io
