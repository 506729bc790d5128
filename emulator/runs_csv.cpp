#include "emulator/runs_csv.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "io/bytes.hpp"
#include "io/tables/delimited_text.hpp"

namespace wheeltap::emulator {
namespace {

namespace fs = std::filesystem;
using Kind = io::FileError::Kind;

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
}  // namespace

Table parse_runs_csv(std::string bytes, const fs::path& name, std::vector<Factor> factors,
                     const std::string& response_name) {
  const io::DelimitedText text(std::move(bytes), name, io::FirstRow::header);
  if (text.header_line() == 0)
    throw io::FileError(Kind::corrupt, name, "no line with column names");
  int line_number = text.header_line();
  const auto fail = [&](const std::string& reason) {
    throw io::FileError(Kind::corrupt, name, "line " + std::to_string(line_number) + ": " + reason);
  };
  const std::vector<io::Column>& columns = text.headers();
  std::set<std::string> names;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (columns[c].name.empty()) fail("column " + std::to_string(c + 1) + " has no name");
    if (!names.insert(columns[c].name).second)
      fail("the column \"" + columns[c].name + "\" occurs twice");
  }

  // Factor of a column; -1 for a response.
  std::vector<std::ptrdiff_t> factor_of(columns.size(), -1);
  for (std::size_t j = 0; j < factors.size(); ++j) {
    const auto found = std::find_if(columns.begin(), columns.end(),
                                    [&](const io::Column& c) { return c.name == factors[j].name; });
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
  std::map<std::vector<double>, int> line_of;
  for (int run = 0; run < text.rows(); ++run) {
    line_number = text.line(run);
    const auto cells = text.cells(run);
    if (cells.size() != columns.size())
      fail(std::to_string(cells.size()) + " fields under " + std::to_string(columns.size()) +
           " column names");
    std::vector<double> point(factors.size());
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const double value = text.number(cells[c]).value_or(kNoNumber);
      if (!std::isfinite(value))
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
  if (line_of.empty()) throw io::FileError(Kind::corrupt, name, "no runs");
  const auto runs = static_cast<Eigen::Index>(line_of.size());
  table.points =
      Eigen::Map<RowMatrix>(points.data(), runs, static_cast<Eigen::Index>(factors.size()));
  table.values = Eigen::Map<RowMatrix>(values.data(), runs,
                                       static_cast<Eigen::Index>(columns.size() - factors.size()));
  for (std::size_t j = 0; j < factors.size(); ++j) {
    if (!factors[j].levels.empty()) continue;
    const auto own = table.points.col(static_cast<Eigen::Index>(j));
    if (!(own.minCoeff() < own.maxCoeff()))
      throw io::FileError(Kind::corrupt, name,
                          "the factor \"" + factors[j].name + "\" never varies");
    factors[j].levels = {own.minCoeff(), own.maxCoeff()};
  }
  table.factors = std::move(factors);
  check_table(response_name, table);
  return table;
}

Table read_runs_csv(const fs::path& path, std::vector<Factor> factors,
                    const std::string& response_name) {
  return parse_runs_csv(io::read_bytes(path), path, std::move(factors), response_name);
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
