// `wheeltap report`: draws a finished run again, and ends with the contract's codes where it
// cannot.
#include <gmock/gmock.h>

#include "program.hpp"

namespace wheeltap::apps {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class ReportCommand : public testing::Test {
 protected:
  ReportCommand() {
    const std::string small = where_.write_json("c.json", small_case()).string();
    run_ = where_ / "run";
    const Outcome ran = wheeltap(where_, "damage " + small + " -o " + run_.string() +
                                             " --quiet --chains 2 --warmup 2000 --draws 500");
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    drawn_ = read_all(run_ / "report.html");
  }
  // The report of the run as the test left it: refused with `code`, what was there before kept.
  void expect_refusal(int code, const std::string& words) const {
    const Outcome outcome = wheeltap(where_, "report " + run_.string());
    EXPECT_EQ(outcome.exit_code, code) << outcome.err;
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(words));
    EXPECT_EQ(read_all(run_ / "report.html"), drawn_);
  }
  void cut_in_half(const std::string& name) const {
    std::filesystem::resize_file(run_ / name, std::filesystem::file_size(run_ / name) / 2);
  }

  Workspace where_;
  std::filesystem::path run_;
  std::string drawn_;
};

TEST_F(ReportCommand, DrawsTheSameReportAgain) {
  std::filesystem::remove(run_ / "report.html");
  EXPECT_EQ(wheeltap(where_, "report " + run_.string()).exit_code, 0);
  EXPECT_EQ(read_all(run_ / "report.html"), drawn_);
}

TEST_F(ReportCommand, MissingEndsWith66) {
  std::filesystem::remove(run_ / "posterior.nc");
  expect_refusal(66, "posterior.nc: no such file");
  std::filesystem::remove(run_ / "summary.json");
  expect_refusal(66, "summary.json: no such file");
  EXPECT_EQ(wheeltap(where_, "report " + (where_ / "nowhere").string()).exit_code, 66);
  EXPECT_EQ(wheeltap(where_, "report " + (where_ / "c.json").string()).exit_code, 66);
}

TEST_F(ReportCommand, TruncatedSummaryEndsWith65) {
  cut_in_half("summary.json");
  expect_refusal(65, "summary.json: is truncated or not JSON");
}

TEST_F(ReportCommand, TruncatedPosteriorEndsWith65) {
  cut_in_half("posterior.nc");
  expect_refusal(65, "posterior.nc");
}

TEST_F(ReportCommand, ForeignSummaryEndsWith65) {
  where_.write("run/summary.json", R"({"total": 3})");
  expect_refusal(65, "not the summary of a wheeltap run");
}

TEST_F(ReportCommand, ForeignPosteriorEndsWith65) {
  where_.write("run/posterior.nc", "mode,frequency\n1,13.8\n");
  expect_refusal(65, "posterior.nc");
}

// Any part of a summary may be of another shape: refused in one line, never a fault of ours.
TEST_F(ReportCommand, SummaryWithPartsOfAnotherShapeEndsWith65) {
  const json whole = json::parse(read_all(run_ / "summary.json"));
  for (const char* key :
       {"wheeltap", "models", "parameters", "damage", "beam", "kinds", "diagnostics"}) {
    for (const json& wrong : {json(3), json(nullptr), json("text"), json::array({1, 2})}) {
      json changed = whole;
      changed[key] = wrong;
      where_.write("run/summary.json", changed.dump());
      const Outcome outcome = wheeltap(where_, "report " + run_.string());
      EXPECT_EQ(outcome.exit_code, 65) << key << " = " << wrong << ": " << outcome.err;
    }
  }
}

TEST_F(ReportCommand, UnwritableEndsWith73) {
  std::filesystem::remove(run_ / "report.html");
  std::filesystem::create_directories(run_ / "report.html/in the way");
  const Outcome outcome = wheeltap(where_, "report " + run_.string());
  EXPECT_EQ(outcome.exit_code, 73) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("report.html"));
}

}  // namespace
}  // namespace wheeltap::apps
