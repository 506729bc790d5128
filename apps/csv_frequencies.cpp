#include "apps/csv_frequencies.hpp"

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>

namespace wheeltap::apps {
namespace {

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\r\"");
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r\"") - first + 1);
}

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(trimmed(cell));
  if (!line.empty() && line.back() == ',') cells.emplace_back();
  return cells;
}

// "frequency [Hz]" is the column "frequency".
std::string without_unit(const std::string& header) {
  return trimmed(header.substr(0, header.find('[')));
}

struct Line {
  int number;
  std::vector<std::string> cells;
};

}  // namespace

FrequencyTable read_frequency_csv(const std::filesystem::path& path, const FrequencyCells& cells) {
  std::ifstream stream(path);
  if (!stream) {
    throw Failure(Exit::no_input, path.string() + ": cannot be read: " + std::strerror(errno));
  }
  const auto refuse = [&](int line, std::size_t column, const std::string& message) {
    std::string place = path.string() + ":" + std::to_string(line);
    if (column > 0) place += ":" + std::to_string(column);
    throw Failure(Exit::bad_input, place + ": " + message);
  };

  std::vector<Line> lines;
  int number = 0;
  for (std::string text; std::getline(stream, text);) {
    ++number;
    if (trimmed(text).empty() || text[0] == '#') continue;
    lines.push_back({number, split(text)});
  }
  if (lines.size() < 2) refuse(number, 0, "a header line and at least one row are needed");
  const Line& header = lines[0];

  const auto column_of = [&](const std::string& name) -> std::size_t {
    for (std::size_t c = 0; c < header.cells.size(); ++c) {
      if (header.cells[c] == name || without_unit(header.cells[c]) == name) return c;
    }
    std::size_t index = 0;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), index);
    if (error == std::errc() && end == name.data() + name.size() && index >= 1 &&
        index <= header.cells.size()) {
      return index - 1;
    }
    return std::string::npos;
  };
  const auto names = [&] {
    std::string list;
    for (const std::string& cell : header.cells) list += (list.empty() ? "" : ", ") + cell;
    return list;
  };
  const auto cell = [&](const Line& line, std::size_t column, bool may_be_empty) {
    if (column >= line.cells.size()) {
      refuse(line.number, 0,
             "has " + std::to_string(line.cells.size()) + " cells, the header has " +
                 std::to_string(header.cells.size()));
    }
    const std::string& text = line.cells[column];
    if (text.empty() && may_be_empty) return std::numeric_limits<double>::quiet_NaN();
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value) ||
        value <= 0.0) {
      refuse(line.number, column + 1,
             "\"" + text + "\": must be a number > 0 in Hz, or empty for a mode not measured");
    }
    return value;
  };

  FrequencyTable table;
  if (cells.columns.empty()) {
    const std::size_t frequency = column_of("frequency");
    const std::size_t sd = column_of("sd");
    if (frequency == std::string::npos) {
      refuse(header.number, 0,
             "no column \"frequency\" among " + names() +
                 "; name the columns in the case's data.columns");
    }
    for (std::size_t i = 1; i < lines.size(); ++i) {
      table.frequencies_hz.push_back(cell(lines[i], frequency, true));
      if (sd != std::string::npos) table.sd_hz.push_back(cell(lines[i], sd, true));
    }
    return table;
  }
  if (cells.row > static_cast<int>(lines.size()) - 1) {
    refuse(header.number, 0,
           "row " + std::to_string(cells.row) + " is asked for, there are " +
               std::to_string(lines.size() - 1) + " below the header");
  }
  const Line& line = lines[static_cast<std::size_t>(cells.row)];
  for (const std::string& name : cells.columns) {
    const std::size_t column = column_of(name);
    if (column == std::string::npos) {
      refuse(header.number, 0, "no column \"" + name + "\" among " + names());
    }
    table.frequencies_hz.push_back(cell(line, column, true));
  }
  return table;
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
