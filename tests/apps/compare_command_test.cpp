// wheeltap compare on the command line.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "program.hpp"

namespace wheeltap::apps {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// Two equal masses on springs: k unknown, ratio of upper to lower spring known.
json two_storeys(double ratio) {
  json links = {
      {{"name", "1"}, {"between", {0, 1}}, {"stiffness", "k"}},
      {{"name", "2"}, {"between", {1, 2}}, {"stiffness", ratio == 1.0 ? json("k") : json(4000.0)}}};
  return {{"kind", "update"},
          {"structure", {{"chain", {{"masses", {1.0, 1.0}}, {"links", links}}}}},
          {"parameters", {{"k", {{"uniform", {1000.0, 9000.0}}}}}},
          {"data", {{"frequencies", {6.2, 16.4}}, {"cov", 0.02}}}};
}

/// ln Z by a sum over k.
double exact(bool same) {
  double z = 0.0;
  constexpr int kSteps = 20000;
  for (int i = 0; i < kSteps; ++i) {
    const double k = 1000.0 + 8000.0 * (i + 0.5) / kSteps, k2 = same ? k : 4000.0;
    // K = [k + k2, -k2; -k2, k2], M = 1
    const double half = 0.5 * (k + 2.0 * k2), root = std::sqrt(half * half - k * k2);
    const double f[] = {std::sqrt(half - root) / (2.0 * std::numbers::pi),
                        std::sqrt(half + root) / (2.0 * std::numbers::pi)};
    const double measured[] = {6.2, 16.4};
    double log_p = 0.0;
    for (int m = 0; m < 2; ++m) {
      const double sd = 0.02 * measured[m];
      log_p -= 0.5 * std::pow((measured[m] - f[m]) / sd, 2.0) +
               std::log(sd * std::sqrt(2.0 * std::numbers::pi));
    }
    z += std::exp(log_p) / kSteps;
  }
  return std::log(z);
}

class Compare : public testing::Test {
 protected:
  void run(const json& one, const std::string& name) const {
    const Outcome ran =
        wheeltap(where, "update " + where.write_json(name + ".json", one).string() + " -o " +
                            (where / name).string() + " --quiet --draws 2000");
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
  }
  [[nodiscard]] Outcome compare(const std::string& options) const {
    return wheeltap(where, "compare " + (where / "same").string() + " " +
                               (where / "other").string() + " " + options);
  }
  Workspace where;
};

TEST_F(Compare, ProbabilitiesAreThoseOfTheEvidences) {
  run(two_storeys(1.0), "same");
  run(two_storeys(2.0), "other");
  const double same = exact(true), other = exact(false);
  const Outcome ran = compare("--json --prior 3,1");
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  const json runs = json::parse(ran.out)["runs"];
  ASSERT_EQ(runs.size(), 2U);
  const double expected = 3.0 * std::exp(same) / (3.0 * std::exp(same) + std::exp(other));
  ASSERT_GT(expected, 0.02);
  ASSERT_LT(expected, 0.98);
  EXPECT_NEAR(runs[0]["log_evidence"].get<double>(), same,
              4.0 * runs[0]["log_evidence_se"].get<double>());
  EXPECT_NEAR(runs[1]["log_evidence"].get<double>(), other,
              4.0 * runs[1]["log_evidence_se"].get<double>());
  EXPECT_NEAR(runs[0]["probability"].get<double>(), expected, 4.0 * runs[0]["mcse"].get<double>());
  EXPECT_LT(runs[0]["mcse"].get<double>(), 0.02);
  EXPECT_DOUBLE_EQ(runs[0]["prior"].get<double>(), 0.75);

  const Outcome told = compare("");
  EXPECT_THAT(told.out, HasSubstr("Most probable: "));
  EXPECT_THAT(told.out, HasSubstr("ln Bayes factor of "));
}

TEST_F(Compare, FoldersMayHaveNamesThatAreNoText) {
  run(two_storeys(1.0), "same");
  run(two_storeys(2.0), "other\xff");
  const Outcome ran = wheeltap(
      where, "compare --json " + (where / "same").string() + " " + (where / "other\xff").string());
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_THAT(json::parse(ran.out)["runs"][1]["run"].get<std::string>(), HasSubstr("other\\xff"));
}

TEST_F(Compare, SummariesOfAnotherShapeAreRefused) {
  run(two_storeys(1.0), "same");
  std::filesystem::copy(where / "same", where / "other");
  const json whole = json::parse(read_all(where / "same" / "summary.json"));
  for (const char* place : {"/title", "/wheeltap/command", "/wheeltap/case", "/models",
                            "/models/0/prior", "/models/0/probability", "/diagnostics/converged"}) {
    json changed = whole;
    changed[json::json_pointer(place)] = {{"of", "another shape"}};
    std::ofstream(where / "other" / "summary.json") << changed;
    const Outcome outcome = compare("");
    EXPECT_EQ(outcome.exit_code, 65) << place << ": " << outcome.err;
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
  }
}

TEST_F(Compare, OfOtherDataIsRefused) {
  run(two_storeys(1.0), "same");
  json moved = two_storeys(2.0);
  moved["data"]["frequencies"][1] = 16.5;
  run(moved, "other");
  const Outcome ran = compare("");
  EXPECT_EQ(ran.exit_code, 65);
  EXPECT_THAT(ran.err, HasSubstr("does not use the data of"));
  EXPECT_EQ(compare("--prior 1,2,3").exit_code, 64);
  EXPECT_EQ(wheeltap(where, "compare " + (where / "same").string()).exit_code, 64);
  EXPECT_EQ(
      wheeltap(where, "compare " + (where / "same").string() + " " + (where / "nowhere").string())
          .exit_code,
      66);
}

TEST_F(Compare, DataAreToldByTheirContentAndNotByTheNamesOfFiles) {
  const auto with_file = [&](double ratio, const std::string& file, double second) {
    std::filesystem::create_directories(where / (file + ".d"));
    std::ofstream(where / (file + ".d") / file) << "frequency [Hz],sd [Hz]\n6.2,0.124\n"
                                                << second << ",0.33\n";
    json one = two_storeys(ratio);
    one["data"] = {{"file", file + ".d/" + file}};
    return one;
  };
  run(with_file(1.0, "a.csv", 16.4), "same");
  run(with_file(2.0, "b.csv", 16.4), "other");
  EXPECT_EQ(compare("").exit_code, 0);
  run(with_file(2.0, "a.csv", 16.5), "other");  // the same name, another content
  const Outcome ran = compare("");
  EXPECT_EQ(ran.exit_code, 65);
  EXPECT_THAT(ran.err, HasSubstr("does not use the data of"));
}

TEST_F(Compare, OnlyTheRatiosOfPriorWeightsCount) {
  run(two_storeys(1.0), "same");
  run(two_storeys(2.0), "other");
  const Outcome small = compare("--prior 1,1"), large = compare("--prior 1e308,1e308");
  EXPECT_EQ(large.exit_code, 0) << large.err;
  EXPECT_EQ(small.out, large.out);
}

TEST_F(Compare, DataThatEachCaseSimulatedAreNone) {
  for (const char* name : {"same", "other"}) {
    json one = two_storeys(1.0);
    one["data"] = {{"cov", 0.02}};
    one["truth"] = {{"parameters", {{"k", 4000.0}}}, {"modes", 2}, {"cov", 0.02}};
    run(one, name);
  }
  const Outcome ran = compare("");
  EXPECT_EQ(ran.exit_code, 65);
  EXPECT_THAT(ran.err, HasSubstr("simulated from its case"));
}

}  // namespace
}  // namespace wheeltap::apps
