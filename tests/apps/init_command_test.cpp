// `wheeltap init`: its cases run without changes, its texts explain every key, and it overwrites no
// file.
#include "apps/commands/init_command.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "apps/cases/syntax/case_file.hpp"
#include "apps/nearest.hpp"
#include "program.hpp"

namespace wheeltap::apps {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kShortStart = " --quiet --chains 2 --warmup 2000 --draws 1000";

bool is_prior(const std::string& path) {
  return path.ends_with(".location") || path.ends_with(".reduction") || path.ends_with(".extent");
}

// Every key of a case in the form of describe_keys, except names of parameters, which users choose.
void expect_told(const json& value, const std::string& path, const std::string& told) {
  if (value.is_array()) {
    for (const json& one : value) expect_told(one, path + "[]", told);
  }
  if (!value.is_object() || is_prior(path)) return;
  if (path == "geometry.nodes") return;  // names of nodes
  for (const auto& [key, inner] : value.items()) {
    const std::string here =
        path == "parameters" ? "parameters.NAME" : (path.empty() ? "" : path + ".") + key;
    EXPECT_THAT(told, HasSubstr("| `" + here + "` |"));
    if (path != "parameters") expect_told(inner, here, told);
  }
}

class Init : public testing::TestWithParam<std::string> {};

TEST_P(Init, WritesACaseThatRunsAndExplainsEveryKeyInIt) {
  const Workspace where;
  const std::string kind = GetParam(), folder = (where / "new").string();
  ASSERT_EQ(wheeltap(where, "init " + kind + " -o " + folder).exit_code, 0);
  const json written = json::parse(read_all(folder + "/" + kind + ".json"));
  expect_told(written, "", read_all(folder + "/" + kind + ".md"));
  const Outcome ran = wheeltap(
      where, kind + " " + folder + "/" + kind + ".json -o " + folder + "/results" + kShortStart);
  EXPECT_EQ(ran.exit_code, 0) << ran.err;
  const json summary = json::parse(read_all(folder + "/results/summary.json"));
  // Its notes state the truth of the simulation: one damage; a hardening spring.
  EXPECT_GT(summary["models"][1]["probability"].get<double>(), 0.5);
}

TEST_P(Init, OverwritesNothing) {
  const Workspace where;
  const std::string kind = GetParam(), folder = (where / "new").string();
  std::filesystem::create_directories(folder);
  where.write("new/" + kind + ".md", "mine");
  const Outcome outcome = wheeltap(where, "init " + kind + " -o " + folder);
  EXPECT_EQ(outcome.exit_code, 73);
  EXPECT_THAT(outcome.err, HasSubstr(kind + ".md: exists already"));
  EXPECT_EQ(read_all(folder + "/" + kind + ".md"), "mine");
  EXPECT_FALSE(std::filesystem::exists(folder + "/" + kind + ".json"));
}

// Its notes state the true modes; a deviation of five standard deviations has probability 6e-7 per
// value.
TEST(InitCommand, AModalCaseFindsTheModesThatItsNotesTell) {
  const Workspace where;
  const std::string folder = (where / "new").string();
  ASSERT_EQ(wheeltap(where, "init modal -o " + folder).exit_code, 0);
  expect_told(json::parse(read_all(folder + "/modal.json")), "", read_all(folder + "/modal.md"));
  const Outcome ran = wheeltap(where, "modal " + folder + "/modal.json -o " + folder + "/results");
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  const json modes = json::parse(read_all(folder + "/results/modes.json"));
  const std::vector<double> known = {3.168, 8.876, 12.826, 0.00995, 0.0279, 0.0403};
  ASSERT_EQ(modes["frequencies_hz"].size(), 3U) << ran.out;
  for (std::size_t i = 0; i < known.size(); ++i) {
    const double found = modes[i < 3 ? "frequencies_hz" : "damping"][i % 3].get<double>();
    EXPECT_NEAR(found, known[i], 5.0 * std::sqrt(modes["covariance"][i][i].get<double>()));
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, Init, testing::Values("damage", "sid"),
                         [](const auto& kind) { return kind.param; });

TEST(InitCommand, OtherKindsEndWith64AndNameTheNearest) {
  const Workspace where;
  const Outcome outcome = wheeltap(where, "init damge -o " + (where / "new").string());
  EXPECT_EQ(outcome.exit_code, 64);
  EXPECT_THAT(outcome.err, HasSubstr("did you mean \"damage\"?"));
  EXPECT_FALSE(std::filesystem::exists(where / "new"));
}

TEST(InitCommand, UnwritableFolderEndsWith73) {
  const Workspace where;
  where.write("file", "");
  EXPECT_EQ(wheeltap(where, "init damage -o " + (where / "file/new").string()).exit_code, 73);
}

TEST(DescribeKeys, TellsEachKeyOnceInWords) {
  for (const std::string& kind : schema_names()) {
    const std::string told = describe_keys(kind);
    std::istringstream lines(told);
    std::vector<std::string> keys;
    for (std::string line; std::getline(lines, line);) {
      if (!line.starts_with("| `")) continue;
      keys.push_back(line.substr(3, line.find('`', 3) - 3));
      const std::string words = line.substr(0, line.size() - 2);
      for (const char* bare : {"| string", "| integer", "| number", "| array", "| object"}) {
        EXPECT_FALSE(words.ends_with(bare)) << line << ": give it a description in the schema";
      }
    }
    EXPECT_GT(keys.size(), 20U);
    std::ranges::sort(keys);
    EXPECT_EQ(std::ranges::adjacent_find(keys), keys.end());
  }
}

TEST(Nearest, IsTheSmallestEditDistanceIfSmallEnough) {
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);
  EXPECT_EQ(nearest("lenght", {"width", "length", "height"}), "length");
  EXPECT_EQ(nearest("xyz", {"width", "length", "height"}), "");
}

}  // namespace
}  // namespace wheeltap::apps
