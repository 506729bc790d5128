#include "fem/sections/outline.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "refusal.hpp"
#include "sections.hpp"

namespace wheeltap::fem {
namespace {

const Ring kSquare = rectangle(0, 0, 1, 1);

TEST(Outline, RingsAreOrientedAndClosed) {
  const Ring clockwise = {{0, 0}, {0, 1}, {1, 1}, {1, 0}, {0, 0}};
  const Outline outline = checked(of_one(clockwise, 0.3, {rectangle(0.2, 0.2, 0.4, 0.4)}));
  const Region& region = outline.regions[0];
  EXPECT_EQ(region.outer.size(), 4u);
  EXPECT_DOUBLE_EQ(signed_area(region.outer), 1.0);
  EXPECT_NEAR(signed_area(region.holes[0]), -0.04, 1e-16);
}

TEST(Outline, MergesCornersWithinABillionthOfTheSize) {
  for (const double gap : {0.0, 6e-18, 1e-15, 1e-12, 1.9e-10}) {
    const Ring repeated = {{0, 0}, {0.1, 0}, {0.1, 0.2}, {gap, 0.2}, {0, 0.2}, {0, gap}};
    EXPECT_EQ(checked(of_one(repeated, 0.3)).regions[0].outer.size(), 4u) << gap;
  }
  const Ring chamfered = {{0, 0}, {0.1, 0}, {0.1, 0.2}, {1e-9, 0.2}, {0, 0.2}};
  EXPECT_EQ(checked(of_one(chamfered, 0.3)).regions[0].outer.size(), 5u);
}

TEST(Outline, FindsPointsInside) {
  const Ring c = channel(8, 18, 1);
  EXPECT_TRUE(contains(c, {0.5, 9}));
  EXPECT_TRUE(contains(c, {5, 0.5}));
  EXPECT_FALSE(contains(c, {5, 9}));
  EXPECT_FALSE(contains(c, {-1, 9}));
}

TEST(Outline, ArcsPreserveTheirArea) {
  // Half a disc, and the lens between chord and arc of a quarter.
  for (const double turn : {std::numbers::pi, std::numbers::pi / 2, 1.5 * std::numbers::pi, 0.1}) {
    const double r = 0.5 * std::sqrt(2.0) / std::sin(0.5 * turn);  // for the chord (0,0)-(1,1)
    for (const double sign : {1.0, -1.0}) {
      Ring ring = arc({0, 0}, {1, 1}, sign * turn, 16);
      ring.emplace_back(1, 1);
      EXPECT_NEAR(signed_area(ring), sign * 0.5 * r * r * (turn - std::sin(turn)), 1e-13) << turn;
    }
  }
  EXPECT_NEAR(signed_area(circle({3, -2}, 2.0, 12)), 4.0 * std::numbers::pi, 1e-12);
  expect_refusal([] { (void)arc({0, 0}, {1, 0}, 0.0); }, {"turn", "0"});
}

TEST(Outline, NestedRingsBecomeHolesAndRegions) {
  const auto square = [](double half) { return rectangle(-half, -half, half, half); };
  const auto regions =
      nested({square(2), square(4), square(1), square(3), rectangle(9, 9, 10, 10)});
  ASSERT_EQ(regions.size(), 3u);
  EXPECT_EQ(regions[0].outer, square(2));
  EXPECT_EQ(regions[0].holes, std::vector<Ring>{square(1)});
  EXPECT_EQ(regions[1].outer, square(4));
  EXPECT_EQ(regions[1].holes, std::vector<Ring>{square(3)});
  EXPECT_TRUE(regions[2].holes.empty());
}

TEST(Outline, RejectsInvalidRings) {
  const auto refused = [](const Ring& outer, std::initializer_list<std::string> words) {
    expect_refusal([&] { (void)checked(of_one(outer, 0.3)); }, words);
  };
  refused({{0, 0}, {1, 0}, {0, 0}}, {"regions[0].outer", "2 different corners", "at least 3"});
  refused({{0, 0}, {1, 1}, {2, 2}}, {"regions[0].outer", "area"});
  refused({{0, 0}, {1, 0}, {1, std::numeric_limits<double>::quiet_NaN()}},
          {"regions[0].outer[2]", "nan", "finite"});
  // A bow tie, a pinched ring, and a spike.
  refused({{0, 0}, {2, 2}, {2, 0}, {0, 2}}, {"crosses or touches itself", "(0, 0)", "(2, 2)"});
  refused({{0, 0}, {2, 0}, {1, 1}, {2, 2}, {0, 2}, {1, 1}}, {"touches itself", "(1, 1)"});
  refused({{0, 0}, {2, 0}, {2, 3}, {2, 2}, {0, 2}}, {"back", "(2, 3)"});
}

TEST(Outline, RejectsHolesThatDoNotFit) {
  const auto refused = [](const std::vector<Ring>& holes,
                          std::initializer_list<std::string> words) {
    expect_refusal([&] { (void)checked(of_one(kSquare, 0.3, holes)); }, words);
  };
  refused({rectangle(2, 2, 3, 3)}, {"regions[0].holes[0]", "outside", "(2, 3)"});
  refused({rectangle(0.5, 0.5, 1.5, 0.6)}, {"holes[0]", "inside the outer polygon"});
  refused({rectangle(0.5, 0.5, 1.0, 0.6)}, {"holes[0]", "inside the outer polygon"});
  refused({rectangle(0.1, 0.1, 0.5, 0.5), rectangle(0.4, 0.4, 0.8, 0.8)},
          {"holes[1]", "another", "holes[0]"});
  refused({rectangle(0.1, 0.1, 0.9, 0.9), rectangle(0.4, 0.4, 0.6, 0.6)},
          {"holes[1]", "inside regions[0].holes[0]", "(0.4, 0.6)"});
}

TEST(Outline, ErrorsCarryTheirPlace) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  try {
    (void)checked(
        {{{.outer = kSquare},
          {.outer = rectangle(2, 0, 3, 1), .holes = {{{2.1, 0.1}, {2.2, nan}, {2.2, 0.2}}}}}});
    FAIL();
  } catch (const OutlineError& error) {
    EXPECT_EQ(error.place.region, 1U);
    EXPECT_EQ(error.place.part, OutlinePlace::Part::hole);
    EXPECT_EQ(error.place.hole, 0U);
    EXPECT_EQ(error.place.corner, 1U);
    EXPECT_EQ(std::string(error.what()), "regions[1].holes[0][1]: " + error.reason);
  }
}

TEST(Outline, RefusesRegionsThatOverlap) {
  const auto refused = [](const Ring& other, std::initializer_list<std::string> words) {
    expect_refusal([&] { (void)checked({{{.outer = kSquare}, {.outer = other}}}); }, words);
  };
  refused(rectangle(0.5, -0.5, 1.5, 0.5), {"regions[1]", "overlaps regions[0]"});
  refused(rectangle(0.2, 0.2, 0.8, 0.8), {"regions[1]", "overlaps regions[0]", "in both"});
  refused(kSquare, {"overlaps", "in both"});
  refused(rectangle(0.5, 0, 1.5, 1), {"overlaps"});
  // Regions side by side, in a hole, or along part of an edge do not overlap.
  EXPECT_NO_THROW((void)checked({{{.outer = kSquare}, {.outer = rectangle(1, 0.2, 2, 3)}}}));
  EXPECT_NO_THROW((void)checked({{{.outer = kSquare, .holes = {rectangle(0.2, 0.2, 0.8, 0.8)}},
                                  {.outer = rectangle(0.2, 0.2, 0.8, 0.8)}}}));
}

TEST(Outline, RejectsInvalidMaterials) {
  expect_refusal([] { (void)checked({{{.outer = kSquare, .modulus = 0.0}}}); },
                 {"regions[0].modulus", "0", "positive"});
  expect_refusal([] { (void)checked({{{.outer = kSquare, .poisson = 0.6}}}); },
                 {"regions[0].poisson", "0.6", "0.5"});
  expect_refusal([] { (void)checked({{{.outer = kSquare, .density = -1.0}}}); },
                 {"regions[0].density", "-1"});
  expect_refusal([] { (void)checked({}); }, {"regions", "none"});
}

}  // namespace
}  // namespace wheeltap::fem
