#include "emulator/table.hpp"

#include <algorithm>
#include <functional>
#include <stdexcept>

namespace wheeltap::emulator {
namespace {

/// Names of variables, dimensions and attributes that the file format reserves.
constexpr std::string_view kOwnNames[] = {"response", "run", "response_name"};
constexpr std::string_view kOwnPrefixes[] = {"holdout_", "parameter_"};

bool reserved(const Table& t, const std::string& name) {
  return name == t.response_name || std::ranges::count(kOwnNames, name) > 0 ||
         std::ranges::any_of(kOwnPrefixes, [&](auto prefix) { return name.starts_with(prefix); });
}

bool same(const std::vector<Factor>& a, const std::vector<Factor>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Factor& p, const Factor& q) {
    return p.name == q.name && p.unit == q.unit && p.levels == q.levels && p.scale == q.scale;
  });
}

/// Removes the entries of `a` that are missing in `b`, or have another value there.
template <class Map, class Same>
void keep_common(Map& a, const Map& b, Same alike) {
  std::erase_if(a, [&](const auto& item) {
    const auto found = b.find(item.first);
    return found == b.end() || !alike(found->second, item.second);
  });
}

/// Copies a run of `b` into a row that may already hold this run; `where` names the run in errors.
void put_run(RowMatrix& values, Eigen::Index row, const Table& b, Eigen::Index from,
             const std::string& where) {
  if (b.values.row(from).hasNaN()) return;
  if (!values.row(row).hasNaN() && values.row(row) != b.values.row(from))
    throw std::invalid_argument(where + ": two parts have different values for run " +
                                std::to_string(from));
  values.row(row) = b.values.row(from);
}

void merge_table(Table& a, const Table& b, const std::string& where) {
  if (!same(a.factors, b.factors) || a.is_grid() != b.is_grid() ||
      a.response_name != b.response_name || a.response_unit != b.response_unit ||
      a.values.cols() != b.values.cols())
    throw std::invalid_argument(where + ": the parts have different factors or responses");
  if (a.is_grid()) {
    for (Eigen::Index i = 0; i < a.values.rows(); ++i) put_run(a.values, i, b, i, where);
  } else {
    std::map<std::vector<double>, Eigen::Index> rows;
    const auto point = [](const Table& t, Eigen::Index i) {
      return std::vector<double>(t.points.row(i).begin(), t.points.row(i).end());
    };
    for (Eigen::Index i = 0; i < a.points.rows(); ++i) rows.emplace(point(a, i), i);
    for (Eigen::Index i = 0; i < b.points.rows(); ++i) {
      const auto [at, is_new] = rows.emplace(point(b, i), a.points.rows());
      if (is_new) {
        a.points.conservativeResize(a.points.rows() + 1, Eigen::NoChange);
        a.values.conservativeResize(a.values.rows() + 1, Eigen::NoChange);
        a.points.bottomRows<1>() = b.points.row(i);
        a.values.bottomRows<1>() = b.values.row(i);
      } else {
        put_run(a.values, at->second, b, i, where);
      }
    }
  }
  keep_common(a.attributes, b.attributes, std::equal_to<>());
  keep_common(a.parameters, b.parameters, [](const RowMatrix& p, const RowMatrix& q) {
    return p.rows() == q.rows() && p.cols() == q.cols() && p == q;
  });
  if (a.holdout != b.holdout) a.holdout.clear();
}

}  // namespace

Design Table::design() const {
  if (is_grid()) return full_factorial(factors);
  return {.factors = factors, .points = points};
}

Eigen::Index Table::missing_runs() const {
  return values.array().isNaN().rowwise().any().count();
}

void check_table(const std::string& name, const Table& t) {
  const std::string who = "table \"" + name + "\"";
  check_factors(t.factors, 1);
  Eigen::Index runs = t.is_grid() ? 1 : t.points.rows();
  for (const Factor& factor : t.factors) {
    if (reserved(t, factor.name))
      throw std::invalid_argument(who + ": a factor may not be called \"" + factor.name + "\"");
    if (t.is_grid()) runs *= static_cast<Eigen::Index>(factor.levels.size());
  }
  if (!t.is_grid() && t.points.cols() != static_cast<Eigen::Index>(t.factors.size()))
    throw std::invalid_argument(who + ": points with " + std::to_string(t.points.cols()) +
                                " coordinates for " + std::to_string(t.factors.size()) +
                                " factors");
  if (!t.points.allFinite())
    throw std::invalid_argument(who + ": a point has a coordinate that is not finite");
  if (t.response_name.empty()) throw std::invalid_argument(who + ": the response has no name");
  if (t.values.cols() < 1 || t.values.rows() != runs)
    throw std::invalid_argument(who + ": values are " + std::to_string(t.values.rows()) + " x " +
                                std::to_string(t.values.cols()) + " for a design of " +
                                std::to_string(runs) + " runs");
  if (!t.holdout.empty() && t.holdout.size() != static_cast<std::size_t>(t.values.cols()))
    throw std::invalid_argument(who + ": " + std::to_string(t.holdout.size()) +
                                " holdout errors for " + std::to_string(t.values.cols()) +
                                " responses");
  for (const auto& [key, matrix] : t.parameters)
    if (matrix.size() == 0)
      throw std::invalid_argument(who + ": the parameter \"" + key + "\" is empty");
  if (t.attributes.contains("response_name"))
    throw std::invalid_argument(who + ": response_name is a reserved name of an attribute");
}

TableFile merge(std::span<const TableFile> shards) {
  if (shards.empty()) throw std::invalid_argument("no tables to merge");
  TableFile whole = shards.front();
  for (const TableFile& part : shards.subspan(1)) {
    for (const char* key : {"case", "fingerprint"}) {
      const auto value = [key](const TableFile& file) {
        const auto found = file.attributes.find(key);
        return found == file.attributes.end() ? std::string() : found->second;
      };
      if (value(whole) != value(part))
        throw std::invalid_argument(
            std::string("the parts were computed for different cases (their ") + key + " differs)");
    }
    keep_common(whole.attributes, part.attributes, std::equal_to<>());
    if (whole.tables.size() != part.tables.size())
      throw std::invalid_argument("the parts hold different tables");
    for (auto& [name, table] : whole.tables) {
      const auto other = part.tables.find(name);
      if (other == part.tables.end())
        throw std::invalid_argument("only one of the parts has the table \"" + name + "\"");
      merge_table(table, other->second, "table \"" + name + "\"");
    }
  }
  return whole;
}

}  // namespace wheeltap::emulator
