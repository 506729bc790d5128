#include "emulator/design.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace wheeltap::emulator {
namespace {

using Factors = std::vector<Factor>;

std::string message(const Factors& factors) {
  try {
    check_factors(factors);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

double closest_pair(const RowMatrix& points) {
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    for (Eigen::Index j = 0; j < i; ++j)
      least = std::min(least, (points.row(i) - points.row(j)).norm());
  return least;
}

TEST(Design, FullFactorialRunsTheLastFactorFastest) {
  const Design design = full_factorial({{"a", "m", {1, 2}}, {"b", "", {10, 20, 30}}});
  ASSERT_EQ(design.runs(), 6);
  const double expected[6][2] = {{1, 10}, {1, 20}, {1, 30}, {2, 10}, {2, 20}, {2, 30}};
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 2; ++j) EXPECT_EQ(design.points(i, j), expected[i][j]);
}

TEST(Design, TheSourcesTablesHave40And1600Runs) {
  Factor site{"site", "", {5, 15, 25, 35, 45, 55, 65, 75, 85, 95}};
  Factor level{"multiplier", "", {0.4, 0.6, 0.8, 1.0}};
  EXPECT_EQ(full_factorial({site, level}).runs(), 40);
  Factor other_site = site, other_level = level;
  other_site.name = "site[2]";
  other_level.name = "multiplier[2]";
  EXPECT_EQ(full_factorial({site, level, other_site, other_level}).runs(), 1600);
}

TEST(Design, NamesInvalidFactors) {
  const double nan = std::nan("");
  EXPECT_NE(message({}).find("at least one factor"), std::string::npos);
  for (const Factor& bad :
       {Factor{"depth", "", {1, 1}}, Factor{"depth", "", {2, 1}}, Factor{"depth", "", {1}},
        Factor{"depth", "", {}}, Factor{"depth", "", {0, nan}},
        Factor{"depth", "", {0, std::numeric_limits<double>::infinity()}},
        Factor{"depth", "", {0, 1}, Scale::compliance},
        Factor{"depth", "", {0, 1}, Scale::logarithm},
        Factor{"depth", "", {0, 1}, Scale::reciprocal}})
    EXPECT_NE(message({bad}).find("\"depth\""), std::string::npos) << message({bad});
  EXPECT_NE(message({{"a", "", {0, 1}}, {"a", "", {0, 1}}}).find("listed twice"),
            std::string::npos);
  EXPECT_EQ(message({{"a", "", {0, 1}}}), "");
}

TEST(Design, ScalesInvertAndIncrease) {
  for (Scale scale : {Scale::linear, Scale::compliance, Scale::reciprocal, Scale::logarithm}) {
    EXPECT_EQ(scale_named(name(scale)), scale);
    double last = -std::numeric_limits<double>::infinity();
    for (double x = 0.05; x < 0.95; x += 0.1) {
      const double s = to_scale(scale, x);
      EXPECT_GT(s, last);
      last = s;
      EXPECT_NEAR(from_scale(scale, s), x, 1e-15);
    }
  }
  EXPECT_THROW((void)scale_named("cubic"), std::invalid_argument);
}

TEST(Design, ChecksPointsAgainstTheBox) {
  const Factors box = {{"r", "", {0, 0.5}}, {"x", "m", {1, 2}}};
  EXPECT_TRUE(contains(box, std::vector{0.0, 2.0}));
  EXPECT_FALSE(contains(box, std::vector{0.6, 1.5}));
  EXPECT_FALSE(contains(box, std::vector{0.1, std::nan("")}));
  EXPECT_FALSE(contains(box, std::vector{0.1}));
  try {
    require_inside(box, std::vector{0.25, 2.5});
    FAIL();
  } catch (const std::out_of_range& error) {
    EXPECT_STREQ(error.what(), "factor \"x\" = 2.5 lies outside the emulator's range [1, 2]");
  }
  EXPECT_THROW(require_inside(box, std::vector{0.1}), std::invalid_argument);
}

TEST(Design, LatinHypercubeUsesEachStratumOnceAndSpreads) {
  const Factors box = {{"a", "", {-1, 3}}, {"b", "", {0, 10}}, {"c", "", {0, 1}}};
  const Eigen::Index n = 60;
  const Design design = latin_hypercube(box, n, 7);
  for (Eigen::Index j = 0; j < 3; ++j) {
    std::vector<bool> used(static_cast<std::size_t>(n));
    const Factor& factor = box[static_cast<std::size_t>(j)];
    for (Eigen::Index i = 0; i < n; ++i) {
      const double u = (design.points(i, j) - factor.low()) / (factor.high() - factor.low());
      used.at(static_cast<std::size_t>(u * static_cast<double>(n))) = true;
    }
    EXPECT_TRUE(std::all_of(used.begin(), used.end(), [](bool b) { return b; }));
  }
  // Among twenty random designs of this size, the largest minimum distance is still below that of
  // the Latin hypercube.
  const Factors cube = {{"a", "", {0, 1}}, {"b", "", {0, 1}}, {"c", "", {0, 1}}};
  double best_random = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed)
    best_random = std::max(best_random, closest_pair(random_design(cube, n, seed).points));
  EXPECT_GT(closest_pair(latin_hypercube(cube, n, 7).points), best_random);
  EXPECT_EQ(latin_hypercube(cube, n, 7).points, latin_hypercube(cube, n, 7).points);
  EXPECT_NE(latin_hypercube(cube, n, 7).points, latin_hypercube(cube, n, 8).points);
}

TEST(Design, SobolFillsEveryBinaryBoxEqually) {
  const Factors square = {{"a", "", {0, 1}}, {"b", "", {0, 1}}};
  const Design design = sobol(square, 256, 3);
  // A (0, m, 2)-net in base 2 keeps its balance under a digital shift: 256 points have one in each
  // of the 16 × 16 boxes, if the sequence's missing origin is included.
  std::vector<int> count(256);
  for (Eigen::Index i = 0; i < 256; ++i)
    ++count[static_cast<std::size_t>(design.points(i, 0) * 16) * 16 +
            static_cast<std::size_t>(design.points(i, 1) * 16)];
  const auto off = std::count_if(count.begin(), count.end(), [](int c) { return c != 1; });
  EXPECT_LE(off, 2);
  EXPECT_EQ(design.points, sobol(square, 256, 3).points);
  EXPECT_NE(design.points, sobol(square, 256, 4).points);
}

TEST(Design, AddsCornersOnce) {
  const Factors box = {{"a", "", {0, 1, 3}}, {"b", "", {-1, 1}}};
  Design design = latin_hypercube(box, 5, 1);
  EXPECT_EQ(with_corners(design).runs(), 9);
  design.points.row(2) << 3, -1;
  const Design more = with_corners(design);
  EXPECT_EQ(more.runs(), 8);
  EXPECT_EQ(more.points.topRows(5), design.points);
  EXPECT_EQ(with_corners(more).points, more.points);
}

TEST(Design, RejectsEmptyScatteredDesigns) {
  const Factors box = {{"a", "", {0, 1}}};
  EXPECT_THROW((void)random_design(box, 0, 1), std::invalid_argument);
  EXPECT_THROW((void)latin_hypercube(box, 0, 1), std::invalid_argument);
  EXPECT_THROW((void)sobol(box, -1, 1), std::invalid_argument);
}

}  // namespace
}  // namespace wheeltap::emulator
