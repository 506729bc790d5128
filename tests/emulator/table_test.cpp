#include "emulator/table.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "emulator/experiment.hpp"

namespace wheeltap::emulator {
namespace {

constexpr double kNotRun = std::numeric_limits<double>::quiet_NaN();

ModelFactory sums() {
  return [] {
    return [](std::span<const double> x, std::span<double> y) {
      y[0] = x[0] + x[1];
      y[1] = x[0] - x[1];
    };
  };
}

Table grid_table() {
  Table t;
  t.factors = {{"location", "m", {0.1, 0.2, 0.3}}, {"reduction", "", {0, 0.3, 0.6}}};
  t.response_name = "frequency";
  t.response_unit = "Hz";
  t.values = run_experiment(t.design(), 2, sums());
  return t;
}

/// The table with only the runs of one shard.
Table part_of(const Table& whole, Eigen::Index part, Eigen::Index parts) {
  Table t = whole;
  t.values.setConstant(kNotRun);
  const RowMatrix values = run_experiment(shard(whole.design(), part, parts), 2, sums());
  for (Eigen::Index i = 0; i < values.rows(); ++i) t.values.row(part + i * parts) = values.row(i);
  return t;
}

TableFile file(const Table& t) {
  return {.attributes = {{"case", "{}"}, {"fingerprint", "f00"}}, .tables = {{"count_1", t}}};
}

std::string merge_error(const std::vector<TableFile>& shards) {
  try {
    (void)merge(shards);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(Table, HalvesMergeIntoTheWhole) {
  const Table whole = grid_table();
  for (Eigen::Index parts : {1, 2, 3, 9}) {
    std::vector<TableFile> shards;
    for (Eigen::Index part = 0; part < parts; ++part) {
      shards.push_back(file(part_of(whole, part, parts)));
      EXPECT_EQ(shards.back().tables.at("count_1").missing_runs(),
                9 - (9 - part + parts - 1) / parts);
    }
    const TableFile merged = merge(shards);
    EXPECT_EQ(merged.tables.at("count_1").values, whole.values);
    EXPECT_EQ(merged.attributes, shards[0].attributes);
  }
}

TEST(Table, KeepsAMissingPartMissing) {
  const Table whole = grid_table();
  const TableFile merged =
      merge(std::vector{file(part_of(whole, 0, 3)), file(part_of(whole, 2, 3))});
  EXPECT_EQ(merged.tables.at("count_1").missing_runs(), 3);
}

TEST(Table, ConcatenatesScatteredRuns) {
  Table whole = grid_table();
  whole.points = latin_hypercube(whole.factors, 10, 4).points;
  whole.values = run_experiment(whole.design(), 2, sums());
  EXPECT_FALSE(whole.is_grid());
  Table first = whole, second = whole;
  first.points = whole.points.topRows(6);
  first.values = whole.values.topRows(6);
  second.points = whole.points.bottomRows(6);  // two points occur in both
  second.values = whole.values.bottomRows(6);
  const Table merged = merge(std::vector{file(first), file(second)}).tables.at("count_1");
  EXPECT_EQ(merged.points, whole.points);
  EXPECT_EQ(merged.values, whole.values);
}

TEST(Table, KeepsOnlyCommonAttributes) {
  TableFile a = file(grid_table()), b = a;
  a.attributes["command"] = "part 1";
  b.attributes["command"] = "part 2";
  a.tables["count_1"].holdout = {{1, 2, 3, 0.9}, {1, 2, 3, 0.9}};
  a.tables["count_1"].attributes = {{"emulator", "multilinear"}, {"note", "x"}};
  b.tables["count_1"].attributes = {{"emulator", "multilinear"}};
  a.tables["count_1"].parameters["lengths"] = RowMatrix::Ones(2, 2);
  const TableFile merged = merge(std::vector{a, b});
  EXPECT_FALSE(merged.attributes.contains("command"));
  EXPECT_TRUE(merged.tables.at("count_1").holdout.empty());
  EXPECT_EQ(merged.tables.at("count_1").attributes.size(), 1u);
  EXPECT_TRUE(merged.tables.at("count_1").parameters.empty());
}

TEST(Table, RejectsPartsOfDifferentTables) {
  const TableFile a = file(grid_table());
  EXPECT_NE(merge_error({}), "");
  TableFile other_case = a;
  other_case.attributes["fingerprint"] = "bar";
  EXPECT_NE(merge_error({a, other_case}).find("fingerprint"), std::string::npos);
  TableFile other_levels = a;
  other_levels.tables["count_1"].factors[0].levels[1] = 0.21;
  EXPECT_NE(merge_error({a, other_levels}).find("factors"), std::string::npos);
  TableFile other_tables = a;
  other_tables.tables["count_2"] = grid_table();
  EXPECT_NE(merge_error({a, other_tables}), "");
  TableFile other_value = a;
  other_value.tables["count_1"].values(4, 1) += 1e-9;
  EXPECT_NE(merge_error({a, other_value}).find("run 4"), std::string::npos);
}

TEST(Table, ChecksNameTheTable) {
  const auto error = [](const Table& t) -> std::string {
    try {
      check_table("count_1", t);
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(error(grid_table()), "");
  for (const char* taken : {"run", "response", "frequency", "holdout_rmse", "parameter_x"}) {
    Table t = grid_table();
    t.factors[0].name = taken;
    EXPECT_NE(error(t).find(taken), std::string::npos);
  }
  Table rows = grid_table();
  rows.values.conservativeResize(8, 2);
  EXPECT_NE(error(rows).find("count_1"), std::string::npos);
  Table points = grid_table();
  points.points = RowMatrix::Zero(9, 3);
  EXPECT_NE(error(points), "");
  points.points = RowMatrix::Zero(9, 2);
  EXPECT_EQ(error(points), "");
  points.points(3, 1) = kNotRun;
  EXPECT_NE(error(points), "");
  Table parameter = grid_table();
  parameter.parameters["lengths"] = RowMatrix();
  EXPECT_NE(error(parameter), "");
}

TEST(Shard, PartsCoverTheDesignOnce) {
  const Design whole = grid_table().design();
  Eigen::Index runs = 0;
  for (Eigen::Index part = 0; part < 4; ++part) runs += shard(whole, part, 4).runs();
  EXPECT_EQ(runs, 9);
  EXPECT_EQ(shard(whole, 1, 4).points.row(1), whole.points.row(5));
  EXPECT_THROW((void)shard(whole, 4, 4), std::invalid_argument);
  EXPECT_THROW((void)shard(whole, -1, 4), std::invalid_argument);
  EXPECT_THROW((void)shard(whole, 9, 10), std::invalid_argument);
}

}  // namespace
}  // namespace wheeltap::emulator
