#include "emulator/runs_csv.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "io/bytes.hpp"
#include "io/tables/delimited_text.hpp"

namespace wheeltap::emulator {
namespace {

namespace fs = std::filesystem;
using Kind = io::FileError::Kind;

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
constexpr int kMostResponses = 10'000;

/// A name and its number: {"f", 1} of "f1", "f[1]" or "f_1"; the number is 0 if there is none.
std::pair<std::string, int> numbered(std::string name) {
  if (!name.empty() && (name.back() == ']' || name.back() == ')')) name.pop_back();
  const std::size_t digits = name.find_last_not_of("0123456789") + 1;
  int number = 0;
  for (std::size_t i = digits; i < name.size() && number < kMostResponses; ++i)
    number = 10 * number + (name[i] - '0');
  name.resize(digits);
  while (!name.empty() && std::string_view(" _-[(").find(name.back()) != std::string_view::npos)
    name.pop_back();
  return {name, number};
}

/// A column of a response: its place in the table from 0, and its conversion.
struct Response {
  std::size_t column = 0;
  std::size_t place = 0;
  double factor = 1.0;
};

/// The responses in the columns that are not factors. `fail` throws.
std::vector<Response> find_responses(const std::vector<io::Column>& columns,
                                     const std::vector<std::ptrdiff_t>& factor_of,
                                     const ResponseColumns& wanted,
                                     const std::function<void(const std::string&)>& fail) {
  std::vector<Response> out;
  std::string stem;
  std::map<int, std::string> names;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (factor_of[c] >= 0) continue;
    const io::Column& column = columns[c];
    const auto [name, number] = numbered(column.name);
    if (number == 0 || name.empty())
      fail("the column \"" + column.header +
           "\" is neither a factor nor a numbered response: name the responses f1, f2, …, and "
           "delete other columns");
    if (number >= kMostResponses)
      fail("the column \"" + column.header + "\" has a number above " +
           std::to_string(kMostResponses - 1));
    if (out.empty()) stem = name;
    if (name != stem)
      fail("the columns \"" + columns[out[0].column].header + "\" and \"" + column.header +
           "\" have different names before their numbers: name the responses " + stem + "1, " +
           stem + "2, …, and delete other columns");
    if (const auto [before, is_new] = names.emplace(number, column.header); !is_new)
      fail("the columns \"" + before->second + "\" and \"" + column.header +
           "\" are the same response");
    const io::Column& first = columns[out.empty() ? c : out[0].column];
    if (column.unit.empty() != first.unit.empty() || (!wanted.factor && column.unit != first.unit))
      fail("the responses are in different units, \"" + first.unit + "\" and \"" + column.unit +
           "\"");
    const auto factor = wanted.factor ? wanted.factor(column) : 1.0;
    if (!factor) fail("the unit of \"" + column.header + "\" must be one of " + wanted.units);
    out.push_back({c, static_cast<std::size_t>(number - 1), *factor});
  }
  if (out.empty()) fail("no column is a response");
  int expected = 1;
  for (const auto& [number, header] : names)
    if (number != expected++)
      fail("the responses have no number " + std::to_string(expected - 1) + ", but \"" + header +
           "\": number them from 1 without gaps");
  return out;
}

}  // namespace

Table parse_runs_csv(std::string bytes, const fs::path& name, std::vector<Factor> factors,
                     const ResponseColumns& responses) {
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
    const auto own = std::find_if(columns.begin(), columns.end(),
                                  [&](const io::Column& c) { return c.name == factors[j].name; });
    if (own == columns.end()) fail("no column for the factor \"" + factors[j].name + "\"");
    factor_of[static_cast<std::size_t>(own - columns.begin())] = static_cast<std::ptrdiff_t>(j);
    if (factors[j].unit.empty()) factors[j].unit = own->unit;
    if (!own->unit.empty() && own->unit != factors[j].unit)
      fail("the factor \"" + factors[j].name + "\" is in " + own->unit + " here, not in " +
           factors[j].unit);
  }
  const std::vector<Response> found = find_responses(columns, factor_of, responses, fail);
  std::vector<Response> response_of(columns.size());
  for (const Response& response : found) response_of[response.column] = response;
  Table table{.factors = {},
              .points = {},
              .response_name = responses.name,
              .response_unit = responses.factor ? responses.unit : columns[found[0].column].unit,
              .values = {},
              .holdout = {},
              .attributes = {},
              .parameters = {}};

  std::vector<double> points, values;
  std::map<std::vector<double>, int> line_of;
  for (int run = 0; run < text.rows(); ++run) {
    line_number = text.line(run);
    const auto cells = text.cells(run);
    if (cells.size() != columns.size())
      fail(std::to_string(cells.size()) + " fields under " + std::to_string(columns.size()) +
           " column names");
    std::vector<double> point(factors.size());
    const std::size_t first_value = values.size();
    values.resize(first_value + found.size());
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const double value = text.number(cells[c]).value_or(kNoNumber);
      if (!std::isfinite(value))
        fail("column \"" + columns[c].name + "\" holds \"" + cells[c] +
             "\", which is not a finite number");
      if (factor_of[c] < 0) {
        const Response& response = response_of[c];
        values[first_value + response.place] = response.factor * value;
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
  table.values =
      Eigen::Map<RowMatrix>(values.data(), runs, static_cast<Eigen::Index>(found.size()));
  for (std::size_t j = 0; j < factors.size(); ++j) {
    if (!factors[j].levels.empty()) continue;
    const auto own = table.points.col(static_cast<Eigen::Index>(j));
    if (!(own.minCoeff() < own.maxCoeff()))
      throw io::FileError(Kind::corrupt, name,
                          "the factor \"" + factors[j].name + "\" never varies");
    factors[j].levels = {own.minCoeff(), own.maxCoeff()};
  }
  table.factors = std::move(factors);
  check_table(responses.name, table);
  return table;
}

Table read_runs_csv(const fs::path& path, std::vector<Factor> factors,
                    const ResponseColumns& responses) {
  return parse_runs_csv(io::read_bytes(path), path, std::move(factors), responses);
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
