// wheeltap batch on the command line.
#include <gmock/gmock.h>

#include <chrono>

#include "apps/failure.hpp"
#include "apps/runs/batch/batch_folders.hpp"
#include "apps/runs/batch/batch_table.hpp"
#include "io/file_error.hpp"
#include "sid_cases.hpp"

namespace wheeltap::apps {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kShort = " --chains 2 --warmup 100 --draws 100 --search 20 --quiet ";

std::vector<std::string> names(const std::vector<BatchCase>& cases) {
  std::vector<std::string> out;
  for (const BatchCase& one : cases) out.push_back(one.name);
  return out;
}

std::vector<BatchCase> named(std::vector<BatchCase> cases, const std::filesystem::path& folder) {
  BatchFolders folders(folder, false);
  for (BatchCase& one : cases) folders.give(one);
  return cases;
}

TEST(BatchList, NamesAreStemsAndUnique) {
  const Workspace where;
  const auto list = where.write("list.txt",
                                "# a fleet\n\n a/one.json \r\nb/one.json\nc/one.json\none-2.json\n"
                                "batch.csv.json\n..json\n   # no case\nlast.json");
  const auto cases = named(read_batch_list(list), where / "out");
  EXPECT_THAT(names(cases),
              ElementsAre("one", "one-2", "one-3", "one-2-2", "batch.csv-2", "case", "last"));
  EXPECT_EQ(cases[0].path, where / "a/one.json");
  EXPECT_EQ(cases[6].path, where / "last.json");
}

TEST(BatchList, ManyOfOneNameAreNamedSoon) {
  const Workspace where;
  constexpr int kMany = 300'000;
  std::string text;
  for (int i = 0; i < kMany; ++i) text += "hour-" + std::to_string(i) + "/case.json\n";
  const auto began = std::chrono::steady_clock::now();
  const auto cases = named(read_batch_list(where.write("list.txt", text)), where / "out");
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(20));
  EXPECT_EQ(cases.back().name, "case-" + std::to_string(kMany));
}

TEST(BatchList, AByteOrderMarkIsNoPartOfAPath) {
  const Workspace where;
  const auto cases = read_batch_list(where.write("list.txt", "\xEF\xBB\xBFone.json\r\n"));
  EXPECT_EQ(cases.at(0).path, where / "one.json");
}

TEST(BatchList, LinesThatAreNoPathsAreRefused) {
  const Workspace where;
  const std::string long_one = "{\"title\": \"" + std::string(5000, 'x') + "\"}";
  const std::string long_path = "ok.json\n" + std::string(100'000, 'x');
  for (const auto& [text, words] : {std::pair("ok.json\nbad\x1b[2J.json\n", "list.txt:2: column 4"),
                                    std::pair("\xff.json\n", "list.txt:1: column 1"),
                                    std::pair("# nothing\n\n", "contains no case"),
                                    std::pair("{\n  \"kind\": \"sid\"\n}", "list.txt:1: is JSON"),
                                    std::pair(long_one.c_str(), "list.txt:1: is JSON"),
                                    std::pair(long_path.c_str(), "list.txt:2: has 100000 bytes")}) {
    const auto list = where.write("list.txt", text);
    try {
      static_cast<void>(read_batch_list(list));
      ADD_FAILURE() << words;
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.exit(), Exit::bad_input);
      EXPECT_THAT(failure.what(), HasSubstr(words));
    }
  }
}

TEST(BatchTable, CellsAreQuotedAsRfc4180Asks) {
  const std::vector<std::optional<BatchRow>> rows{
      BatchRow{.name = "a,b",
               .kind = "damage",
               .model = "1 \"crack\"",
               .probability = 0.75,
               .converged = true,
               .seconds = 1.25,
               .path = "../a.json"},
      std::nullopt, BatchRow{.name = "c", .exit = 65, .error = "no, \"x\""}};
  EXPECT_EQ(batch_csv(rows),
            "case,kind,exit,model,probability,converged,wall_seconds,folder,error,path\n"
            "\"a,b\",damage,0,\"1 \"\"crack\"\"\",0.75,1,1.25,\"a,b\",,../a.json\n"
            "c,,65,,,,0,c,\"no, \"\"x\"\"\",\n");
}

TEST(BatchTable, NoCellIsAFormula) {
  const std::vector<std::optional<BatchRow>> rows = {
      BatchRow{.name = "=1+2", .model = "+x", .probability = -1e-3, .error = "@a", .path = "-b"}};
  EXPECT_EQ(batch_csv(rows),
            "case,kind,exit,model,probability,converged,wall_seconds,folder,error,path\n"
            "'=1+2,,0,'+x,-0.001,,0,'=1+2,'@a,'-b\n");
}

TEST(BatchFolders, ACaseKeepsItsFolderWhereverItStandsInTheList) {
  const Workspace where;
  const auto give = [&](const std::string& text, bool resume) {
    std::filesystem::create_directories(where / "out");
    BatchFolders folders(where / "out", resume);
    auto cases = read_batch_list(where.write("list.txt", text));
    for (BatchCase& one : cases) folders.give(one);
    folders.keep();
    return cases;
  };
  EXPECT_THAT(names(give("A/case.json\nB/case.json\n", false)), ElementsAre("case", "case-2"));
  const auto more = give("C/case.json\n./A/../A/case.json\nB/case.json\n", true);
  EXPECT_THAT(names(more), ElementsAre("case-3", "case", "case-2"));
  EXPECT_EQ(more[1].place, "../A/case.json");
  EXPECT_THAT(names(give("B/case.json\n", true)), ElementsAre("case-2"));
  EXPECT_THAT(names(give("D/case.json\nA/case.json\nA/case.json\n", true)),
              ElementsAre("case-4", "case", "case-5"));
  EXPECT_THAT(names(give("B/case.json\n", false)), ElementsAre("case"));
}

TEST(BatchFolders, RejectsAnotherProgramsFile) {
  const Workspace where;
  std::filesystem::create_directories(where / "out");
  for (const char* text : {"", "[1, 2]", "{\"format\": 2, \"folders\": []}",
                           "{\"format\": 1, \"folders\": [{\"case\": 3}]}"}) {
    static_cast<void>(where.write("out/batch.json", text));
    EXPECT_THROW(BatchFolders(where / "out", true), io::FileError) << text;
    EXPECT_THROW(BatchFolders(where / "out", false), io::FileError) << text;
  }
}

class Batch : public testing::Test {
 protected:
  Batch() {
    std::filesystem::create_directory(where / "cases");
    static_cast<void>(where.write_json("cases/beam.json", small_case()));
    static_cast<void>(where.write_json("cases/chain.json", small_sid_case()));
  }
  [[nodiscard]] Outcome run(const std::string& list, const std::string& options = "") const {
    return wheeltap(where, "batch " + where.write("cases/list.txt", list).string() + " -o " +
                               (where / "out").string() + kShort + options);
  }
  [[nodiscard]] json summary(const std::string& name) const {
    return json::parse(read_all(where / "out" / name / "summary.json"));
  }
  Workspace where;
};

// The cells of the rows; no cell of these cases has a comma.
std::vector<std::vector<std::string>> cells(const std::string& csv) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line + ",");
    for (rows.emplace_back(); std::getline(words, line, ',');) rows.back().push_back(line);
  }
  return rows;
}

TEST_F(Batch, ADryRunSaysWhatEachWouldTakeAndRunsNothing) {
  const std::string list = where.write("cases/list.txt", "beam.json\nchain.json\n").string();
  const Outcome all = wheeltap(where, "batch " + list + " --dry-run");
  ASSERT_EQ(all.exit_code, 0) << all.err;
  EXPECT_THAT(all.out, AllOf(HasSubstr("beam: the run would take about "),
                             HasSubstr("chain: the run would take about "), HasSubstr("All 2, "),
                             HasSubstr(" at a time: about ")));
  EXPECT_FALSE(std::filesystem::exists(where / "out"));

  static_cast<void>(where.write("cases/bad.json", "{\"kind\": \"damage\"}"));
  const std::string bad = where.write("cases/list.txt", "bad.json\nchain.json\n").string();
  const Outcome some = wheeltap(where, "batch " + bad + " --dry-run");
  EXPECT_EQ(some.exit_code, 65);
  EXPECT_THAT(some.out, AllOf(HasSubstr("bad: refused (exit code 65): "),
                              HasSubstr("chain: the run would take about ")));
  EXPECT_THAT(some.err, HasSubstr("1 of 2 cases would be rejected"));
}

TEST_F(Batch, EveryCaseIsRunAsByItself) {
  const Outcome all = run("beam.json\nchain.json\n", "--seed 3");
  ASSERT_EQ(all.exit_code, 0) << all.err;
  EXPECT_THAT(all.out, AllOf(HasSubstr("/2] beam  "), HasSubstr("/2] chain  ")));
  const auto table = cells(read_all(where / "out/batch.csv"));
  ASSERT_EQ(table.size(), 3U);
  for (const auto& [row, command] : {std::pair(1U, "damage"), std::pair(2U, "sid")}) {
    const std::string name = table[row][0];
    EXPECT_EQ(table[row][1], command);
    EXPECT_EQ(table[row][2], "0");
    const Outcome alone =
        wheeltap(where, command + (" " + (where / "cases" / name).string()) + ".json -o " +
                            (where / name).string() + kShort + "--seed 3");
    ASSERT_EQ(alone.exit_code, 0) << alone.err;
    const json ours = summary(name), theirs = json::parse(read_all(where / name / "summary.json"));
    EXPECT_EQ(ours["models"], theirs["models"]);
    EXPECT_EQ(ours["parameters"], theirs["parameters"]);
    EXPECT_EQ(ours["wheeltap"]["run"], theirs["wheeltap"]["run"]);
    const json& likely = *std::ranges::max_element(
        ours["models"], {}, [](const json& model) { return model["probability"].get<double>(); });
    EXPECT_EQ(table[row][3], likely["name"]);
    EXPECT_NEAR(std::stod(table[row][4]), likely["probability"].get<double>(), 1e-7);
    EXPECT_EQ(table[row][5], ours["diagnostics"]["converged"] ? "1" : "0");
  }
}

TEST_F(Batch, AFailedCaseStopsNoneAndSaysItself) {
  json bad = small_case();
  bad["beam"]["material"]["poisson"] = 2.0;
  static_cast<void>(where.write_json("cases/bad.json", bad));
  static_cast<void>(where.write("cases/odd.json", R"({"kind": "moon"})"));
  static_cast<void>(where.write("cases/text.json", "no JSON"));
  const Outcome all =
      run("beam.json\nmissing.json\nbad.json\nodd.json\ntext.json\n", "--threads 2");
  EXPECT_EQ(all.exit_code, 66);  // first failure in the order of the list
  EXPECT_EQ(std::ranges::count(all.err, '\n'), 1) << all.err;
  EXPECT_THAT(all.err, HasSubstr("4 of 5 cases failed, the first of them missing (exit code 66)"));
  const std::string csv = read_all(where / "out/batch.csv");
  EXPECT_EQ(std::ranges::count(csv, '\n'), 6);
  EXPECT_THAT(csv,
              AllOf(HasSubstr("\nbeam,damage,0,"), HasSubstr("\nmissing,,66,"),
                    HasSubstr("\nbad,damage,65,"), HasSubstr("/beam/material/poisson"),
                    HasSubstr("\nodd,,65,"), HasSubstr("damage, sid"), HasSubstr("\ntext,,65,")));
  EXPECT_THAT(all.out, HasSubstr("odd  FAILED (65): "));
}

TEST_F(Batch, ResumeKeepsWhatIsFinishedAndRunsTheRest) {
  const std::string list = "beam.json\nchain.json\nlate.json\n";
  EXPECT_EQ(run(list).exit_code, 66);
  const auto written = std::filesystem::last_write_time(where / "out/beam/posterior.nc");
  static_cast<void>(where.write_json("cases/late.json", small_case()));
  const Outcome again = run(list, "--resume");
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(std::filesystem::last_write_time(where / "out/beam/posterior.nc"), written);
  EXPECT_TRUE(std::filesystem::exists(where / "out/late/posterior.nc"));
  // A damaged result does not count as finished.
  static_cast<void>(where.write("out/beam/posterior.nc", "rubbish"));
  const Outcome damaged = run(list, "--resume");
  EXPECT_EQ(damaged.exit_code, 65);
  EXPECT_THAT(read_all(where / "out/batch.csv"), HasSubstr("\nbeam,damage,65,"));
}

TEST_F(Batch, ResumeKnowsACaseByItsPathAndByTheContentOfItsFiles) {
  const auto record = [&](const std::string& name, double amplitude) {
    std::filesystem::create_directories(where / "cases" / name);
    json chain = small_sid_case();
    const json truth = chain["truth"];
    chain["truth"]["parameters"]["k"] = amplitude;
    static_cast<void>(where.write_json("cases/" + name + "/truth.json", chain));
    const std::string folder = (where / "cases" / name).string();
    ASSERT_EQ(
        wheeltap(where, "simulate " + folder + "/truth.json -o " + folder + "/sid.csv --quiet")
            .exit_code,
        0);
    chain.erase("truth");
    chain["record"]["file"] = "sid.csv";
    static_cast<void>(where.write_json("cases/" + name + "/case.json", chain));
  };
  record("A", 40.0);
  record("B", 60.0);
  const auto stiffness = [&](const std::string& folder) {
    return summary(folder)["parameters"].front()["k"]["mean"].get<double>();
  };
  ASSERT_EQ(run("A/case.json\n").exit_code, 0);
  const double of_a = stiffness("case");
  ASSERT_EQ(run("B/case.json\nA/case.json\n", "--resume").exit_code, 0);
  EXPECT_EQ(stiffness("case"), of_a);
  EXPECT_GT(stiffness("case-2"), of_a + 10.0);
  EXPECT_THAT(read_all(where / "out/batch.json"), HasSubstr("../cases/B/case.json"));
  // A changed record at the same path means a new run.
  std::filesystem::copy_file(where / "cases/B/sid.csv", where / "cases/A/sid.csv",
                             std::filesystem::copy_options::overwrite_existing);
  ASSERT_EQ(run("B/case.json\nA/case.json\n", "--resume").exit_code, 0);
  EXPECT_EQ(stiffness("case"), stiffness("case-2"));
}

TEST_F(Batch, ALineThatBeginsWithADashIsAPath) {
  static_cast<void>(where.write_json("cases/-o.json", small_case()));
  static_cast<void>(where.write("cases/list.txt", "-o.json\n"));
  const std::string command = "cd " + (where / "cases").string() + " && " + WHEELTAP_PROGRAM +
                              " batch list.txt -o out >/dev/null" + kShort;
  EXPECT_EQ(std::system(command.c_str()), 0);
  EXPECT_TRUE(std::filesystem::exists(where / "cases/out/-o/summary.json"));
}

TEST_F(Batch, NothingRunsWhereItsTableCannotBeWritten) {
  std::filesystem::create_directories(where / "out/batch.csv");
  const Outcome outcome = run("beam.json\n");
  EXPECT_EQ(outcome.exit_code, 73);
  EXPECT_FALSE(std::filesystem::exists(where / "out/beam"));
}

}  // namespace
}  // namespace wheeltap::apps
