// Command line of the program: exit codes, one line per error, no incomplete files.
#include <gmock/gmock.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>

#include "emulator/table_file.hpp"
#include "io/text/text.hpp"
#include "program.hpp"

namespace wheeltap::apps {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kShortRun = " --quiet --chains 2 --warmup 3000 --draws 1000 ";

json table_case() {
  json c = small_case();
  c["damage"]["location"] = {{"uniform", {0.1, 0.9}}};
  c["damage"]["count"]["max"] = 1;
  c["predictor"] = json::parse(R"({"sites": [2, 5, 9], "multipliers": [0.4, 1.0], "holdout": 20})");
  return c;
}

void expect_refusal(const Workspace& where, const std::string& arguments, int code,
                    std::initializer_list<std::string> words) {
  const Outcome outcome = wheeltap(where, arguments);
  EXPECT_EQ(outcome.exit_code, code) << arguments << "\n" << outcome.err;
  EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
  for (const std::string& word : words) EXPECT_THAT(outcome.err, HasSubstr(word));
}

TEST(CommandLine, AnswersThatCannotBePrintedEndWith73) {
  const Workspace where;
  const std::string c = where.write_json("c.json", small_case()).string();
  const std::string err = (where / "err").string();
  for (const std::string& asked : {std::string("--help"), std::string("--version"), "modes " + c,
                                   std::string("damage --help"), std::string("schema")}) {
    const std::string command = std::string(WHEELTAP_PROGRAM) + " " + asked + " >/dev/full 2>";
    const int status = std::system((command + err).c_str());
    EXPECT_EQ(WEXITSTATUS(status), 73) << asked;
    EXPECT_EQ(read_all(err), "wheeltap: standard output cannot be written\n") << asked;
  }
}

TEST(CommandLine, BadCommandLinesEndWith64) {
  const Workspace where;
  const std::string c = where.write_json("c.json", small_case()).string();
  expect_refusal(where, "", 64, {"a command is missing", "wheeltap init damage"});
  expect_refusal(where, "dammage " + c, 64, {"dammage", "did you mean \"damage\"?"});
  expect_refusal(where, "damage " + c, 64, {"--output"});
  expect_refusal(where, "damage -o x", 64, {"CASE"});
  expect_refusal(where, "damage " + c + " -o x --chains 0", 64, {"--chains"});
  expect_refusal(where, "damage " + c + " -o x --chains two", 64, {"--chains"});
  expect_refusal(where, "damage " + c + " -o x --nonsense", 64, {"--nonsense"});
  expect_refusal(where, "damage " + c + " -o x --set beam.length", 64, {"path.to.key=VALUE"});
  for (const char* option : {"--draws 5", "--draws -100", "--warmup -1", "--threads -1"}) {
    expect_refusal(where, "damage " + c + " -o x " + option, 64,
                   {std::string(option).substr(0, 6)});
  }
  expect_refusal(where, "damage " + c + " -o x --evidence=tmcm", 64, {"tmcm", "tmcmc, bridge"});
  expect_refusal(where, "damage " + c + " -o x --prior-only --evidence", 64,
                 {"--prior-only", "--evidence"});
  expect_refusal(where, "modes " + c + " --shapes", 64, {"--shapes needs --json"});
  expect_refusal(where, "schema nothing", 64, {"nothing", "damage"});
  const std::string endless(100000, '7');
  for (std::size_t shift = 0; shift < 3; ++shift) {  // one of them would split a character
    std::string typed = "damage " + c + " --seed " + std::string(shift, 'a');
    for (int i = 0; i < 5000; ++i) typed += "梁";
    EXPECT_FALSE(io::first_unprintable(wheeltap(where, typed).err, "\n"));
  }
  for (const std::string& typed :
       {"damage " + c + " --seed " + endless, endless, "damage " + c + " -o x --set " + endless}) {
    EXPECT_LT(wheeltap(where, typed).err.size(), 1100U);
    expect_refusal(where, typed, 64, {"777 ... 777"});
  }
  const std::string sid = WHEELTAP_DATA "/sid/discover_law.case.json";
  expect_refusal(where, "simulate " + sid + " -o record.json", 64, {"record.json", ".csv"});
}

TEST(CommandLine, HelpAndVersionEndWell) {
  const Workspace where;
  EXPECT_EQ(wheeltap(where, "--help").exit_code, 0);
  EXPECT_THAT(wheeltap(where, "--version").out, HasSubstr(WHEELTAP_VERSION));
  for (const char* command : {"modes", "table", "damage", "simulate", "schema"}) {
    const Outcome outcome = wheeltap(where, std::string(command) + " --help");
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(outcome.out, HasSubstr(command == std::string("schema") ? "NAME" : "CASE"));
  }
}

TEST(CommandLine, BadCasesEndWith65AndNameThePlace) {
  const Workspace where;
  const std::string good = where.write_json("c.json", small_case()).string();
  const auto with = [&](const std::string& set) {
    return "damage " + good + " -o " + (where / "out").string() + kShortRun + "--set '" + set + "'";
  };
  expect_refusal(where, with("beam.lenght=1"), 65, {"c.json", "/beam/lenght", "length"});
  expect_refusal(where, with("beam.length=-1"), 65, {"/beam/length", "-1", "> 0"});
  expect_refusal(where, with("beam.material.poisson=0.5"), 65, {"/beam/material/poisson", "< 0.5"});
  expect_refusal(where, with("damage.reduction={\"uniform\":[0,1]}"), 65,
                 {"/damage/reduction", "[0, 1)"});
  for (const char* prior :
       {R"({"uniform":[0.5,0.2]})", R"({"uniform":[0.3,0.3]})", R"({"normal":[0.2,-0.1]})",
        R"({"beta":[0,1]})", R"({"flat":[0,1]})", R"({"log_uniform":[0,0.5]})"}) {
    expect_refusal(where, with(std::string("damage.reduction=") + prior), 65,
                   {"/damage/reduction"});
  }
  expect_refusal(where, with("damage.location={\"uniform\":[0,1.2]}"), 65,
                 {"/damage/location", "1.2"});
  expect_refusal(where, with("damage.truth=[{\"location\":1.2,\"reduction\":0.2}]"), 65,
                 {"/damage/truth/0/location", "1.2"});
  expect_refusal(where, with("beam.elements=1"), 65, {"3 modes", "at most 2"});
  expect_refusal(where, with("data.frequencies=[13.8,\"NaN\"]"), 65, {"/data/frequencies/1"});
  expect_refusal(where, with("data.frequencies=[13.8,NaN]"), 65, {"/data/frequencies"});
  expect_refusal(where, with("predictor={\"sites\":[2,9],\"multipliers\":[0.4,1]}"), 65,
                 {"/damage/location", "training domain", "uniform [0, 1]"});
  EXPECT_FALSE(std::filesystem::exists(where / "out/summary.json"));
  const auto broken =
      where.write("broken.json", "{\"kind\": \"damage\",\n  \"beam\": {\"length\": NaN}}");
  expect_refusal(where, "damage " + broken.string() + " -o x", 65, {"broken.json:2:22"});
  const auto csv = where.write("f.csv", "mode,frequency\n1,13.8\n2,abc\n");
  expect_refusal(where, with("data={\"file\":\"f.csv\",\"cov\":0.01}"), 65, {"f.csv:3:2"});
  expect_refusal(where, "modes " + good + " --modes 1000", 65, {"/beam", "1000"});
}

TEST(CommandLine, MissingFilesEndWith66) {
  const Workspace where;
  expect_refusal(where, "damage /no/such/case.json -o x", 66, {"/no/such/case.json"});
  const std::string good = where.write_json("c.json", small_case()).string();
  expect_refusal(where, "damage " + good + " -o x --set data='{\"file\":\"no.csv\",\"cov\":0.01}'",
                 66, {"no.csv"});
  json c = table_case();
  c["predictor"] = {{"table", "no.nc"}};
  expect_refusal(
      where, "damage " + where.write_json("t.json", c).string() + " -o " + (where / "out").string(),
      66, {"no.nc"});
}

TEST(CommandLine, UnwritableOutputEndsWith73) {
  const Workspace where;
  const std::string good = where.write_json("c.json", small_case()).string();
  where.write("file", std::string("not a folder"));
  const std::string below = (where / "file").string() + "/below";
  expect_refusal(where, "damage " + good + " -o " + below + kShortRun, 73, {"file/below"});
  expect_refusal(where,
                 "table " + where.write_json("t.json", table_case()).string() + " -o " + below, 73,
                 {"file/below"});
  json c = small_case();
  c["damage"]["truth"] = json::array();
  expect_refusal(where, "simulate " + where.write_json("s.json", c).string() + " -o " + below, 73,
                 {"file/below"});
}

TEST(CommandLine, TablesAreComputedUsedAndRefused) {
  const Workspace where;
  json c = table_case();
  const std::string design = where.write_json("t.json", c).string();
  const std::string table = (where / "t.nc").string();
  const Outcome made = wheeltap(where, "table " + design + " -o " + table + " --quiet");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("6 FE runs"));
  EXPECT_THAT(made.out, HasSubstr("cannot predict"));
  c["predictor"] = {{"table", "t.nc"}};
  const std::string run = " -o " + (where / "out").string() + kShortRun;
  const std::string uses = where.write_json("u.json", c).string();
  const Outcome used = wheeltap(where, "damage " + uses + run);
  EXPECT_EQ(used.exit_code, 0) << used.err;
  expect_refusal(where, "damage " + uses + run + "--set beam.length=1.1", 65, {"t.nc"});
  expect_refusal(where, "damage " + uses + run + "--set damage.count.max=2", 65,
                 {"/predictor", "t.nc"});
  const std::string bytes = read_all(table);
  where.write("t.nc", bytes.substr(0, bytes.size() / 2));
  expect_refusal(where, "damage " + uses + run, 65, {"t.nc"});
  where.write("t.nc", std::string("not a table"));
  expect_refusal(where, "damage " + uses + run, 65, {"t.nc"});
}

// After a kill at any time, finished runs are not repeated and the table is unchanged.
TEST(CommandLine, ATableKilledAtAnyMomentResumes) {
  const Workspace where;
  json c = table_case();
  c["beam"]["elements"] = 60;
  c["damage"]["count"]["max"] = 2;
  c["damage"]["location"] = {{"uniform", {0.0, 1.0}}};
  c["predictor"] =
      json::parse(R"({"sites": "every-element", "multipliers": [0.4, 0.7, 1.0], "holdout": 20})");
  const std::string design = where.write_json("t.json", c).string();
  const std::string whole = (where / "whole.nc").string(), cut = (where / "cut.nc").string();
  ASSERT_EQ(wheeltap(where, "table " + design + " -o " + whole + " --quiet").exit_code, 0);
  const std::filesystem::path journal = cut + ".runs.count_2";
  std::error_code none;
  // Kill when the journal has this many bytes. The last kill may come after the end.
  bool killed = false;
  for (const std::uintmax_t bytes : {1U, 3000U, 200000U}) {
    const pid_t child = fork();
    if (child == 0) {
      std::freopen("/dev/null", "w", stdout);
      execl(WHEELTAP_PROGRAM, "wheeltap", "table", design.c_str(), "-o", cut.c_str(), "--quiet",
            "--resume", static_cast<char*>(nullptr));
      _exit(127);
    }
    ASSERT_GT(child, 0);
    int status = 0;
    pid_t ended = 0;
    while ((ended = waitpid(child, &status, WNOHANG)) == 0) {
      const auto size = std::filesystem::file_size(journal, none);
      if (!none && size >= bytes) break;
      sched_yield();
    }
    if (ended == 0) {
      kill(child, SIGKILL);
      waitpid(child, &status, 0);
    }
    killed = killed || WIFSIGNALED(status);
    EXPECT_FALSE(std::filesystem::exists(cut) && WIFSIGNALED(status)) << "nothing half-written";
  }
  ASSERT_TRUE(killed);
  const Outcome resumed = wheeltap(where, "table " + design + " -o " + cut + " --quiet --resume");
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_THAT(resumed.out, HasSubstr("Resumed: "));
  EXPECT_FALSE(std::filesystem::exists(journal));
  const auto a = emulator::read_table_file(whole), b = emulator::read_table_file(cut);
  for (const auto& [name, table] : a.tables) {
    EXPECT_EQ(table.values, b.tables.at(name).values) << name;
    EXPECT_EQ(table.parameters, b.tables.at(name).parameters) << name;
  }
  // A journal of another design is ignored.
  where.write("other.nc.runs.count_1", "wheeltap-journal 1 0123456789abcdef 3\n");
  expect_refusal(where, "table " + design + " -o " + (where / "other.nc").string() + " --resume",
                 65, {"another experiment"});
}

TEST(CommandLine, TwoHalfTablesMakeTheWhole) {
  const Workspace where;
  const std::string design = where.write_json("t.json", table_case()).string();
  const auto path = [&](const char* name) { return (where / name).string(); };
  ASSERT_EQ(wheeltap(where, "table " + design + " -o " + path("whole.nc") + " --quiet").exit_code,
            0);
  for (const char* part : {"1", "2"}) {
    const Outcome half = wheeltap(where, "table " + design + " --part " + part + "/2 -o " +
                                             path("half") + part + ".nc --quiet");
    ASSERT_EQ(half.exit_code, 0) << half.err;
  }
  const std::string halves = " --merge " + path("half1.nc") + " " + path("half2.nc");
  const Outcome merged =
      wheeltap(where, "table " + design + " -o " + path("merged.nc") + " --quiet" + halves);
  ASSERT_EQ(merged.exit_code, 0) << merged.err;
  const auto a = emulator::read_table_file(path("whole.nc"));
  const auto b = emulator::read_table_file(path("merged.nc"));
  EXPECT_EQ(a.tables.at("count_1").values, b.tables.at("count_1").values);
  EXPECT_EQ(a.tables.at("count_1").holdout, b.tables.at("count_1").holdout);
  EXPECT_EQ(a.tables.at("count_1").parameters, b.tables.at("count_1").parameters);

  const auto refuse = [&](const std::string& rest, int code,
                          std::initializer_list<std::string> words) {
    expect_refusal(where, "table " + design + " -o " + path("x.nc") + " " + rest, code, words);
    EXPECT_FALSE(std::filesystem::exists(path("x.nc")));
  };
  refuse("--merge " + path("half1.nc"), 65, {"/predictor", "lack", "1 damage"});
  refuse("--merge " + path("none.nc"), 66, {"none.nc"});
  refuse(halves + " --set beam.length=1.1", 65, {"half1.nc"});
  refuse(halves + " --set predictor.sites=[2,6,9]", 65, {"/predictor", "lack"});
  refuse("--part 3/2", 64, {"--part 3/2"});
  refuse("--part 1", 64, {"--part 1"});
  refuse("--part 1/2" + halves, 64, {"--part and --merge"});
  refuse("--part 100/100", 65, {"/predictor", "empty"});
  json uses = table_case();
  uses["predictor"] = {{"table", "half1.nc"}};
  expect_refusal(
      where,
      "damage " + where.write_json("u.json", uses).string() + " -o " + path("out") + kShortRun, 65,
      {"half1.nc", "part 1/2"});
}

TEST(CommandLine, BadEmulatorsEndWith65) {
  const Workspace where;
  const std::string design = where.write_json("t.json", table_case()).string();
  where.write("short.csv", "location[1] [m],reduction[1],f1 [Hz],f2 [Hz],f3 [Hz]\n0.1,0.2,1,2\n");
  where.write("empty.csv", "location[1] [m],reduction[1],f1 [Hz],f2 [Hz],f3 [Hz]\n");
  where.write(
      "off.csv",
      "location[1] [m],reduction[1],f1 [Hz],f2 [Hz],f3 [Hz]\n0.1,0.2,1,2,3\n1.4,0.1,1,2,3\n");
  const auto refuse = [&](const std::string& predictor, std::initializer_list<std::string> words) {
    expect_refusal(where,
                   "table " + design + " -o " + (where / "x.nc").string() +
                       " --set 'predictor=" + predictor + "'",
                   65, words);
    EXPECT_FALSE(std::filesystem::exists(where / "x.nc"));
  };
  refuse(R"({"sites":[2,2,9],"multipliers":[0.4,1]})", {"/predictor/sites/1", "duplicates"});
  refuse(R"({"sites":[2,11],"multipliers":[0.4,1]})", {"/predictor/sites/1", "10 elements"});
  refuse(R"({"sites":[],"multipliers":[0.4,1]})", {"/predictor"});
  refuse(R"({"sites":[2,9],"multipliers":[0.4,1.2]})", {"/predictor/multipliers/1", "1.2"});
  refuse(R"({"sites":[2,9],"multipliers":[0.4,0.4]})", {"/predictor/multipliers", "twice"});
  refuse(R"({"sites":[2,9]})", {"/predictor/multipliers", "missing"});
  refuse(R"({"sites":[2,9],"multipliers":[0.4,1],"interpolation":"delaunay"})",
         {"/predictor/interpolation"});
  refuse(R"({"sites":[[2,9],[1,8]],"multipliers":[0.4,1],"expansion":"anova"})",
         {"/predictor/sites"});
  refuse(R"({"design":{"kind":"sobol","runs":4}})", {"/predictor/design/runs", "4"});
  refuse(R"({"design":{"kind":"sobol","runs":40},"interpolation":"cubic"})",
         {"/predictor/interpolation"});
  refuse(R"({"runs_csv":"short.csv"})", {"short.csv", "2"});
  refuse(R"({"runs_csv":"empty.csv"})", {"empty.csv"});
  refuse(R"({"runs_csv":"off.csv","interpolation":"gaussian-process"})", {"off.csv", "1.4"});
  for (const auto& [names, words] : std::initializer_list<std::pair<std::string, std::string>>{
           {"run,f1 [Hz],f2 [Hz]", "\"run\" is neither a factor nor a numbered response"},
           {"f1 [Hz],f2 [Hz],f4 [Hz]", "no number 3"},
           {"f1 [Hz],f2 [Hz],f3 [mm]", "\"f3 [mm]\" must be one of Hz"}}) {
    where.write("names.csv", "location[1] [m],reduction[1]," + names + "\n0.1,0.2,1,2,3\n");
    refuse(R"({"runs_csv":"names.csv","interpolation":"gaussian-process"})", {words});
  }
  expect_refusal(where,
                 "table " + design + " -o x.nc --set 'predictor={\"runs_csv\":\"none.csv\"}'", 66,
                 {"none.csv"});
}

TEST(CommandLine, PriorOnlyRunsOnAnEmulatorCheckNothing) {
  const Workspace where;
  const std::string path = where.write_json("t.json", table_case()).string();
  const Outcome outcome = wheeltap(
      where, "damage " + path + " -o " + (where / "out").string() + kShortRun + "--prior-only");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json s = json::parse(read_all(where / "out/summary.json"));
  EXPECT_FALSE(s["emulator"].contains("check"));
}

TEST(CommandLine, AnExactRunCountsItsFullModelCalls) {
  const Workspace where;
  json c = small_case();
  c["data"]["cov"] = 0.002;
  const std::string out = " -o " + (where / "out").string() + kShortRun;
  const auto summary = [&](const char* predictor) {
    c["predictor"] = json::parse(predictor);
    const Outcome outcome =
        wheeltap(where, "damage " + where.write_json("c.json", c).string() + out);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    json s = json::parse(read_all(where / "out/summary.json"));
    s["said"] = outcome.out;
    return s;
  };
  const json fe = summary(R"("fe")");
  EXPECT_EQ(fe["cost"]["full_model_calls"], fe["cost"]["likelihood_evaluations"]);
  const json blind = summary(R"({"sites": [1, 10], "multipliers": [0.4, 1.0], "holdout": 50})");
  EXPECT_EQ(blind["emulator"]["full_model_calls"]["training"], 4 + 16);
  EXPECT_EQ(blind["emulator"]["full_model_calls"]["validation"], 2 * 50);
  EXPECT_EQ(blind["emulator"]["check"]["draws"], 2000);
  EXPECT_TRUE(blind["emulator"]["check"]["moved"]);
  EXPECT_THAT(blind["said"].get<std::string>(),
              HasSubstr("The emulator error changed the results"));
  const json exact =
      summary(R"({"sites": [1, 10], "multipliers": [0.4, 1.0], "holdout": 50, "exact": true})");
  const long full = exact["emulator"]["full_model_calls"]["likelihood"].get<long>();
  EXPECT_GT(full, 0);
  EXPECT_LT(full, exact["cost"]["likelihood_evaluations"].get<long>());
  EXPECT_THAT(exact["said"].get<std::string>(), HasSubstr("The emulator only screened proposals"));
  for (std::size_t m = 0; m < 3; ++m) {
    const double error =
        std::hypot(fe["models"][m]["mcse"].get<double>(), exact["models"][m]["mcse"].get<double>());
    EXPECT_NEAR(exact["models"][m]["probability"].get<double>(),
                fe["models"][m]["probability"].get<double>(), 4.5 * error);
  }
  const json good = summary(R"({"sites": "every-element", "multipliers": [0.4, 0.6, 0.8, 1.0],
    "interpolation": "monotone-cubic", "coordinate": "compliance", "holdout": 50})");
  EXPECT_FALSE(good["emulator"]["check"]["moved"]);
  EXPECT_THAT(good["said"].get<std::string>(), HasSubstr("Check of 2000 draws"));
}

TEST(CommandLine, ModesAsJson) {
  const Workspace where;
  json c = small_case();
  c["beam"]["elements"] = 100;
  c["beam"]["supports"] = "free-free";
  const Outcome outcome =
      wheeltap(where, "modes " + where.write_json("c.json", c).string() + " --json --modes 5");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json modes = json::parse(outcome.out);
  ASSERT_EQ(modes["frequencies_hz"].size(), 5U);
  EXPECT_EQ(modes["frequencies_hz"][0], 0.0);
  EXPECT_EQ(modes["frequencies_hz"][1], 0.0);
  EXPECT_GT(modes["frequencies_hz"][2], 1.0);
}

TEST(CommandLine, ModesOfTheTruthAreLower) {
  const Workspace where;
  json c = small_case();
  c["damage"]["truth"] = {{{"location", 0.35}, {"reduction", 0.5}}};
  const std::string path = where.write_json("c.json", c).string();
  const json intact = json::parse(wheeltap(where, "modes " + path + " --json").out);
  const json damaged = json::parse(wheeltap(where, "modes " + path + " --json --truth").out);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LT(damaged["frequencies_hz"][i].get<double>(),
              intact["frequencies_hz"][i].get<double>());
  }
}

TEST(CommandLine, SimulatedDataAreReadBack) {
  const Workspace where;
  json c = small_case();
  c["data"] = {{"modes", 4}, {"cov", 0.001}};
  c["damage"]["truth"] = {{{"location", 0.35}, {"reduction", 0.5}}};
  const std::string path = where.write_json("c.json", c).string();
  ASSERT_EQ(wheeltap(where, "simulate " + path + " -o " + (where / "d.csv").string()).exit_code, 0);
  ASSERT_EQ(wheeltap(where, "simulate " + path + " -o " + (where / "d.json").string()).exit_code,
            0);
  const json whole = json::parse(read_all(where / "d.json"));
  EXPECT_EQ(whole["data"]["frequencies"].size(), 4U);
  const std::string out = " -o " + (where / "out").string() + kShortRun;
  const auto summary = [&](const std::string& arguments) {
    const Outcome outcome = wheeltap(where, "damage " + arguments + out);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return json::parse(read_all(where / "out/summary.json"));
  };
  const json in_memory = summary(path);
  const json from_csv = summary(path + " --set data='{\"file\":\"d.csv\"}'");
  EXPECT_EQ(in_memory["models"], from_csv["models"]) << "the same data, the same seed";
  EXPECT_EQ(json::parse(read_all(where / "out/summary.json"))["data"]["simulated"], false);
}

TEST(CommandLine, ARunWritesWhatTheContractSays) {
  const Workspace where;
  const std::string path = where.write_json("c.json", small_case()).string();
  const std::string out = (where / "out").string();
  const Outcome outcome = wheeltap(where, "damage " + path + " -o " + out + kShortRun + "--seed 3");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, IsEmpty()) << "--quiet";
  EXPECT_THAT(outcome.out, HasSubstr("How many damages?"));
  EXPECT_THAT(outcome.out, HasSubstr("out/summary.json"));
  const json s = json::parse(read_all(where / "out/summary.json"));
  EXPECT_EQ(s["wheeltap"]["seed"], 3);
  EXPECT_EQ(s["wheeltap"]["command"], "damage");
  EXPECT_EQ(s["wheeltap"]["case"], small_case());
  ASSERT_EQ(s["models"].size(), 3U);
  double total = 0.0;
  for (const json& m : s["models"]) total += m["probability"].get<double>();
  EXPECT_NEAR(total, 1.0, 1e-12);
  for (const char* key :
       {"mean", "sd", "q2.5", "q50", "q97.5", "mode", "ess_bulk", "ess_tail", "rhat"}) {
    EXPECT_TRUE(s["parameters"]["1 damage"]["location[1]"].contains(key)) << key;
  }
  const json& inclusion = s["damage"]["inclusion_by_element"];
  ASSERT_EQ(inclusion["overall"].size(), 10U);
  double expected = 0.0, sum = 0.0;
  for (const json& x : inclusion["overall"]) sum += x.get<double>();
  for (std::size_t k = 0; k < 3; ++k) {
    expected += static_cast<double>(k) * s["models"][k]["probability"].get<double>();
  }
  EXPECT_NEAR(sum, expected, 1e-9) << "all damages are somewhere";
  for (const char* key :
       {"converged", "ess_model", "round_trips", "rhat_max", "acceptance", "warnings"}) {
    EXPECT_TRUE(s["diagnostics"].contains(key)) << key;
  }
  EXPECT_GT(s["cost"]["likelihood_evaluations"], 0);
  EXPECT_GT(s["cost"]["wall_seconds"], 0.0);
  for (const auto& entry : std::filesystem::directory_iterator(where / "out")) {
    EXPECT_THAT(entry.path().filename().string(), testing::Not(HasSubstr("tmp")));
  }
}

TEST(CommandLine, ThreadsDoNotChangeAResult) {
  const Workspace where;
  const std::string path = where.write_json("c.json", small_case()).string();
  const auto run = [&](const std::string& threads) {
    const std::string out = (where / ("out" + threads)).string();
    EXPECT_EQ(wheeltap(where, "damage " + path + " -o " + out + kShortRun + "--threads " + threads)
                  .exit_code,
              0);
    return json::parse(read_all(out + "/summary.json"));
  };
  const json one = run("1"), three = run("3");
  EXPECT_EQ(one["models"], three["models"]);
  EXPECT_EQ(one["parameters"], three["parameters"]);
}

TEST(CommandLine, ResumePrintsAFinishedRunAndRepeatsAnother) {
  const Workspace where;
  const std::string path = where.write_json("c.json", small_case()).string();
  const std::string out = (where / "out").string();
  const std::string run =
      "damage " + path + " -o " + out + " --chains 2 --warmup 3000 --draws 1000";
  ASSERT_EQ(wheeltap(where, run).exit_code, 0);
  const auto written = std::filesystem::last_write_time(where / "out/summary.json");
  EXPECT_THAT(wheeltap(where, run + " --resume").err, HasSubstr("nothing is run again"));
  EXPECT_EQ(std::filesystem::last_write_time(where / "out/summary.json"), written);
  EXPECT_THAT(wheeltap(where, run + " --resume --seed 2").err,
              Not(HasSubstr("nothing is run again")));
  EXPECT_THAT(wheeltap(where, run + " --resume --seed 2 --search 50").err,
              Not(HasSubstr("nothing is run again")));
  EXPECT_THAT(wheeltap(where, run + " --resume --seed 2 --search 50").err,
              HasSubstr("nothing is run again"));
  EXPECT_EQ(json::parse(read_all(where / "out/summary.json"))["wheeltap"]["seed"], 2);
}

// Criterion: with the likelihood off, the run returns the prior (here through the program, with
// unequal count weights and several kinds).
TEST(CommandLine, PriorOnlyReturnsThePrior) {
  const Workspace where;
  json c = small_case();
  c["damage"]["count"] = {{"max", 2}, {"prior", {1, 2, 3}}};
  c["damage"]["location"] = {{"beta", {2, 5}}};
  const json support = {{"kind", "support"},
                        {"count", {{"max", 1}, {"prior", {3, 1}}}},
                        {"location", {{"uniform", {0.2, 0.6}}}},
                        {"stiffness", {{"log_uniform", {1e2, 1e6}}}}};
  c["damage"] = {c["damage"], support};
  const std::string out = (where / "out").string();
  const Outcome outcome =
      wheeltap(where, "damage " + where.write_json("c.json", c).string() + " -o " + out +
                          " --quiet --prior-only --warmup 6000 --draws 10000");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json s = json::parse(read_all(where / "out/summary.json"));
  ASSERT_EQ(s["models"].size(), 6U);
  for (const json& m : s["models"]) {
    EXPECT_LT(m["mcse"], 0.02);
    EXPECT_NEAR(m["probability"].get<double>(), m["prior"].get<double>(),
                4.5 * m["mcse"].get<double>())
        << m["name"];
  }
  const json& p = s["parameters"]["1 damage, 1 support"];
  const auto near = [&](const char* name, double mean, double sd) {
    const double mcse = sd / std::sqrt(p[name]["ess_bulk"].get<double>());
    EXPECT_NEAR(p[name]["mean"].get<double>(), mean, 4.5 * mcse) << name;
    EXPECT_NEAR(p[name]["sd"].get<double>() / sd, 1.0, 0.1) << name;
  };
  near("damage location[1]", 2.0 / 7.0, std::sqrt(10.0 / (49.0 * 8.0)));
  near("reduction[1]", 0.3, 0.6 / std::sqrt(12.0));
  near("support location[1]", 0.4, 0.4 / std::sqrt(12.0));
}

// The program restarts with environment variables that libraries read at start.
TEST(CommandLine, SimdKeepsLibrariesToTheSameInstructions) {
  const Workspace where;
  const std::string run = "damage " + where.write_json("c.json", small_case()).string() + " -o " +
                          (where / "out").string() + " --quiet --chains 2 --warmup 100 --draws 100";
  const auto id = [&] {
    return json::parse(read_all(where / "out/summary.json"))["wheeltap"]["run"].get<std::string>();
  };
  ASSERT_EQ(wheeltap(where, run + " --simd baseline").exit_code, 0);
  const std::string asked = id();
  setenv("WHEELTAP_SIMD", "baseline", 1);  // already set: no restart
  setenv("GLIBC_TUNABLES", "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F,-AVX512VL,-AVX512DQ", 1);
  const int code = wheeltap(where, run + " --simd=baseline").exit_code;
  unsetenv("WHEELTAP_SIMD");
  unsetenv("GLIBC_TUNABLES");
  ASSERT_EQ(code, 0);
  EXPECT_EQ(id(), asked);
  const Outcome unknown = wheeltap(where, run + " --simd mmx");
  EXPECT_EQ(unknown.exit_code, 64);
  EXPECT_THAT(unknown.err, HasSubstr("baseline"));
}

}  // namespace
}  // namespace wheeltap::apps
