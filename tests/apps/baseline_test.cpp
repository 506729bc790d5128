// Damage from changes relative to a measurement of the undamaged structure.
#include <gmock/gmock.h>

#include <cmath>

#include "apps/cases/damage_case.hpp"
#include "identification/structural/damage/damage_problem.hpp"
#include "program.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

using nlohmann::json;
using testing::HasSubstr;

DamageCase read_back(const json& c) {
  const Workspace where;
  return parse_damage_case(read_case(where.write_json("c.json", c))).damage;
}

/// Frequencies of a beam that is stiffer than the model by `stiffer`: healthy, and with a damage.
json measured(double stiffer) {
  json c = small_case();
  const fem::Beam beam = read_back(c).beam;
  std::vector<double> healthy = elastic_frequencies(beam, {}, 4);
  std::vector<double> damaged = elastic_frequencies(beam, {.damages = {{0.33, 0.4}}}, 4);
  for (auto* list : {&healthy, &damaged})
    for (double& f : *list) f *= std::sqrt(stiffer);
  c["data"] = {{"frequencies", damaged}, {"cov", 0.003}};
  c["baseline"] = {{"data", {{"frequencies", healthy}, {"cov", 0.004}}}};
  return c;
}

// A factor of each mode cancels: the data equal those of the damaged beam of the model.
TEST(Baseline, WhatTheModelDoesWrongByAFactorCancels) {
  const DamageCase damage_case = read_back(measured(1.08));
  const auto expected = elastic_frequencies(damage_case.beam, {.damages = {{0.33, 0.4}}}, 4);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(damage_case.data.frequencies_hz[i], expected[i], 1e-9 * expected[i]);
    EXPECT_NEAR(damage_case.data.sd_hz[i], 0.005 * expected[i], 1e-9 * expected[i])
        << "both scatters count";
    EXPECT_NEAR(damage_case.baseline->measured_hz[i] / damage_case.baseline->model_hz[i],
                std::sqrt(1.08), 1e-9);
  }
}

TEST(Baseline, ModesThatItLacksAreLeftOut) {
  json c = measured(1.0);
  c["baseline"]["data"]["frequencies"][1] = nullptr;
  const DamageCase damage_case = read_back(c);
  EXPECT_EQ(damage_case.data.measured(), 3);
  EXPECT_TRUE(std::isnan(damage_case.data.frequencies_hz[1]));
}

// Without a baseline, a model that is 4 % too soft finds no damage and does not fit.
TEST(Baseline, FindsWhatTheModelAloneMisses) {
  const Workspace where;
  const auto run = [&](const json& c) {
    const Outcome ran =
        wheeltap(where, "damage " + where.write_json("c.json", c).string() + " -o " +
                            (where / "out").string() + " --quiet --warmup 500 --draws 500");
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    return json::parse(read_all(where / "out/summary.json"));
  };
  json c = measured(1.04);
  c["data"]["cov"] = 0.001;
  c["baseline"]["data"]["cov"] = 0.001;
  const json with = run(c);
  EXPECT_LT(with["models"][0]["probability"].get<double>(), 0.01);
  EXPECT_GT(with["data"]["posterior_predictive_p"].get<double>(), 0.01);
  EXPECT_THAT(with["baseline"]["statement"].get<std::string>(), HasSubstr("2 to 2 %"));
  c.erase("baseline");
  const json without = run(c);
  EXPECT_LT(without["data"]["posterior_predictive_p"].get<double>(), 0.01);
}

TEST(Baseline, Refusals) {
  const Workspace where;
  const auto refused = [&](const json& c, const std::string& words) {
    const Outcome outcome =
        wheeltap(where, "damage " + where.write_json("c.json", c).string() + " --dry-run");
    EXPECT_EQ(outcome.exit_code, 65) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(words));
  };
  json c = measured(1.0);
  c["baseline"]["data"]["frequencies"] = {13.8, 55.3};
  refused(c, "/baseline/data: the baseline has 2 modes");
  c = measured(1e6);
  refused(c, "check units");
  c = measured(1.0);
  c["baseline"]["data"].erase("cov");
  refused(c, "/baseline/data/cov: is missing");
  c["baseline"]["data"]["cov"] = {{"log_uniform", {1e-4, 1e-2}}};
  refused(c, "/baseline/data/cov");
  c = measured(1.0);
  c["data"] = {{"cov", 0.003}, {"modes", 4}};
  c["damage"]["truth"] = {{{"location", 0.33}, {"reduction", 0.4}}};
  refused(c, "/baseline: ");
  c = measured(1.0);
  c["baseline"]["data"]["modes"] = 3;
  refused(c, "/baseline/data/modes");
}

}  // namespace
}  // namespace wheeltap::apps
