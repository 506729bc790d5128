// Reductions over an unknown length.
#include <gmock/gmock.h>

#include "apps/cases/damage_case.hpp"
#include "identification/structural/damage/damage_problem.hpp"
#include "program.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

using nlohmann::json;
using testing::HasSubstr;

std::unique_ptr<const DamageProblem> extent_problem(const json& c) {
  const Workspace where;
  const DamageCaseFile parsed = parse_damage_case(read_case(where.write_json("c.json", c)));
  return explained(parsed, [&] { return make_damage_problem(parsed.damage, {}); });
}

json with_extent(const json& extent) {
  json c = small_case();
  c["damage"]["extent"] = extent;
  return c;
}

TEST(Extent, IsAThirdParameterOfEachDamage) {
  const auto unknown = extent_problem(with_extent(json::parse(R"({"uniform": [0.0, 0.5]})")));
  const auto& space = unknown->problem.space;
  EXPECT_EQ(space[1].dimension, 3);
  EXPECT_EQ(space[2].dimension, 6);
  EXPECT_EQ(space.parameter_name(2, 5), "extent[2]");
  const auto components =
      unknown->components(2, std::vector<double>{0.2, 0.3, 0.11, 0.7, 0.4, 0.22});
  ASSERT_EQ(components.size(), 2U);
  EXPECT_EQ(components[1].severity, 0.4);
  EXPECT_EQ(components[1].extent, 0.22);
}

TEST(Extent, PredictsAsOneThatIsKnown) {
  const auto unknown = extent_problem(with_extent(json::parse(R"({"uniform": [0.0, 0.5]})")));
  StructuralPredictor by_prior(*unknown);
  std::vector<double> f(3), expected(3), narrow(3);
  for (const double extent : {0.03, 0.2, 0.37}) {
    const auto known = extent_problem(with_extent(extent));
    StructuralPredictor by_number(*known);
    by_prior.solve(1, std::vector<double>{0.42, 0.3, extent}, f);
    by_number.solve(1, std::vector<double>{0.42, 0.3}, expected);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_DOUBLE_EQ(f[i], expected[i]) << extent;
  }
  // A reduction of twice the length has more effect, for any mesh.
  by_prior.solve(1, std::vector<double>{0.42, 0.3, 0.01}, narrow);
  EXPECT_GT(narrow[0], f[0]);
}

TEST(Extent, OfATruthIsSimulated) {
  json c = with_extent(json::parse(R"({"uniform": [0.0, 0.5]})"));
  c["data"] = {{"cov", 1e-9}, {"modes", 3}};
  c["damage"]["truth"] = {{{"location", 0.42}, {"reduction", 0.3}, {"extent", 0.2}}};
  const auto p = extent_problem(c);
  StructuralPredictor predictor(*p);
  std::vector<double> f(3);
  predictor.solve(1, std::vector<double>{0.42, 0.3, 0.2}, f);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(p->damage_case.data.frequencies_hz[i] / f[i], 1.0, 1e-7);
}

TEST(Extent, WhatCannotBeIsRefused) {
  const Workspace where;
  const auto refused = [&](const json& c) {
    const Outcome outcome =
        wheeltap(where, "damage " + where.write_json("c.json", c).string() + " --dry-run");
    EXPECT_EQ(outcome.exit_code, 65) << outcome.err;
    return outcome.err;
  };
  EXPECT_THAT(refused(with_extent(json::parse(R"({"uniform": [0.1, 1.5]})"))),
              HasSubstr("/damage/extent"));
  EXPECT_THAT(refused(with_extent(json::parse(R"({"uniform": [-0.1, 0.5]})"))),
              HasSubstr("/damage/extent"));
  EXPECT_THAT(refused(with_extent(1.5)), HasSubstr("/damage/extent: 1.5: an extent lies in [0, 1"));
  json c = with_extent(json::parse(R"({"uniform": [0.0, 0.5]})"));
  c["data"] = {{"cov", 0.01}, {"modes", 3}};
  c["damage"]["truth"] = {{{"location", 0.42}, {"reduction", 0.3}, {"extent", 1.5}}};
  EXPECT_THAT(refused(c), HasSubstr("/damage/truth/0/extent: 1.5: must be at most 1"));
  c["damage"]["truth"] = {{{"location", 0.42}, {"reduction", 0.3}}};
  EXPECT_THAT(refused(c), HasSubstr("/damage/truth/0/extent: is missing"));
  c["damage"]["truth"][0]["extent"] = 0.2;
  c["damage"]["extent"] = 0.2;
  EXPECT_THAT(refused(c), HasSubstr("is not an unknown of this kind of defect"));
}

}  // namespace
}  // namespace wheeltap::apps
