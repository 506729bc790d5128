// Six random structures; the study's score must separate a calibrated posterior from others.
// 200 cases: `structure_coverage --keep rows.jsonl`.
#include <gmock/gmock.h>

#include <cmath>

#include "base/random.hpp"
#include "coverage_score.hpp"

namespace wheeltap::coverage {
namespace {

/// Rows of a made-up posterior: two combinations of counts, P of the second drawn from U(0, 1), and
/// true with probability P^`boldness` / (…): calibrated for 1. Ranks are U(0, 1), drawn towards
/// the ends by `narrow` > 1: an interval that is too narrow.
std::vector<Row> made_up(int n, double boldness, double narrow) {
  std::vector<Row> rows;
  for (int i = 0; i < n; ++i) {
    base::Random random(7, static_cast<std::uint64_t>(i), 0, base::Purpose::test);
    const double p = random.uniform();
    const double a = std::pow(p, boldness), b = std::pow(1.0 - p, boldness);
    const double u = random.uniform() - 0.5;
    Row row{.number = i, .kinds = {"crack"}, .most = {1}, .converged = true};
    row.truth = {random.uniform() < p ? 1 : 0};
    row.models = {{{0}, b / (a + b)}, {{1}, a / (a + b)}};
    row.ranks["place"] = {0.5 + std::copysign(0.5 * std::pow(std::abs(2.0 * u), 1.0 / narrow), u)};
    rows.push_back(row);
  }
  return rows;
}

TEST(StructureCoverage, TheScoreTellsCalibratedFromBold) {
  EXPECT_THAT(faults(made_up(400, 1.0, 1.0)), testing::IsEmpty());
  EXPECT_THAT(faults(made_up(400, 3.0, 1.0)), testing::Contains(testing::HasSubstr("expected")));
  EXPECT_THAT(faults(made_up(400, 1.0, 2.0)),
              testing::Contains(testing::HasSubstr("place: 90 % intervals held")));
}

// 18 of 20: (0.683, 0.988), Clopper & Pearson 1934, as printed in many tables.
TEST(StructureCoverage, BoundsOfAShare) {
  std::vector<double> ranks(18, 0.5);
  ranks.insert(ranks.end(), {0.01, 0.99});
  const Coverage c = coverage("x", ranks);
  EXPECT_EQ(c.held, 18);
  EXPECT_NEAR(c.lowest, 0.683, 5e-4);
  EXPECT_NEAR(c.highest, 0.988, 5e-4);
}

TEST(StructureCoverage, AnUnflaggedTruthThatNoDrawComesNearIsAFault) {
  std::vector<Row> rows = made_up(1, 1.0, 1.0);
  rows[0].truth_above_draws = 5.0;
  EXPECT_THAT(faults(rows), testing::SizeIs(1));
  EXPECT_THAT(surprises(rows), testing::SizeIs(1));
  rows[0].warnings = {"misfit"};
  EXPECT_THAT(faults(rows), testing::IsEmpty());
}

TEST(StructureCoverage, ARowIsItsLine) {
  Row row = made_up(1, 1.0, 1.0)[0];
  row.family = "frame 1x2";
  row.warnings = {"a \"quoted\" one"};
  EXPECT_EQ(Row::from_line(row.to_line()).to_line(), row.to_line());
}

TEST(StructureCoverage, SixRandomStructures) {
  std::vector<Row> rows;
  for (int i = 0; i < 6; ++i) {
    rows.push_back(run(random_case(1, i), {.warmup = 1000, .draws = 2000, .searches = 60}));
    const Row& row = rows.back();
    EXPECT_LT(row.truth_above_draws, 1.0) << row.to_line();
    EXPECT_GT(row.probability_of_truth(), 1e-3) << row.to_line();
    // With about sixty ranks, one in 150 studies has a rank outside.
    for (const auto& [name, values] : row.ranks)
      for (const double u : values) {
        EXPECT_GT(u, 5e-5) << name << row.to_line();
        EXPECT_LT(u, 1.0 - 5e-5) << name << row.to_line();
      }
  }
  EXPECT_THAT(faults(rows), testing::IsEmpty());
}

}  // namespace
}  // namespace wheeltap::coverage
