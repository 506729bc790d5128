// `wheeltap update` from the command line.

#include <gmock/gmock.h>

#include "apps/cases/syntax/case_file.hpp"
#include "program.hpp"

namespace wheeltap::apps {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class UpdateCommand : public testing::Test {
 protected:
  void SetUp() override {
    const Outcome made = wheeltap(where_, "init update -o " + folder_);
    ASSERT_EQ(made.exit_code, 0) << made.err;
  }
  [[nodiscard]] std::string starter() const { return folder_ + "/update.json"; }

  Workspace where_;
  std::string folder_ = (where_ / "new").string();
};

constexpr const char* kShortUpdate = " --quiet --draws 4000 --chains 2 --threads 2";

TEST_F(UpdateCommand, TheStarterTellsItsStiffnesses) {
  const std::string results = folder_ + "/results";
  const Outcome ran = wheeltap(where_, "update " + starter() + " -o " + results + kShortUpdate);
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("The parameters"));
  const json summary = json::parse(read_all(results + "/summary.json"));
  EXPECT_EQ(summary["wheeltap"]["command"], "update");
  EXPECT_EQ(summary["models"].size(), 1u);
  EXPECT_EQ(summary["models"][0]["probability"], 1.0);
  EXPECT_TRUE(summary["fit"]["ok"].get<bool>()) << summary["fit"];
  // The truth of the simulation.
  const auto truth = std::map<std::string, double>{{"k1", 41000}, {"k2", 36000}, {"k3", 27000}};
  for (const auto& [name, value] : truth) {
    const json& k = summary["parameters"]["the structure"][name];
    EXPECT_LT(std::abs(k["mean"].get<double>() - value), 4.0 * k["sd"].get<double>()) << name;
    EXPECT_GT(summary["contraction"][name]["contraction"].get<double>(), 0.9);
  }
  for (const json& mode : summary["data"]["modes"]) EXPECT_GT(mode["shape"]["mac"]["q50"], 0.98);
  for (const char* file : {"posterior.nc", "report.html", "summary.txt"})
    EXPECT_TRUE(std::filesystem::exists(results + "/" + file)) << file;
  EXPECT_THAT(read_all(results + "/report.html"), HasSubstr("The structure"));
  // The same run again, and its report again.
  EXPECT_EQ(wheeltap(where_, "report " + results).exit_code, 0);
  const Outcome again =
      wheeltap(where_, "update " + starter() + " -o " + results + kShortUpdate + " --resume");
  EXPECT_EQ(again.exit_code, 0) << again.err;
}

TEST_F(UpdateCommand, SimulatesACompleteCase) {
  json text = json::parse(read_all(starter()));
  text["truth"] = {{"parameters", {{"k1", 41000}, {"k2", 36000}, {"k3", 27000}}},
                   {"modes", 2},
                   {"cov", 0.003},
                   {"shape_sd", 0.02}};
  const auto truth = where_.write_json("truth.json", text);
  const std::string made = (where_ / "made.json").string();
  const Outcome ran = wheeltap(where_, "simulate " + truth.string() + " -o " + made);
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  const json written = json::parse(read_all(made));
  EXPECT_EQ(written["data"]["frequencies"].size(), 2u);
  EXPECT_EQ(written["data"]["shapes"].size(), 2u);
  EXPECT_FALSE(written.contains("truth"));
  EXPECT_EQ(wheeltap(where_, "update " + made + " --dry-run").exit_code, 0);
}

TEST_F(UpdateCommand, ModesAreThoseOfTheTruth) {
  json text = json::parse(read_all(starter()));
  text["truth"] = {{"parameters", {{"k1", 1000}, {"k2", 1000}, {"k3", 1000}}}};
  const auto file = where_.write_json("truth.json", text);
  const Outcome stiff = wheeltap(where_, "modes " + file.string() + " --json");
  const Outcome soft = wheeltap(where_, "modes " + file.string() + " --truth --json");
  ASSERT_EQ(soft.exit_code, 0) << soft.err;
  EXPECT_LT(json::parse(soft.out)["frequencies_hz"][0].get<double>(),
            0.3 * json::parse(stiff.out)["frequencies_hz"][0].get<double>());
}

// The answer begins with a spurious shape and names its mode.
TEST_F(UpdateCommand, AMisfitIsTheHeadline) {
  json text = json::parse(read_all(starter()));
  text["data"]["shapes"][2] = {1.0, 1.0, 1.0};
  const auto file = where_.write_json("bad.json", text);
  const std::string results = (where_ / "bad").string();
  const Outcome ran = wheeltap(where_, "update " + file.string() + " -o " + results + kShortUpdate);
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  const json summary = json::parse(read_all(results + "/summary.json"));
  EXPECT_FALSE(summary["fit"]["ok"].get<bool>());
  EXPECT_TRUE(summary["answer"]["misfit"].get<bool>());
  EXPECT_THAT(summary["answer"]["headline"].get<std::string>(),
              HasSubstr("does not explain the measured modes"));
  EXPECT_THAT(summary["fit"]["why"][0].get<std::string>(), HasSubstr("mode 3"));
}

TEST_F(UpdateCommand, ItsSchemaIsTheCases) {
  const Outcome ran = wheeltap(where_, "schema update");
  ASSERT_EQ(ran.exit_code, 0);
  EXPECT_TRUE(json::parse(ran.out)["definitions"].contains("sensor"));
}

TEST_F(UpdateCommand, WithoutAnOutputItIsMisused) {
  EXPECT_EQ(wheeltap(where_, "update " + starter()).exit_code, 64);
}

}  // namespace
}  // namespace wheeltap::apps
