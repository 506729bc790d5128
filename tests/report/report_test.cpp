// Escaping of input in the page, and directories without a run.
#include "apps/report/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "io/file_error.hpp"

namespace wheeltap::apps {
namespace {

using io::FileError;
using testing::HasSubstr;
using testing::Not;

TEST(ScriptSafe, CannotEndItsElement) {
  const Report hostile = {{"title", "</script><script>alert(1)</script><!--"}};
  const std::string text = script_safe(hostile);
  EXPECT_THAT(text, Not(HasSubstr("<")));
  EXPECT_EQ(Report::parse(text), hostile);
}

TEST(ScriptSafe, KeepsEveryLanguage) {
  const Report many = {{"name", "ضرر 🏗️ \xe2\x80\xa8 \xe2\x80\xa9 \" \\ {{title}}"}};
  const std::string text = script_safe(many);
  EXPECT_THAT(text, Not(HasSubstr("\xe2\x80\xa8")));
  EXPECT_THAT(text, Not(HasSubstr("\xe2\x80\xa9")));
  EXPECT_EQ(Report::parse(text), many);
}

TEST(ScriptSafe, BytesThatAreNotUtf8DoNotStopIt) {
  EXPECT_NO_THROW((void)script_safe(Report("\xff\xfe")));
}

TEST(HtmlText, EscapesAllFive) {
  EXPECT_EQ(html_text("<a href='x'>\"&"), "&lt;a href=&#39;x&#39;&gt;&quot;&amp;");
}

class Directory : public testing::Test {
 protected:
  Directory() {
    std::string name = (std::filesystem::temp_directory_path() / "wheeltap-report-XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~Directory() override { std::filesystem::remove_all(path_); }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name, std::ios::binary) << text;
  }
  void expect(FileError::Kind kind, const std::string& words) const {
    try {
      write_report(path_);
      FAIL() << "no error";
    } catch (const FileError& error) {
      EXPECT_EQ(error.kind(), kind) << error.what();
      EXPECT_THAT(error.what(), HasSubstr(words));
    }
    EXPECT_FALSE(std::filesystem::exists(path_ / "report.html"));
  }
  std::filesystem::path path_;
  const std::string summary_ = R"({
    "wheeltap": {"command": "sid", "case": {}}, "models": [{"name": "m", "probability": 1.0}],
    "parameters": {}, "diagnostics": {"converged": true}})";
};

TEST_F(Directory, Empty) {
  expect(FileError::Kind::missing, "summary.json: no such file");
}

TEST_F(Directory, TruncatedSummary) {
  write("summary.json", summary_.substr(0, summary_.size() / 2));
  expect(FileError::Kind::corrupt, "truncated or not JSON");
}

TEST_F(Directory, AnotherProgramsSummary) {
  write("summary.json", R"({"total": 3})");
  expect(FileError::Kind::foreign, "not the summary of a wheeltap run");
  write("summary.json", "[1, 2]");
  expect(FileError::Kind::foreign, "not the summary of a wheeltap run");
}

TEST_F(Directory, SummaryOfAnotherShape) {
  write("summary.json", R"({"wheeltap": 1, "models": [], "parameters": 2, "diagnostics": 3})");
  expect(FileError::Kind::foreign, "not the summary of a wheeltap run");
  write("summary.json", R"({"wheeltap": {"command": "sid", "case": {}}, "diagnostics": [],
    "models": [{"name": "m", "probability": 1.0}], "parameters": {}})");
  expect(FileError::Kind::foreign, "no usable \"diagnostics\"");
}

TEST_F(Directory, NoPosterior) {
  write("summary.json", summary_);
  expect(FileError::Kind::missing, "posterior.nc: no such file");
}

TEST_F(Directory, ForeignPosterior) {
  write("summary.json", summary_);
  write("posterior.nc", "CDF? no");
  expect(FileError::Kind::corrupt, "posterior.nc");
}

}  // namespace
}  // namespace wheeltap::apps
