// `wheeltap report`: writes the report of a finished run again; documented exit codes on failure.
#include <gmock/gmock.h>
#include <netcdf.h>

#include "sid_cases.hpp"

namespace wheeltap::apps {
namespace {

using nlohmann::json;
using testing::HasSubstr;

// The data of the page of a run.
json drawn_data(const std::filesystem::path& run) {
  const std::string page = read_all(run / "report.html");
  const std::string opening = "<script type=\"application/json\" id=\"run\">";
  const std::size_t from = page.find(opening);
  if (from == std::string::npos) return {};
  const std::size_t begin = from + opening.size();
  return json::parse(page.substr(begin, page.find("</script>", begin) - begin));
}

class ReportCommand : public testing::Test {
 protected:
  ReportCommand() {
    json c = small_case();
    c["beam"]["elements"] = 12;
    const std::string small = where_.write_json("c.json", c).string();
    run_ = where_ / "run";
    const Outcome ran = wheeltap(where_, "damage " + small + " -o " + run_.string() +
                                             " --quiet --chains 2 --warmup 2000 --draws 500");
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    drawn_ = read_all(run_ / "report.html");
  }
  // The report fails with `code` for the changed run and keeps the earlier page.
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

TEST_F(ReportCommand, FiguresAreDrawnInAFolderOfAnyName) {
  if (std::system("node --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "there is no Node.js";
  const std::filesystem::path odd = where_ / "of 'Mat\xe9riel'";
  std::filesystem::rename(run_, odd);
  const Outcome outcome = wheeltap(where_, "report --figures \"" + odd.string() + '"');
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(outcome.err.empty()) << outcome.err;
  std::ifstream list(odd / "figures" / "figures.txt");
  int n = 0;
  for (std::string name; std::getline(list, name); ++n)
    EXPECT_THAT(read_all(odd / "figures" / name), HasSubstr("<svg")) << name;
  EXPECT_GT(n, 0);
}

TEST_F(ReportCommand, FiguresFollowNoSymbolicLink) {
  if (std::system("node --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "there is no Node.js";
  const std::string draw = "report --figures " + run_.string();
  ASSERT_EQ(wheeltap(where_, draw).exit_code, 0);
  std::vector<std::filesystem::path> links = {run_ / "figures" / "figures.txt"};
  std::ifstream list(links[0]);
  for (std::string name; std::getline(list, name);) links.push_back(run_ / "figures" / name);
  const auto mine = where_.write("mine", "my notes");
  for (const auto& link : links) {
    std::filesystem::remove(link);
    std::filesystem::create_symlink(mine, link);
  }
  EXPECT_EQ(wheeltap(where_, draw).exit_code, 0);
  EXPECT_EQ(read_all(mine), "my notes");
  for (const auto& link : links) EXPECT_FALSE(std::filesystem::is_symlink(link)) << link;
  EXPECT_THAT(read_all(links[1]), HasSubstr("<svg"));
  // Nor does a folder.
  std::filesystem::remove_all(run_ / "figures");
  std::filesystem::create_directory(where_ / "elsewhere");
  std::filesystem::create_symlink(where_ / "elsewhere", run_ / "figures");
  const Outcome outcome = wheeltap(where_, draw);
  EXPECT_EQ(outcome.exit_code, 73);
  EXPECT_THAT(outcome.err, HasSubstr("figures: is a symbolic link"));
  EXPECT_TRUE(std::filesystem::is_empty(where_ / "elsewhere"));
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

// A summary with any part of another shape: one error line, never an internal fault.
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

// Fault: the report assumed that priors in the case of a summary have all their numbers.
TEST_F(ReportCommand, PriorsOfAnotherShapeAreNotDrawn) {
  const json whole = json::parse(read_all(run_ / "summary.json"));
  for (const char* wrong : {R"({"normal": []})", R"({"log_normal": 2})", R"({"beta": [1]})",
                            R"({"beta": [1, 1], "on": []})", R"({"truncated_normal": [0, 1]})",
                            R"({"half_normal": [0, 1]})", R"({"nothing": [0, 1]})", "{}"}) {
    json changed = whole;
    changed["wheeltap"]["case"]["damage"]["location"] = json::parse(wrong);
    where_.write("run/summary.json", changed.dump());
    const Outcome outcome = wheeltap(where_, "report " + run_.string());
    EXPECT_EQ(outcome.exit_code, 0) << wrong << ": " << outcome.err;
  }
}

// Fault: with a hundred bins along any beam, some bins crossed the ends of elements.
TEST_F(ReportCommand, BinsAlongTheBeamEndWhereElementsDo) {
  const json elements = json::parse(read_all(run_ / "summary.json"))["beam"]["elements"];
  const json bins = drawn_data(run_)["draws"]["joint"][0]["bins_x"];
  ASSERT_GT(elements.get<int>(), 1);
  EXPECT_GE(bins["n"].get<int>(), 100);
  EXPECT_EQ(bins["n"].get<int>() % elements.get<int>(), 0);
}

TEST_F(ReportCommand, UnwritableEndsWith73) {
  std::filesystem::remove(run_ / "report.html");
  std::filesystem::create_directories(run_ / "report.html/in the way");
  const Outcome outcome = wheeltap(where_, "report " + run_.string());
  EXPECT_EQ(outcome.exit_code, 73) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("report.html"));
}

// A run of an older version, without predictions without noise and paths of links in posterior.nc:
// its report has the median of replicates instead, states this, and has no loops. Groups of a
// NetCDF file cannot be removed, so the test renames them.
TEST(ReportOfAnEarlierRun, IsDrawnFromReplicatesAlone) {
  const Workspace where;
  const auto run = where / "run";
  const std::string c = where.write_json("c.json", small_sid_case()).string();
  const Outcome ran = wheeltap(
      where, "sid " + c + " -o " + run.string() + " --quiet --chains 2 --warmup 2000 --draws 500");
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  const json now = drawn_data(run)["draws"];
  EXPECT_EQ(now["responses"][0]["noise_free"], true);
  EXPECT_EQ(now["link_paths"].size(), 1U);

  int file = 0;
  ASSERT_EQ(nc_open((run / "posterior.nc").c_str(), NC_WRITE, &file), NC_NOERR);
  for (const char* name : {"noise_free", "link_paths"}) {
    int group = 0;
    ASSERT_EQ(nc_inq_grp_ncid(file, name, &group), NC_NOERR) << name;
    ASSERT_EQ(nc_rename_grp(group, (std::string("not_") + name).c_str()), NC_NOERR) << name;
  }
  ASSERT_EQ(nc_close(file), NC_NOERR);
  json summary = json::parse(read_all(run / "summary.json"));
  summary.erase("files");  // older runs have no seals
  where.write("run/summary.json", summary.dump());
  const Outcome again = wheeltap(where, "report " + run.string());
  ASSERT_EQ(again.exit_code, 0) << again.err;
  const json earlier = drawn_data(run)["draws"];
  const json& response = earlier["responses"][0];
  EXPECT_EQ(response["noise_free"], false);
  EXPECT_EQ(earlier["link_paths"].size(), 0U);
  ASSERT_EQ(response["history"].size(), 200U);
  for (const json& row : response["history"]) {
    EXPECT_TRUE(row[3].is_null() && row[5].is_null());  // no band without noise
    EXPECT_LE(row[2].get<double>(), row[4].get<double>());
    EXPECT_LE(row[4].get<double>(), row[6].get<double>());
  }
}

}  // namespace
}  // namespace wheeltap::apps
