#include "apps/cases/syntax/case_file.hpp"

#include <gmock/gmock.h>

#include "program.hpp"

namespace wheeltap::apps {
namespace {

using testing::HasSubstr;

// The error message of a case, or "" for a valid case.
std::string complaint(const Json& input, Exit expected = Exit::bad_input) {
  const Workspace where;
  try {
    CaseFile file = read_case(where.write_json("c.json", input));
    validate_against_schema(file, "damage");
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.exit(), expected);
    EXPECT_EQ(std::string(failure.what()).find('\n'), std::string::npos) << "one line";
    return failure.what();
  }
  return "";
}

std::string reading(const std::string& text, const std::vector<std::string>& overrides = {},
                    Exit expected = Exit::bad_input) {
  const Workspace where;
  try {
    (void)read_case(where.write("c.json", text), overrides);
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.exit(), expected);
    EXPECT_EQ(std::string(failure.what()).find('\n'), std::string::npos) << "one line";
    return failure.what();
  }
  return "";
}

TEST(CaseFile, AcceptsAGoodCase) {
  EXPECT_EQ(complaint(small_case()), "");
}

// Fault: 4294967297 modes were read as one.
TEST(CaseFile, MayNameItsSchemaAndTheVersionOfItsFormat) {
  Json input = small_case();
  input["$schema"] = "damage.schema.json";
  input["format"] = 1;
  EXPECT_EQ(complaint(input), "");
  input["format"] = 2;
  EXPECT_THAT(complaint(input), HasSubstr("c.json: /format: 2: "));
  input["format"] = 1;
  input["$schema"] = 7;
  EXPECT_THAT(complaint(input), HasSubstr("/$schema: 7: "));
}

TEST(CaseFile, WholeNumbersBeyondWhatIsCountedWithAreRefused) {
  Json input = small_case();
  input["data"]["modes"] = 4294967297;
  EXPECT_THAT(complaint(input), HasSubstr("/data/modes: 4294967297: must be"));
  input["data"]["modes"] = 3;
  input["data"]["seed"] = 9223372036854775807;
  EXPECT_EQ(complaint(input), "") << "seeds have 63 bits";
  input["data"]["seed"] = 18446744073709551615ULL;
  EXPECT_THAT(complaint(input), HasSubstr("/data/seed: 18446744073709551615: must be"));
}

// Fault: the validator rejected 3.0, at "<root>[data][modes]".
TEST(CaseFile, WholeNumbersMayBeWrittenWithAPoint) {
  Json input = small_case();
  input["data"]["modes"] = 3.0;
  input["damage"]["count"]["max"] = 2.0;
  EXPECT_EQ(complaint(input), "");
  const Workspace where;
  CaseFile file = read_case(where.write_json("c.json", input));
  validate_against_schema(file, "damage");
  EXPECT_TRUE(file.json["data"]["modes"].is_number_integer());
  EXPECT_TRUE(file.json["beam"]["length"].is_number_float()) << "is no whole number";
  input["data"]["modes"] = 3.5;
  EXPECT_THAT(complaint(input),
              HasSubstr("/data/modes: 3.5: must be the number of modes to simulate"));
  input["data"]["modes"] = 1e30;
  EXPECT_THAT(complaint(input), HasSubstr("/data/modes: 1e+30: must be <= 2147483647"));
}

// Fault: an escape sequence in a title reached the terminal, and a Latin-1 byte ended the program
// when it wrote its run.
TEST(CaseFile, TextsThatMayNotBePrintedAreRefused) {
  EXPECT_THAT(reading(R"({"title": "a\u001b[31mb"})"), HasSubstr("/title: "));
  EXPECT_THAT(reading(R"({"notes": "two\nlines"})"), testing::IsEmpty());
  EXPECT_THAT(reading(R"({"notes": "a\u0007"})"), HasSubstr("control character"));
  EXPECT_THAT(reading(R"({"a\nwheeltap: done": 1})"), HasSubstr("a key contains a control"));
  EXPECT_THAT(reading("{}", {"title=a\xff"}), HasSubstr("/title: "));
  EXPECT_THAT(reading("{}", {"title=" + std::string(5000, 'x')}), HasSubstr("at most 4096"));
}

// Fault: a nesting of 60 000 keys overflowed the stack.
TEST(CaseFile, OverridesAreNotFollowedWithoutEnd) {
  std::string path = "a";
  for (int i = 0; i < 1000; ++i) path += ".a";
  EXPECT_THAT(reading("{}", {path + "=1"}, Exit::usage), HasSubstr("keys deep"));
  EXPECT_THAT(reading("{}", {"a=" + std::string(1000, '[') + std::string(1000, ']')}),
              HasSubstr("100 deep"));
}

TEST(CaseFile, NamesLineAndColumnOfASyntaxError) {
  EXPECT_THAT(reading("{\n  \"a\": 1,\n  \"b\" 2\n}"), HasSubstr("c.json:3:7: not JSON"));
  EXPECT_THAT(reading("{\"a\": [1, NaN]}"), HasSubstr("null for a mode not measured"));
  EXPECT_THAT(reading(""), HasSubstr("c.json:1:1: not JSON"));
  EXPECT_THAT(reading("[1]"), HasSubstr("must be an object"));
}

TEST(CaseFile, RefusesAKeyThatStandsTwice) {
  EXPECT_THAT(reading(R"({"a": {"b": 1, "b": 2}})"), HasSubstr("\"b\" is used twice"));
  EXPECT_EQ(reading(R"({"a": {"b": 1}, "c": {"b": 2}})"), "");
}

TEST(CaseFile, RefusesNumbersBeyondDoublePrecision) {
  EXPECT_THAT(reading(R"({"a": 1e999})"), HasSubstr("too large"));
}

TEST(CaseFile, MissingFileHasItsOwnExitCode) {
  try {
    (void)read_case("/no/such/file.json");
    FAIL();
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.exit(), Exit::no_input);
    EXPECT_THAT(failure.what(), HasSubstr("/no/such/file.json"));
  }
}

TEST(CaseFile, OverridesReachAnywhere) {
  const Workspace where;
  const auto file = read_case(where.write_json("c.json", small_case()),
                              {"beam.length=2.5", "data.frequencies.1=60", "title=Two words",
                               "damage.location={\"beta\": [2, 2]}", "new.deep.key=true"});
  EXPECT_EQ(file.json["beam"]["length"], 2.5);
  EXPECT_EQ(file.json["data"]["frequencies"][1], 60);
  EXPECT_EQ(file.json["title"], "Two words");
  EXPECT_EQ(file.json["damage"]["location"]["beta"][0], 2);
  EXPECT_EQ(file.json["new"]["deep"]["key"], true);
}

TEST(CaseFile, OverridesThatLeadNowhereAreUsageErrors) {
  EXPECT_THAT(reading("{\"a\": [1, 2]}", {"a.7=3"}, Exit::usage), HasSubstr("list of 2"));
  EXPECT_THAT(reading("{}", {"a"}, Exit::usage), HasSubstr("path.to.key=VALUE"));
}

TEST(CaseFile, SuggestsTheNearestKey) {
  Json input = small_case();
  input["beam"]["lenght"] = 1.0;
  EXPECT_THAT(complaint(input), HasSubstr("/beam/lenght"));
  EXPECT_THAT(complaint(input), HasSubstr("\"length\" is given already: remove this key"));
  input["beam"].erase("length");
  EXPECT_THAT(complaint(input), HasSubstr("did you mean \"length\"?"));
  input = small_case();
  input["zzz"] = 1;
  EXPECT_THAT(complaint(input), HasSubstr("/zzz"));
  EXPECT_THAT(complaint(input),
              HasSubstr("allowed here: $schema, balance, baseline, beam, damage, data"));
}

TEST(CaseFile, NamesPlaceValueAndBound) {
  Json input = small_case();
  input["beam"]["length"] = -1.0;
  EXPECT_THAT(complaint(input), HasSubstr("/beam/length: -1.0: must be > 0"));
  input = small_case();
  input["beam"]["material"]["poisson"] = 0.5;
  EXPECT_THAT(complaint(input), HasSubstr("/beam/material/poisson: 0.5: must be < 0.5"));
  input = small_case();
  input["beam"]["material"].erase("young");
  EXPECT_THAT(complaint(input), HasSubstr("/beam/material/young: is missing"));
  input = small_case();
  input["data"]["frequencies"][1] = "NaN";
  EXPECT_THAT(complaint(input),
              HasSubstr("/data/frequencies/1: \"NaN\": must be a frequency in Hz, or null"));
  input = small_case();
  input["beam"]["supports"] = "simply supported";
  EXPECT_THAT(complaint(input), HasSubstr("/beam/supports"));
  EXPECT_THAT(complaint(input), HasSubstr("clamped-pinned"));
  input = small_case();
  input["damage"]["count"]["prior"] = Json{{"poison", 1.0}};
  EXPECT_THAT(complaint(input), HasSubstr("did you mean \"poisson\"?"));
  input = small_case();
  input["damage"]["location"] = 3;
  EXPECT_THAT(complaint(input), HasSubstr("/damage/location: 3: must be a prior"));
  input = small_case();
  input["kind"] = "sid";
  EXPECT_THAT(complaint(input), HasSubstr("/kind: \"sid\": must be \"damage\""));
  input.erase("beam");
  EXPECT_THAT(complaint(input), HasSubstr("the command for this case is `wheeltap sid`"));
}

TEST(CaseFile, ReadsEveryFormOfPrior) {
  const Workspace where;
  const auto prior = [&](const char* text) {
    return parse_prior(read_case(where.write("c.json", std::string("{\"p\": ") + text + "}")),
                       Pointer("/p"));
  };
  EXPECT_EQ(prior(R"({"uniform": [1, 3]})").mean(), 2.0);
  EXPECT_EQ(prior(R"({"log_uniform": [1, 10]})").lower(), 1.0);
  EXPECT_EQ(prior(R"({"normal": [5, 2]})").sd(), 2.0);
  EXPECT_NEAR(prior(R"({"log_normal": [0, 0.5]})").mean(), std::exp(0.125), 1e-12);
  EXPECT_NEAR(prior(R"({"half_normal": 2})").mean(), 2.0 * std::sqrt(2.0 / M_PI), 1e-12);
  EXPECT_NEAR(prior(R"({"gamma": [3, 2]})").mean(), 6.0, 1e-12);
  EXPECT_NEAR(prior(R"({"beta": [2, 2]})").mean(), 0.5, 1e-12);
  EXPECT_NEAR(prior(R"({"beta": [2, 2], "on": [1, 5]})").mean(), 3.0, 1e-12);
  EXPECT_EQ(prior(R"({"truncated_normal": [0, 1, -1, 2]})").upper(), 2.0);
  EXPECT_NEAR(prior(R"({"inverse_gamma": [3, 2]})").mean(), 1.0, 1e-12);
  EXPECT_NEAR(prior(R"({"student_t": [4, 1, 2]})").sd(), 2.0 * std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(prior(R"({"table": {"x": [0, 1, 2], "density": [0, 5, 0]}})").mean(), 1.0, 1e-9);
  EXPECT_THROW((void)prior(R"({"uniform": [3, 1]})"), Failure);
  EXPECT_THROW((void)prior(R"({"normal": [0, -1]})"), Failure);
  EXPECT_THROW((void)prior(R"({"uniform": [0, 1], "normal": [0, 1]})"), Failure);
  EXPECT_THROW((void)prior(R"({"uniform": [0, 1], "on": [0, 1]})"), Failure);
  EXPECT_THROW((void)prior(R"({"student_t": [0, 1, 2]})"), Failure);
  EXPECT_THROW((void)prior(R"({"table": {"x": [0, 1, 1], "density": [0, 5, 0]}})"), Failure);
}

TEST(CaseFile, SchemaIsCompleteByItself) {
  const Json damage = schema("damage");
  EXPECT_TRUE(damage["definitions"].contains("prior"));
  EXPECT_TRUE(damage["definitions"].contains("beam"));
  EXPECT_THROW((void)schema("common"), Failure);
}

}  // namespace
}  // namespace wheeltap::apps
