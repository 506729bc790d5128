#include "emulator/runs_csv.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <map>
#include <optional>
#include <set>

#include "io/atomic_file.hpp"

namespace wheeltap::emulator {
namespace {

namespace fs = std::filesystem;
using Kind = io::FileError::Kind;

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// The fields of one line, trimmed and without their quotes.
std::vector<std::string> fields(std::string_view line) {
  std::vector<std::string> out;
  std::string field;
  bool quoted = false;
  for (std::size_t i = 0; i <= line.size(); ++i) {
    if (i == line.size() || (line[i] == ',' && !quoted)) {
      out.emplace_back(trimmed(field));
      field.clear();
    } else if (line[i] != '"') {
      field += line[i];
    } else if (quoted && i + 1 < line.size() && line[i + 1] == '"') {
      field += line[i++];
    } else {
      quoted = !quoted;
    }
  }
  return out;
}

struct Column {
  std::string name, unit;
};

/// "frequency [Hz]" → frequency, Hz. Only a bracket after a space is a unit: location[1] is a name.
Column column(const std::string& text) {
  const auto open = text.rfind(" [");
  if (open == std::string::npos || text.back() != ']') return {.name = text, .unit = ""};
  return {.name = std::string(trimmed(std::string_view(text).substr(0, open))),
          .unit = text.substr(open + 2, text.size() - open - 3)};
}

std::string heading(const Factor& factor) {
  return factor.unit.empty() ? factor.name : factor.name + " [" + factor.unit + "]";
}

}  // namespace

Table read_runs_csv(const fs::path& path, std::vector<Factor> factors,
                    const std::string& response_name) {
  std::ifstream stream(path);
  std::error_code error;
  if (!stream || fs::is_directory(path, error))
    throw io::FileError(Kind::missing, path, "no such file, or it cannot be read");
  std::size_t line_number = 0;
  const auto fail = [&](const std::string& reason) {
    throw io::FileError(Kind::corrupt, path, "line " + std::to_string(line_number) + ": " + reason);
  };
  const auto next_line = [&](std::string& line) {
    while (std::getline(stream, line)) {
      ++line_number;
      const auto content = trimmed(line);
      if (!content.empty() && content.front() != '#') return true;
    }
    return false;
  };

  std::string line;
  if (!next_line(line)) throw io::FileError(Kind::corrupt, path, "no line with column names");
  if (line.starts_with("\xef\xbb\xbf")) line.erase(0, 3);  // a byte order mark
  std::vector<Column> columns;
  std::set<std::string> names;
  for (const std::string& text : fields(line)) {
    columns.push_back(column(text));
    if (columns.back().name.empty())
      fail("column " + std::to_string(columns.size()) + " has no name");
    if (!names.insert(columns.back().name).second)
      fail("the column \"" + columns.back().name + "\" is there twice");
  }

  // Which factor a column is; -1 for a response.
  std::vector<std::ptrdiff_t> factor_of(columns.size(), -1);
  for (std::size_t j = 0; j < factors.size(); ++j) {
    const auto found = std::find_if(columns.begin(), columns.end(),
                                    [&](const Column& c) { return c.name == factors[j].name; });
    if (found == columns.end()) fail("no column for the factor \"" + factors[j].name + "\"");
    factor_of[static_cast<std::size_t>(found - columns.begin())] = static_cast<std::ptrdiff_t>(j);
    if (factors[j].unit.empty()) factors[j].unit = found->unit;
    if (!found->unit.empty() && found->unit != factors[j].unit)
      fail("the factor \"" + factors[j].name + "\" is in " + found->unit + " here, not in " +
           factors[j].unit);
  }
  Table table{.factors = {},
              .points = {},
              .response_name = response_name,
              .response_unit = "",
              .values = {},
              .holdout = {},
              .attributes = {},
              .parameters = {}};
  bool first_response = true;
  for (std::size_t c = 0; c < columns.size(); ++c)
    if (factor_of[c] < 0) {
      if (!first_response && columns[c].unit != table.response_unit)
        fail("the responses are in different units, \"" + table.response_unit + "\" and \"" +
             columns[c].unit + "\"");
      table.response_unit = columns[c].unit;
      first_response = false;
    }
  if (first_response) fail("no column is a response");

  std::vector<double> points, values;
  std::map<std::vector<double>, std::size_t> line_of;
  while (next_line(line)) {
    const auto cells = fields(line);
    if (cells.size() != columns.size())
      fail(std::to_string(cells.size()) + " fields under " + std::to_string(columns.size()) +
           " column names");
    std::vector<double> point(factors.size());
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const char* const last = cells[c].data() + cells[c].size();
      double value = 0.0;
      const auto [end, status] = std::from_chars(cells[c].data(), last, value);
      if (status != std::errc() || end != last || !std::isfinite(value))
        fail("column \"" + columns[c].name + "\" holds \"" + cells[c] +
             "\", which is not a finite number");
      if (factor_of[c] < 0) {
        values.push_back(value);
        continue;
      }
      const Factor& factor = factors[static_cast<std::size_t>(factor_of[c])];
      if (!factor.levels.empty() && !(value >= factor.low() && value <= factor.high()))
        fail("column \"" + factor.name + "\" holds " + cells[c] +
             ", outside the range given for it");
      point[static_cast<std::size_t>(factor_of[c])] = value;
    }
    if (const auto [other, is_new] = line_of.emplace(point, line_number); !is_new)
      fail("the same point as line " + std::to_string(other->second));
    points.insert(points.end(), point.begin(), point.end());
  }
  if (line_of.empty()) throw io::FileError(Kind::corrupt, path, "no runs");
  const auto runs = static_cast<Eigen::Index>(line_of.size());
  table.points =
      Eigen::Map<RowMatrix>(points.data(), runs, static_cast<Eigen::Index>(factors.size()));
  table.values = Eigen::Map<RowMatrix>(values.data(), runs,
                                       static_cast<Eigen::Index>(columns.size() - factors.size()));
  for (std::size_t j = 0; j < factors.size(); ++j) {
    if (!factors[j].levels.empty()) continue;
    const auto own = table.points.col(static_cast<Eigen::Index>(j));
    if (!(own.minCoeff() < own.maxCoeff()))
      throw io::FileError(Kind::corrupt, path,
                          "the factor \"" + factors[j].name + "\" never varies");
    factors[j].levels = {own.minCoeff(), own.maxCoeff()};
  }
  table.factors = std::move(factors);
  check_table(response_name, table);
  return table;
}

void write_design_csv(const fs::path& path, const Design& design) {
  check_factors(design.factors, 1);
  io::AtomicFile file(path);
  std::ofstream stream(file.temporary());
  stream.precision(17);
  for (std::size_t j = 0; j < design.factors.size(); ++j)
    stream << (j ? "," : "") << heading(design.factors[j]);
  stream << '\n';
  for (Eigen::Index i = 0; i < design.runs(); ++i)
    for (Eigen::Index j = 0; j < design.points.cols(); ++j)
      stream << design.points(i, j) << (j + 1 < design.points.cols() ? ',' : '\n');
  stream.close();
  if (!stream) throw io::FileError(Kind::unwritable, path, "cannot be written (is the disk full?)");
  file.commit();
}

std::optional<Table> as_grid(const Table& scattered) {
  if (scattered.is_grid()) return scattered;
  Table grid = scattered;
  grid.points.resize(0, 0);
  std::vector<std::map<double, Eigen::Index>> index(scattered.factors.size());
  Eigen::Index runs = 1;
  for (std::size_t j = 0; j < index.size(); ++j) {
    for (double x : scattered.points.col(static_cast<Eigen::Index>(j))) index[j][x] = 0;
    grid.factors[j].levels.clear();
    for (auto& [level, place] : index[j]) {
      place = static_cast<Eigen::Index>(grid.factors[j].levels.size());
      grid.factors[j].levels.push_back(level);
    }
    runs *= static_cast<Eigen::Index>(index[j].size());
    if (runs > scattered.points.rows()) return std::nullopt;
  }
  if (runs != scattered.points.rows()) return std::nullopt;
  std::vector<char> seen(static_cast<std::size_t>(runs), 0);
  for (Eigen::Index i = 0; i < runs; ++i) {
    Eigen::Index row = 0;
    for (std::size_t j = 0; j < index.size(); ++j)
      row = row * static_cast<Eigen::Index>(index[j].size()) +
            index[j].at(scattered.points(i, static_cast<Eigen::Index>(j)));
    if (seen[static_cast<std::size_t>(row)]++) return std::nullopt;
    grid.values.row(row) = scattered.values.row(i);
  }
  return grid;
}

}  // namespace wheeltap::emulator
