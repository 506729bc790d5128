// "repeats" in update and damage cases: parsing, error messages, and the summary of a run.
#include "apps/cases/records/repeats_case.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "apps/cases/damage_case.hpp"
#include "apps/cases/records/csv_frequencies.hpp"
#include "apps/cases/update_case.hpp"
#include "program.hpp"

namespace wheeltap::apps {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

json two_masses(const json& repeats) {
  json out = json::parse(R"({
    "kind": "update",
    "structure": {"chain": {"masses": [2.0, 1.0], "links": [
      {"between": [0, 1], "stiffness": "k1"}, {"between": [1, 2], "stiffness": "k2"}]}},
    "parameters": {"k1": {"log_normal": [7.2, 0.3]}, "k2": {"log_normal": [6.8, 0.3]}},
    "data": {}})");
  out["data"]["repeats"] = repeats;
  return out;
}

/// `count` tests of two modes with alternating deviations of about 0.3 %.
json tests_of_two_modes(int count) {
  json out = json::array();
  for (int t = 0; t < count; ++t) {
    const double a = std::sin(2.399 * (t + 1.0)), b = std::cos(5.1 * (t + 1.0));
    out.push_back({2.8 * std::exp(0.003 * a), 6.7 * std::exp(0.003 * b)});
  }
  return out;
}

identification::UpdateCase update_with_repeats(const json& text) {
  return parse_update_case({.path = "case.json", .json = Json::parse(text.dump())}).update;
}

void expect_repeats_refused(const json& text, const std::string& place, const std::string& words) {
  try {
    static_cast<void>(update_with_repeats(text));
    FAIL() << "not refused: " << place;
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.exit(), Exit::bad_input);
    EXPECT_THAT(failure.what(), HasSubstr("case.json: " + place + ":"));
    EXPECT_THAT(failure.what(), HasSubstr(words));
    EXPECT_THAT(failure.what(), Not(HasSubstr("\n")));
  }
}

TEST(RepeatsCase, GiveFrequenciesAndTheirCovariance) {
  const auto data = update_with_repeats(two_masses(tests_of_two_modes(30))).data;
  ASSERT_EQ(data.modes(), 2);
  EXPECT_NEAR(data.frequencies_hz[0], 2.8, 0.005);
  EXPECT_NEAR(data.frequencies_hz[1], 6.7, 0.01);
  ASSERT_TRUE(data.repeats);
  EXPECT_EQ(data.covariance, data.repeats->covariance_hz2);
  EXPECT_GT(data.covariance(0, 0), 0.0);
  EXPECT_THAT(data.origin, HasSubstr("30 repeated tests given in the case; scatter between tests"));
}

// More tests reduce the error of the mean, and leave errors common to all tests as they are.
TEST(RepeatsCase, DiscrepancyIsCommonToAllTests) {
  json few = two_masses(tests_of_two_modes(40)), many = two_masses(tests_of_two_modes(160));
  few["data"]["discrepancy"] = many["data"]["discrepancy"] = {{"cov", 0.01}};
  const auto a = update_with_repeats(few).data, b = update_with_repeats(many).data;
  EXPECT_NEAR(std::sqrt(b.covariance(0, 0) / a.covariance(0, 0)), 0.5, 0.06);
  EXPECT_EQ(a.discrepancy.value, 0.01);
  EXPECT_EQ(b.discrepancy.value, 0.01);
}

TEST(RepeatsCase, AreReadFromAFile) {
  const Workspace where;
  where.write(
      "repeats.csv",
      "test,f1 [Hz],air [degC],f2 [kHz]\n1,2.80,20,0.00671\n2,2.81,21,nan\n3,2.79,20,0.00669\n"
      "4,2.80,20,0.00670\n5,,20,0.00672\n6,2.82,20,0.00668\n");
  const json text = two_masses({{"file", "repeats.csv"}});
  const auto read = [&](const json& one) {
    return parse_update_case(read_case(where.write_json("case.json", one))).update.data;
  };
  const auto data = read(text);
  ASSERT_TRUE(data.repeats);
  EXPECT_EQ(data.repeats->tests, 6);
  EXPECT_THAT(data.repeats->identified, ElementsAre(5, 5));
  EXPECT_NEAR(data.frequencies_hz[1], 6.70, 0.02) << "kHz are converted";
  EXPECT_THAT(data.origin, HasSubstr("6 repeated tests from repeats.csv"));
  json chosen = text;
  chosen["data"]["repeats"]["columns"] = {"f1", 4};
  EXPECT_EQ(read(chosen).frequencies_hz, data.frequencies_hz);
}

TEST(RepeatsCase, RowsOfUnequalLengthAreErrors) {
  const auto complaint = [](const std::string& text) -> std::string {
    try {
      static_cast<void>(parse_repeats_csv(text, "r.csv", {}));
    } catch (const Failure& failure) {
      return failure.what();
    }
    return "";
  };
  EXPECT_EQ(complaint("f1,f2\n1,2\n,3\n"), "");
  EXPECT_THAT(complaint("f1,f2\n1,2\n3\n"), HasSubstr("r.csv:3: has 1 cells, the header has 2"));
  EXPECT_THAT(complaint("f1,f2\n1,2\n3,4,5\n"), HasSubstr("r.csv:3: has 3 cells"));
  EXPECT_THAT(complaint("f1,f2\n1,2\n3,-4\n"),
              HasSubstr("r.csv:3:2: \"-4\": must be a number > 0"));
  json text = two_masses(tests_of_two_modes(6));
  text["data"]["repeats"][3].push_back(9.0);
  expect_repeats_refused(text, "/data/repeats/3", "has 3 frequencies, the first test 2");
}

TEST(RepeatsCase, OtherUncertaintiesAreRefused) {
  const auto with = [](const char* key, const json& value) {
    json text = two_masses(tests_of_two_modes(6));
    text["data"][key] = value;
    return text;
  };
  expect_repeats_refused(with("cov", 0.01), "/data/cov", "state errors common to all tests");
  expect_repeats_refused(with("sd", {0.1, 0.1}), "/data/sd", "\"discrepancy\"");
  expect_repeats_refused(with("covariance", {{1.0, 0.0}, {0.0, 1.0}}), "/data/covariance",
                         "the scatter is inferred");
  expect_repeats_refused(with("frequencies", {2.8, 6.7}), "/data/frequencies", "leave out one");
  expect_repeats_refused(with("file", "f.csv"), "/data/file", "leave out one");
}

TEST(RepeatsCase, TestsThatCannotBeUsedAreErrors) {
  expect_repeats_refused(two_masses(tests_of_two_modes(3)), "/data/repeats",
                         "mode 1 was identified in 3 tests");
  json text = two_masses(tests_of_two_modes(6));
  for (json& test : text["data"]["repeats"]) std::swap(test[0], test[1]);
  expect_repeats_refused(text, "/data/repeats", "the mean frequencies must increase");
  for (json& test : text["data"]["repeats"]) test = {2.8, 6.7};
  expect_repeats_refused(text, "/data/repeats", "the same frequency in all tests");
  text["data"]["repeats"][2] = {0.0, 6.7};
  EXPECT_THROW(static_cast<void>(update_with_repeats(text)), Failure);
}

// Repeated tests of a beam: covariance, emulators, and a mode that no test identified.
TEST(RepeatsCase, DamageCasesUseTheCovariance) {
  json text = small_case();
  text["data"] = {{"repeats", json::array()}};
  for (int t = 0; t < 12; ++t) {
    const double a = 0.01 * std::sin(2.399 * (t + 1.0)), b = 0.01 * std::cos(5.1 * (t + 1.0));
    text["data"]["repeats"].push_back({13.8 * (1.0 + a), nullptr, 124.0 * (1.0 + b)});
  }
  const auto read = [](const json& one) {
    return parse_damage_case({.path = "case.json", .json = Json::parse(one.dump())}).damage;
  };
  const auto damage = read(text);
  ASSERT_TRUE(damage.modal() != nullptr && damage.modal()->repeats);
  EXPECT_NEAR(damage.data.frequencies_hz[0], 13.8, 0.2);
  EXPECT_TRUE(std::isnan(damage.data.frequencies_hz[1]));
  EXPECT_NEAR(damage.data.sd_hz[2], 124.0 * 0.01 / std::sqrt(2.0 * 12.0), 0.2);
  text["predictor"] = {{"sites", {2, 5, 8}}, {"multipliers", {0.4, 0.7, 1.0}}};
  try {
    static_cast<void>(read(text));
    FAIL() << "an emulator was not refused";
  } catch (const Failure& failure) {
    EXPECT_THAT(failure.what(), HasSubstr("/predictor"));
    EXPECT_THAT(failure.what(), HasSubstr("\"repeats\""));
  }
}

TEST(RepeatsCase, TheSummaryStatesTheScatter) {
  const Workspace where;
  const std::string update =
      where.write_json("u.json", two_masses(tests_of_two_modes(20))).string();
  const Outcome updated = wheeltap(where, "update " + update + " -o " + (where / "u").string() +
                                              " --quiet --chains 2 --draws 2000 --threads 1");
  ASSERT_EQ(updated.exit_code, 0) << updated.err;
  EXPECT_THAT(updated.out, HasSubstr("20 repeated tests"));
  const json of_update = json::parse(read_all(where / "u/summary.json"))["repeats"];
  EXPECT_EQ(of_update["tests"], 20);
  ASSERT_EQ(of_update["scatter"].size(), 2u);
  EXPECT_NEAR(of_update["scatter"][0].get<double>(), 0.0021, 0.001);
  for (const char* key : {"identified", "mean_hz", "mean_sd_hz", "scatter_sd", "degrees_of_freedom",
                          "outliers", "independent_tests"})
    EXPECT_TRUE(of_update.contains(key)) << key;

  json beam = small_case();
  beam["damage"]["count"]["max"] = 1;
  beam["data"] = {{"repeats", json::array()}};
  for (int t = 0; t < 12; ++t) {
    const double a = 0.01 * std::sin(2.399 * (t + 1.0)), b = 0.01 * std::cos(5.1 * (t + 1.0));
    beam["data"]["repeats"].push_back({13.8 * (1.0 + a), 55.3 * (1.0 + b)});
  }
  const Outcome damaged =
      wheeltap(where, "damage " + where.write_json("d.json", beam).string() + " -o " +
                          (where / "d").string() + " --quiet --chains 2 --draws 2000 --threads 1");
  ASSERT_EQ(damaged.exit_code, 0) << damaged.err;
  const json of_damage = json::parse(read_all(where / "d/summary.json"))["repeats"];
  EXPECT_EQ(of_damage["tests"], 12);
  EXPECT_EQ(of_damage["scatter"].size(), 2u);
}

// Each state has its own repeated tests; a state inherits no uncertainty of the block.
TEST(RepeatsCase, StatesHaveTheirOwnTests) {
  json text = two_masses(tests_of_two_modes(20));
  const json first = text["data"]["repeats"];
  text["data"] = {{"cov", 0.01},
                  {"states",
                   {{{"repeats", first}},
                    {{"frequencies", {2.7, 6.5}}, {"masses", {{{"node", "1"}, {"mass", 0.1}}}}}}}};
  const auto update = update_with_repeats(text);
  ASSERT_TRUE(update.states);
  EXPECT_TRUE(update.states->list[0].data.repeats);
  EXPECT_FALSE(update.states->list[1].data.repeats);
  EXPECT_NEAR(update.states->list[1].data.covariance(0, 0), 0.027 * 0.027, 1e-12);
}

// The keys "columns" and "row" of the block select from its file, which a state with repeated tests
// does not use.
TEST(RepeatsCase, StatesWithTestsIgnoreTheSelectionFromAFile) {
  const Workspace where;
  where.write("runs.csv", "run,f1 [Hz],f2 [Hz]\n1,2.71,6.49\n2,2.72,6.51\n");
  json text = two_masses(tests_of_two_modes(20));
  const json first = text["data"]["repeats"];
  text["data"] = {
      {"file", "runs.csv"},
      {"columns", {"f1 [Hz]", "f2 [Hz]"}},
      {"row", 2},
      {"cov", 0.01},
      {"states", {{{"repeats", first}}, {{"masses", {{{"node", "1"}, {"mass", 0.1}}}}}}}};
  const auto update = parse_update_case(read_case(where.write_json("case.json", text))).update;
  ASSERT_TRUE(update.states);
  EXPECT_TRUE(update.states->list[0].data.repeats);
  EXPECT_EQ(update.states->list[1].data.frequencies_hz[0], 2.72);
}

}  // namespace
}  // namespace wheeltap::apps
