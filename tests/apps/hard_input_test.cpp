// Input that once crashed the program, gave silently wrong results, ended with exit code 70, or was
// rejected only after sampling. "Before" in each test states the old behaviour.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <chrono>

#include "io/file_lock.hpp"
#include "io/text/text.hpp"
#include "sid_cases.hpp"

namespace wheeltap::apps {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kShortest = " --quiet --chains 2 --warmup 100 --draws 100 ";
#ifdef __SANITIZE_THREAD__  // some ten times as slow
constexpr std::chrono::seconds kSoon{100};
#else
constexpr std::chrono::seconds kSoon{10};
#endif

class HardInput : public testing::Test {
 protected:
  // Expects one line, an exit code for bad input, and a short run time.
  void expect_refusal(const std::string& arguments, int code, const std::string& words) const {
    const auto began = std::chrono::steady_clock::now();
    const Outcome outcome = wheeltap(where, arguments);
    EXPECT_EQ(outcome.exit_code, code) << arguments << "\n" << outcome.err;
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
    EXPECT_FALSE(io::first_unprintable(outcome.err, "\n")) << io::printable(outcome.err);
    EXPECT_THAT(outcome.err, HasSubstr(words)) << arguments;
    EXPECT_LT(std::chrono::steady_clock::now() - began, kSoon) << arguments;
  }
  [[nodiscard]] std::string damage(const json& c, const std::string& options = "") const {
    return "damage " + where.write_json("c.json", c).string() + " -o " + (where / "out").string() +
           kShortest + options;
  }
  [[nodiscard]] std::string sid(const json& c, const std::string& options = "") const {
    return "sid " + where.write_json("s.json", c).string() + " -o " + (where / "out").string() +
           kShortest + options;
  }
  Workspace where;
};

// Before: read as 2^64 - 1; as part 1 of 2; 200.0 was rejected.
TEST_F(HardInput, WholeNumbersOfTheCommandLineNeverWrap) {
  for (const char* option :
       {"--seed -1", "--seed 18446744073709551615", "--seed 1e30", "--threads 4294967297",
        "--chains 4294967298", "--draws 4294967396", "--search 4294967297", "--warmup 2.5"}) {
    expect_refusal(damage(small_case(), option), 64, "must be a whole number from");
  }
  json c = small_case();
  c["damage"]["count"]["max"] = 1;
  c["predictor"] = json::parse(R"({"sites": [2, 5, 9], "multipliers": [0.4, 1.0]})");
  for (const char* part :
       {"4294967297/4294967298", "0/2", "3/2", "1/", "/2", "1", "-1/2", "1/2/3"}) {
    expect_refusal("table " + where.write_json("t.json", c).string() + " -o " +
                       (where / "t.nc").string() + " --part " + part,
                   64, "must be I/N");
  }
  const Outcome pointed =
      wheeltap(where, "damage " + where.write_json("c.json", small_case()).string() + " -o " +
                          (where / "out").string() + " --draws 200.0 --seed 5.0 --dry-run");
  EXPECT_EQ(pointed.exit_code, 0) << pointed.err;
}

// Before: --checkpoint nan was accepted.
TEST_F(HardInput, NumbersOfTheCommandLineAreNumbers) {
  for (const char* option : {"--checkpoint nan", "--checkpoint -1", "--checkpoint inf",
                             "--checkpoint 1e400", "--max-hours nan", "--max-memory -nan"}) {
    expect_refusal(damage(small_case(), option), 64, ": must be a ");
  }
}

// The message must not name --threads, which was not given.
TEST_F(HardInput, ANumberOfTheEnvironmentIsNamed) {
  const std::string command = "damage " + where.write_json("c.json", small_case()).string() +
                              " -o " + (where / "out").string();
  setenv("WHEELTAP_THREADS", "4294967297", 1);
  expect_refusal(command, 64, "wheeltap: WHEELTAP_THREADS: 4294967297: must be a whole number");
  unsetenv("WHEELTAP_THREADS");
  for (const char* date : {"abc", "-1", "", "99999999999999999999", "253402300800"}) {
    setenv("SOURCE_DATE_EPOCH", date, 1);
    expect_refusal(command, 64, "SOURCE_DATE_EPOCH: " + std::string(date) + ": must be a whole");
  }
  unsetenv("SOURCE_DATE_EPOCH");
}

// Before: 100 samples, mass 1, ...
TEST_F(HardInput, WholeNumbersOfASidCaseNeverWrap) {
  for (const char* set :
       {"truth.samples=4294967396", "record.samples=[0,4294967396]", "record.lead_in=4294967297",
        "truth.seed=18446744073709551616", "record.channels.0.mass=4294967297",
        "truth.excitation.0.mass=4294967297", "truth.excitation.0.period=4294967300",
        "models.0.links.0.between=[4294967296,1]", "truth.samples=200.5"}) {
    expect_refusal(sid(small_sid_case(), std::string("--set '") + set + "'"), 65, ": must be");
  }
}

// Before: integer overflow of the number of modes; a crash for the row.
TEST_F(HardInput, WholeNumbersOfADamageCaseNeverWrap) {
  for (const char* set :
       {"data.modes=4294967300", "data.row=2147483648", "data.seed=18446744073709551616",
        "beam.elements=4294967306", "damage.count.max=4294967297", "data.columns=[4294967297]",
        "predictor={\"sites\":[4294967301],\"multipliers\":[0.4,1]}", "data.modes=1e300",
        "damage.count.min=0.5"}) {
    expect_refusal(damage(small_case(), std::string("--set '") + set + "'"), 65, ": must be");
  }
  EXPECT_EQ(wheeltap(where, damage(small_case(), "--set beam.elements=10.0 --dry-run")).exit_code,
            0);
}

// Before: exit 73 after all draws were made.
TEST_F(HardInput, NamesThatNoVariableCanHaveAreRefusedBeforeSampling) {
  for (const std::string& name : {std::string(" k"), std::string(".."), std::string(257, 'k'),
                                  std::string("-k"), std::string("")}) {
    json c = small_sid_case();
    c["parameters"][name] = c["parameters"]["k"];
    c["parameters"].erase("k");
    for (json& model : c["models"]) model["links"][0]["stiffness"] = name;
    expect_refusal(sid(c), 65, "a parameter's name ");
  }
  json c = small_sid_case();
  c["parameters"]["a/b"] = c["parameters"]["k"];
  c["parameters"]["a_b"] = c["parameters"]["k"];
  expect_refusal(sid(c), 65, "too similar to the parameter");
  c = small_case();
  c["damage"]["name"] = " crack";
  expect_refusal(damage(c), 65, "/damage/name: ");
}

// Before: exit 73 after sampling, if a column had the name of a variable of the file.
TEST_F(HardInput, ChannelsMayBeCalledAnything) {
  for (const char* name : {"time", "draw_index", " x", "-", "a/b"}) {
    json c = small_sid_case();
    c["record"]["channels"][1]["column"] = std::string(name) + " [m]";
    const Outcome ran = wheeltap(where, sid(c));
    EXPECT_EQ(ran.exit_code, 0) << name << ": " << ran.err;
  }
}

// Before: exit 70 after sampling.
TEST_F(HardInput, FoldersAndCasesMayBeCalledAnything) {
  json c = small_case();
  c.erase("title");
  where.write("Größe \xff\x1b[31m\n.json", c.dump());
  const auto quoted = [&](const char* name) { return "\"" + (where / name).string() + "\""; };
  const Outcome ran = wheeltap(where, "damage " + quoted("Größe \xff\x1b[31m\n.json") + " -o " +
                                          quoted("out \xfe\x1b[31m\n") + kShortest);
  EXPECT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_FALSE(io::first_unprintable(ran.out + ran.err, "\n")) << io::printable(ran.out + ran.err);
  const auto folder = where / "out \xfe\x1b[31m\n";
  EXPECT_TRUE(std::filesystem::exists(folder / "posterior.nc"));
  EXPECT_EQ(json::parse(read_all(folder / "summary.json"))["title"], "Größe \\xff\\x1b[31m\\n");
}

// Before: the escape sequence coloured the terminal; the newline forged a second message.
TEST_F(HardInput, NothingOfACaseReachesTheTerminalRaw) {
  json c = small_case();
  c["title"] = "a\x1b[31mb\nwheeltap: done";
  expect_refusal(damage(c), 65, "/title: ");
  c = small_case();
  c["beam"]["a\x1b[31mb\nwheeltap: done"] = 1;
  expect_refusal(damage(c), 65, "/beam/a\\x1b[31mb\\nwheeltap: done");
  c = small_case();
  c["predictor"] = {{"table", "no\x1b[31m.nc"}};
  expect_refusal(damage(c), 65, "/predictor/table");
  expect_refusal(damage(small_case(), "--set \"$(printf 'a\\033[31m')=1\""), 65, "\\x1b[31m");
  expect_refusal("damage \"$(printf 'no\\nsuch\\033[31m')\" -o /dev/null/x", 66,
                 "no\\nsuch\\x1b[31m");
  expect_refusal("\"$(printf 'no\\nsuch\\033[31m')\"", 64, "\\x1b[31m");
}

// Before: a crash; more than a minute.
TEST_F(HardInput, DeepAndWideJsonIsRefusedSoon) {
  const auto with = [&](const std::string& text) {
    return "damage " + where.write("deep.json", text).string() + " -o /dev/null/x";
  };
  const std::string open(100'000, '['), close(100'000, ']');
  expect_refusal(with(open + close), 65, "100 deep");
  expect_refusal(with("{\"kind\":\"damage\",\"title\":" + open + close + "}"), 65, "100 deep");
  expect_refusal(with(open), 65, "100 deep");
  std::string wide = "{\"kind\": \"damage\"";
  for (int i = 0; i < 200'000; ++i) wide += ",\"k" + std::to_string(i) + "\": 1";
  expect_refusal(with(wide + "}"), 65, "/k0: 1: unknown key");
}

// Before: did not end, or used all memory.
TEST_F(HardInput, PipesAndDevicesAreRefused) {
  ASSERT_EQ(::mkfifo((where / "pipe").c_str(), 0600), 0);
  expect_refusal("damage " + (where / "pipe").string() + " -o /dev/null/x", 66, "is a pipe");
  expect_refusal("damage /dev/zero -o /dev/null/x", 66, "is a device");
  for (const char* set :
       {R"(data={"file": "pipe", "cov": 0.01})", R"(predictor={"table": "pipe"})"}) {
    expect_refusal(damage(small_case(), std::string("--set '") + set + "'"), 66, "is a pipe");
  }
  expect_refusal(sid(small_sid_case(), "--set record.file=pipe"), 66, "is a pipe");
  expect_refusal(sid(small_sid_case(), "--set record.file=/dev/zero"), 66, "is a device");
}

// Before: exit 70, "mode 0 did not converge", "eigen decomposition failed".
TEST_F(HardInput, NumbersFromAnotherWorldAreTheCases) {
  for (const char* set :
       {"beam.material.young=1e300", "beam.material.young=1e-300", "beam.material.density=1e-308",
        "beam.material.density=1e300", "beam.section.width=1e-200", "beam.section.height=1e100"}) {
    expect_refusal(damage(small_case(), std::string("--set ") + set), 65, "/beam: ");
    expect_refusal("modes " + where.write_json("c.json", small_case()).string() + " --set " + set,
                   65, "/beam: ");
  }
}

// Before: a segmentation fault in the search of a starting point.
TEST_F(HardInput, ALogUniformPriorMayBeginNextToZero) {
  json c = small_sid_case();
  c["parameters"]["k"] = {{"log_uniform", {1e-320, 1}}};
  c["truth"]["parameters"]["k"] = 0.5;
  const Outcome ran = wheeltap(where, sid(c));
  EXPECT_EQ(ran.exit_code, 0) << ran.err;
}

// Before: exit 70, "support.stiffness = 0", if a draw of the prior underflowed.
TEST_F(HardInput, StiffnessesMayUnderflow) {
  for (const char* prior : {R"({"log_normal": [0, 1000]})", R"({"beta": [1e-5, 1e5]})",
                            R"({"half_normal": 1e-320})", R"({"gamma": [1e-300, 1]})"}) {
    json c = small_case();
    c["damage"] = {{"kind", "support"},
                   {"count", {{"min", 0}, {"max", 1}, {"prior", "uniform"}}},
                   {"location", {{"uniform", {0.0, 1.0}}}},
                   {"fix", {"deflection"}},
                   {"stiffness", json::parse(prior)}};
    const Outcome ran = wheeltap(where, damage(c));
    EXPECT_EQ(ran.exit_code, 0) << prior << ran.err;
  }
}

// Before: exit 70, "damage.reduction = nan", for the most extreme prior.
TEST_F(HardInput, PriorsMayReachFarIntoTheirTails) {
  for (const char* prior :
       {R"({"truncated_normal": [-1e10, 0.1, 0, 0.6]})",
        R"({"truncated_normal": [0, 0.001, 0.5, 0.6]})",
        R"({"truncated_normal": [1e300, 1e-300, 0, 0.6]})", R"({"beta": [1e-5, 1e5]})",
        R"({"beta": [1e5, 1e-5]})", R"({"uniform": [1e-320, 2e-320]})"}) {
    json c = small_case();
    c["damage"]["reduction"] = json::parse(prior);
    const Outcome ran = wheeltap(where, damage(c));
    EXPECT_TRUE(ran.exit_code == 0 || ran.exit_code == 65) << prior << ran.err;
  }
}

// Before: exit 70, "File name too long".
TEST_F(HardInput, NamesTooLongForAnyFileAreNoFaults) {
  const std::string name(300, 'k');
  expect_refusal("report " + name, 66, "too long");
  expect_refusal("damage " + name + " -o /dev/null/x", 66, "too long");
  expect_refusal(sid(small_sid_case(), "--set record.file=" + name), 66, "too long");
  expect_refusal(damage(small_case(), "--set predictor='{\"table\":\"" + name + "\"}'"), 66,
                 "no such file");
  expect_refusal("damage " + where.write_json("c.json", small_case()).string() + " -o " +
                     (where / name).string(),
                 73, "too long");
}

// Before: rejected, but after 11 s.
TEST_F(HardInput, TwentyDamagesOnEveryElementAreRefusedAtOnce) {
  json c = small_case();
  c["beam"]["elements"] = 100;
  c["damage"]["count"]["max"] = 20;
  for (const char* interpolation : {"multilinear", "monotone-cubic"}) {
    c["predictor"] = {{"sites", "every-element"},
                      {"multipliers", {0.4, 0.7, 1.0}},
                      {"interpolation", interpolation}};
    expect_refusal(damage(c), 65, "/predictor");
  }
}

// Before: 1e9 samples used all memory; 1e12 draws and 1e6 runs started.
TEST_F(HardInput, WhatNoMachineHoldsIsRefusedWithItsEstimate) {
  expect_refusal(sid(small_sid_case(), "--set truth.samples=1000000000"), 65, "GB of memory");
  const std::string many = "--chains 1000 --draws 1000000000";
  expect_refusal(
      "damage " + where.write_json("c.json", small_case()).string() + " -o /dev/null/x " + many, 65,
      "--max-memory allows 4 GB");
  expect_refusal(
      "sid " + where.write_json("s.json", small_sid_case()).string() + " -o /dev/null/x " + many,
      65, "--max-memory allows 4 GB");
  json c = small_sid_case();
  c["sweep"] = {{"path", "/models/0/noise"}, {"values", std::vector<double>(1'000'000, 0.05)}};
  expect_refusal(sid(c), 65, "/sweep: ");
  c = small_case();
  json kind = c["damage"];
  kind["count"]["max"] = 20;
  c["damage"] = json::array();
  for (const char* name : {"crack", "notch", "hole", "dent"}) {
    kind["name"] = name;
    c["damage"].push_back(kind);
  }
  expect_refusal(damage(c), 65, "would be 194481.0 models");
  c = small_case();
  c["beam"]["elements"] = 100;
  c["damage"]["count"]["max"] = 5;
  c["predictor"] = json::parse(R"({"sites": "every-element", "multipliers": [0.4, 1.0]})");
  expect_refusal(damage(c), 65, "/predictor: ");
  for (const char* limit : {"--max-memory nan", "--max-memory -1", "--max-hours 0"})
    expect_refusal(damage(small_case(), limit), 64, "must be a positive number");
  // A row is rejected for its size, at any position.
  c = small_sid_case();
  c["sweep"] = {{"path", "/truth/samples"}, {"values", {200, 300, 1'000'000'000, 200, 200, 200}}};
  expect_refusal(sid(c), 65, "/truth/samples: 1000000000: would take");
  // The user can raise the limits; a dry run is cheap.
  const Outcome asked =
      wheeltap(where, damage(small_case(), "--dry-run --max-memory 1e9 --max-hours 1e9"));
  EXPECT_EQ(asked.exit_code, 0) << asked.err;
  EXPECT_THAT(asked.out, HasSubstr("The run would take about"));
  EXPECT_FALSE(std::filesystem::exists(where / "out"));
  // No disk has space for the draws.
  expect_refusal("damage " + where.write_json("c.json", small_case()).string() + " -o " +
                     (where / "out").string() + " --max-memory 1e9 --max-hours 1e9 " + many,
                 73, "GB are free");
  expect_refusal(damage(small_case(), "--max-disk 0"), 64, "must be a positive number");
  expect_refusal("damage " + where.write_json("c.json", small_case()).string() + " -o " +
                     (where / "out").string() + " --max-memory 1e9 --max-hours 1e9 --max-disk 2 " +
                     many,
                 65, "--max-disk allows 2 GB");
}

// Before: with two runs into one folder, the second replaced the checkpoint of the first, which
// could not be resumed.
TEST_F(HardInput, AFolderIsWrittenByOneRunAtATime) {
  std::filesystem::create_directory(where / "out");
  const auto other = io::FileLock::take(where / "out");
  ASSERT_TRUE(other);
  expect_refusal(damage(small_case()), 73, "another run is writing into this folder");
  expect_refusal(sid(small_sid_case()), 73, "another run is writing into this folder");
  EXPECT_TRUE(std::filesystem::is_empty(where / "out"));
}

// Before: exit 70 and out-of-bounds reads, for an edited summary.
TEST_F(HardInput, EditedSummariesAreNotBelieved) {
  const std::string out = (where / "out").string();
  ASSERT_EQ(wheeltap(where, damage(small_case())).exit_code, 0);
  const json kept = json::parse(read_all(where / "out/summary.json"));
  std::vector<std::string> places;
  const json flat = kept.flatten();
  for (const auto& [place, ignored] : flat.items()) {
    if (place.find("/case/") == std::string::npos && place.find("/by_element") == std::string::npos)
      places.push_back(place);
  }
  std::size_t tried = 0;
  for (std::size_t p = 0; p < places.size(); p += 1 + places.size() / 40) {
    for (const json& value : {json(), json(-1), json("x"), json::array(), json::object()}) {
      json edited = kept;
      edited[json::json_pointer(places[p])] = value;
      where.write("out/summary.json", edited.dump());
      const int code = wheeltap(where, "report " + out).exit_code;
      EXPECT_TRUE(code == 0 || code == 65) << places[p] << " = " << value << ": " << code;
      ++tried;
    }
  }
  EXPECT_GT(tried, 100U);
  for (const json& sweep :
       {json{{"path", "/a"}}, json{{"path", "/a"}, {"rows", json::array()}},
        json{{"path", "/a"}, {"rows", {1}}},
        json{{"path", "/a"}, {"rows", {{{"value", 1}, {"models", json::array()}}}}}}) {
    for (const bool answered : {true, false}) {
      json edited = kept;
      edited["sweep"] = sweep;
      if (!answered) edited.erase("answer");
      where.write("out/summary.json", edited.dump());
      const Outcome drawn = wheeltap(where, "report " + out);
      EXPECT_TRUE(drawn.exit_code == 0 || drawn.exit_code == 65) << sweep << drawn.err;
    }
  }
}

// Before: "<root>[data][modes]".
TEST_F(HardInput, RefusalsNamePlacesOneWay) {
  for (const char* set : {"data.modes=0.5", "damage.count.max=[]", "beam.elements=1e999",
                          "data.frequencies=[]", "balance=2", "title=3"}) {
    const Outcome outcome =
        wheeltap(where, damage(small_case(), std::string("--set '") + set + "'"));
    EXPECT_EQ(outcome.exit_code, 65) << set;
    EXPECT_THAT(outcome.err, Not(HasSubstr("<root>"))) << set;
  }
}

}  // namespace
}  // namespace wheeltap::apps
