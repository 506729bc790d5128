#include "apps/cases/sid_case.hpp"

#include <gmock/gmock.h>

#include "identification/sid/sid_record.hpp"
#include "identification/sid/sid_simulation.hpp"
#include "identification/sid/sid_units.hpp"
#include "sid_cases.hpp"
#include "signals/excitation.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

using nlohmann::json;
using testing::AllOf, testing::HasSubstr;

/// The error message of parsing `c`, which must have this exit code.
std::string refusal(const Workspace& where, const json& c, Exit exit = Exit::bad_input) {
  try {
    static_cast<void>(parse_sid(where, c));
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.exit(), exit) << failure.what();
    return failure.what();
  }
  return "not refused";
}

json with(const char* pointer, const json& value) {
  json c = small_sid_case();
  c[json::json_pointer(pointer)] = value;
  return c;
}

json from_file(const std::string& name) {
  json c = small_sid_case();
  c.erase("truth");
  c["record"]["file"] = name;
  return c;
}

TEST(SidCase, EveryShippedCaseParsesAndSimulates) {
  int cases = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(WHEELTAP_DATA) / "sid")) {
    if (entry.path().extension() != ".json") continue;
    ++cases;
    const SidCaseFile parsed = parse_sid_case(read_case(entry.path()));
    EXPECT_TRUE(parsed.sid.simulated) << entry.path();
    EXPECT_GT(parsed.sid.end, 0) << entry.path();
    EXPECT_FALSE(parsed.notes.empty()) << entry.path();
  }
  EXPECT_GE(cases, 20);
}

TEST(SidCase, ParametersBelongToTheModelsThatUseThem) {
  const Workspace where;
  const SidCase c = parse_sid(where, small_sid_case()).sid;
  ASSERT_EQ(c.parameters.size(), 2U);
  EXPECT_EQ(c.models[0].parameters, std::vector<int>{0});
  EXPECT_EQ(c.models[1].parameters, (std::vector<int>{0, 1}));
  EXPECT_EQ(c.responses().size(), 1U);
  EXPECT_DOUBLE_EQ(c.sample_rate_hz, 100.0);
  EXPECT_EQ(c.end - c.begin, 200);
}

// An inferred initial state adds parameters, and so do autocorrelations.
TEST(SidCase, InferredStatesAndCorrelationsAreParameters) {
  const Workspace where;
  json c = small_sid_case();
  c["residuals"] = {{"ar", 1}};
  c["record"]["initial"] = "inferred";
  const SidCase parsed = parse_sid(where, c).sid;
  std::vector<std::string> names;
  for (const int p : parsed.models[0].parameters) {
    names.push_back(parsed.parameters[static_cast<std::size_t>(p)].name);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"k", "ar[1]", "y0[1]", "v0[1]"}));
}

TEST(SidCase, AnOrderLeftOpenIsNotYetParameters) {
  const Workspace where;
  const SidCase open = parse_sid(where, with("/residuals", {{"ar", "auto"}})).sid;
  EXPECT_NE(open.models[0].residuals.chosen_kind, nullptr);
  EXPECT_TRUE(open.models[0].residuals.model->is_white());
  const SidResiduals given =
      parse_sid(where, with("/residuals", {{"ar", 2}})).sid.models[0].residuals;
  EXPECT_EQ(given.chosen_kind, nullptr);
  EXPECT_EQ(given.model->value(), 2);
  EXPECT_THAT(refusal(where, with("/residuals", {{"ar", "best"}})), HasSubstr("/residuals/ar"));
  EXPECT_THAT(refusal(where, with("/residuals", {{"ar", 21}})), HasSubstr("/residuals/ar"));
}

TEST(SidCase, WindowsMustHoldMoreSamplesThanUnknowns) {
  const Workspace where;
  EXPECT_EQ(parse_sid(where, small_sid_case()).sid.windows, 0);
  EXPECT_EQ(parse_sid(where, with("/windows", 8)).sid.windows, 8);
  EXPECT_THAT(refusal(where, with("/windows", 1)), HasSubstr("/windows"));
  EXPECT_THAT(refusal(where, with("/windows", 100)),
              HasSubstr("/windows: 100: gives windows of 2 samples; model \"duffing\" has 2"));
}

/// The case with its record twice, the second changed by `second`.
json two_records(const std::function<void(json&)>& second = {}) {
  json c = small_sid_case();
  c["records"] = {c["record"], c["record"]};
  c.erase("record");
  if (second) second(c["records"][1]);
  return c;
}

// Records have separate windows and initial states, and common physical parameters.
TEST(SidCase, SeveralRecordsShareTheirParameters) {
  const Workspace where;
  const SidCase c = parse_sid(where, two_records([](json& r) {
                                r["samples"] = {50, 150};
                                r["initial"] = "inferred";
                              }))
                        .sid;
  ASSERT_EQ(c.further.size(), 1U);
  EXPECT_EQ(c.further[0].begin, 50);
  EXPECT_EQ(c.end, 200);
  std::vector<std::string> names;
  for (const auto& parameter : c.parameters) names.push_back(parameter.name);
  EXPECT_EQ(names, (std::vector<std::string>{"k", "k3", "y0[1]@2", "v0[1]@2"}));
  EXPECT_EQ(c.models[0].parameters, (std::vector<int>{0, 2, 3}));
  EXPECT_EQ(c.further[0].models[0].parameters, c.models[0].parameters);
  EXPECT_TRUE(c.models[0].initial.displacement.empty());
  // The two simulations are different.
  EXPECT_NE(c.channels[1].signal.samples[60], c.further[0].channels[1].signal.samples[10]);
}

TEST(SidCase, NamesThePlaceOfAMistakeInOneOfSeveralRecords) {
  const Workspace where;
  EXPECT_THAT(refusal(where, two_records([](json& r) {
                        r["samples"] = {0, 201};
                      })),
              HasSubstr("/records/1/samples: [0,201]"));
  EXPECT_THAT(refusal(where, two_records([](json& r) { r["channels"][1]["mass"] = 2; })),
              HasSubstr("/records/1/channels/1/mass: 2"));
  json both = two_records();
  both["record"] = both["records"][0];
  EXPECT_THAT(refusal(where, both), HasSubstr("/records: "));
  json neither = two_records();
  neither.erase("records");
  EXPECT_THAT(refusal(where, neither), HasSubstr("/record: is missing"));
  json unused = two_records();
  unused["parameters"]["scale"] = {{"log_uniform", {0.5, 2.0}}};
  EXPECT_THAT(refusal(where, unused), HasSubstr("/parameters/scale"));
  unused["truth"]["parameters"]["scale"] = 1.0;
  unused["records"][1]["channels"][1]["scale"] = "scale";  // use in one record is sufficient
  EXPECT_EQ(parse_sid(where, unused).sid.parameters.size(), 3U);
}

TEST(SidCase, TheSchemaKnowsEveryLaw) {
  const json properties = schema("sid")["definitions"]["link"]["properties"];
  for (const auto& info : dynamics::law_infos()) {
    EXPECT_TRUE(properties.contains(std::string(info.name))) << info.name;
  }
}

// Issue 14, finding 3: "coulomb": 3 was read as friction with an undocumented regularisation
// velocity of 1 mm/s. Friction without a velocity is exact, as a number or as a parameter.
TEST(SidCase, FrictionIsExactUnlessAVelocityIsGiven) {
  const Workspace where;
  const auto law = [&](const json& coulomb) {
    json c = with("/models/1/links/0/coulomb", coulomb);
    c["parameters"]["F"] = {{"uniform", {0, 1}}};
    c["parameters"]["v"] = {{"uniform", {0, 1}}};
    c["models"][0]["links"][0]["coulomb"] = {{"force", "F"}, {"velocity", "v"}};  // uses both
    c["truth"]["parameters"]["F"] = 0.5;
    c["truth"]["parameters"]["v"] = 0.1;
    return parse_sid(where, c).sid.models[1].chain.links[0].laws.back();
  };
  for (const json& coulomb : {json(3), json("F"), json({{"force", 3}}), json({{"force", "F"}}),
                              json({{"force", 3}, {"velocity", 0}})}) {
    EXPECT_TRUE(dynamics::is_dry(law(coulomb))) << coulomb;
    EXPECT_EQ(law(coulomb).coefficients[0].is_constant(),
              coulomb.dump().find('F') == std::string::npos);
  }
  EXPECT_EQ(law(3).coefficients[0].value, 3.0);
  EXPECT_FALSE(dynamics::is_dry(law({{"force", 3}, {"velocity", 1e-3}})));
  EXPECT_FALSE(dynamics::is_dry(law({{"force", 3}, {"velocity", "v"}})));
  EXPECT_THAT(refusal(where, with("/models/1/links/0/coulomb", -3)),
              AllOf(HasSubstr("/models/1/links/0/coulomb: -3"), HasSubstr("at least 0")));
}

TEST(SidCase, NamesThePlaceOfEveryMistake) {
  const Workspace where;
  const auto expect = [&](const json& c, std::initializer_list<const char*> words) {
    const std::string text = refusal(where, c);
    for (const char* word : words) EXPECT_THAT(text, HasSubstr(word));
  };
  expect(with("/models/0/links/0/stiffness", "kk"),
         {"/models/0/links/0/stiffness", "\"kk\"", "k, k3"});
  expect(with("/parameters/unused", {{"uniform", {0, 1}}}), {"/parameters/unused", "not used"});
  json negative = with("/parameters/m", {{"normal", {0.5, 0.1}}});
  negative["models"][0]["masses"][0] = "m";
  expect(negative, {"/parameters/m", "/models/0/masses/0", "positive"});
  expect(with("/models/1/masses/0", -1), {"/models/1/masses/0", "-1", "positive"});
  expect(with("/models/1/noise", 0), {"/models/1/noise", "positive"});
  expect(with("/models/1/noise", {0.1, 0.1}),
         {"/models/1/noise", "one value per response channel"});
  expect(with("/models/1/name", "linear"), {"/models/1/name", "two models"});
  expect(with("/models/1/links/0/between", {0, 2}),
         {"/models/1/links/0/between/1", "masses 1 to 1"});
  expect(with("/models/1/links/0/between", {1, 1}), {"/between", "two different masses"});
  expect(with("/models/1/links/0/cubbic", 1), {"/models/1/links/0/cubbic", "\"cubic\""});
  expect(with("/models/1/links/0/contact", {{"stiffness", 1}}), {"/contact/gap", "missing"});
  expect(with("/models/1/links/0/bilinear", {{"stiffness", 1}}), {"/bilinear/side", "closing"});
  expect(with("/models/1/links/0/contact", {{"stiffness", 1}, {"gap", -1e-3}, {"side", "closing"}}),
         {"/contact/gap", ">= 0", "[m]"});
  const json hysteresis = {{"stiffness", 1}, {"yield", 0.1}, {"exponent", 0.5}};
  expect(with("/models/1/links/0/bouc_wen", hysteresis), {"/bouc_wen/exponent", ">= 1"});
  json reaching = with("/models/1/links/0/bouc_wen", hysteresis);
  reaching["models"][1]["links"][0]["bouc_wen"]["exponent"] = "n";
  reaching["parameters"]["n"] = {{"uniform", {0.5, 3}}};
  expect(reaching, {"/parameters/n", "reaches down to 0.5", "/bouc_wen/exponent", "at least 1"});
  expect(with("/record/channels/1/mass", 2), {"/record/channels/1/mass", "masses 1 to 1"});
  expect(with("/record/channels/0/role", "ignore"), {"/record/channels/0/mass"});
  expect(with("/record/samples", {0, 201}), {"/record/samples", "[0,201]", "200 samples"});
  expect(with("/record/samples", {10, 10}), {"/record/samples", "[first, one past the last]"});
  expect(with("/record/lead_in", 5), {"/record/lead_in", "0 samples"});
  expect(with("/record/sample_rate", 50), {"100 Hz", "50 Hz"});
  expect(with("/truth/model", "cubic"), {"/truth/model", "linear, duffing"});
  expect(with("/truth/parameters/q", 1), {"/truth/parameters/q"});
  expect(with("/truth/excitation/0/kind", "sine"), {"/truth/excitation/0/amplitude", "missing"});
  expect(with("/parameters/k", {{"uniform", {5, 1}}}), {"/parameters/k/uniform"});
}

// Issue 14, finding 3: laws were documented by error messages only. Every malformed entry gives one
// line with the place, the allowed values, and the command that explains the law.
TEST(SidCase, MalformedLawsAreToldWhatIsAllowed) {
  const Workspace where;
  const std::string link = "/models/1/links/0/";
  const auto expect = [&](const char* law, const json& entry,
                          std::initializer_list<const char*> words) {
    const std::string text = refusal(where, with((link + law).c_str(), entry));
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    EXPECT_THAT(text, HasSubstr(link + law));
    for (const char* word : words) EXPECT_THAT(text, HasSubstr(word));
  };
  const json stop = {{"stiffness", 1}, {"gap", 0.1}, {"side", "closing"}};
  // Unknown keys, and a side for a law without sides.
  expect("contact", {{"stiffnes", 1}, {"gap", 0.1}, {"side", "closing"}},
         {"/stiffnes", "did you mean \"stiffness\"?", "gap, side, stiffness",
          "wheeltap laws contact"});
  expect("cubic", {{"stiffness", 1}, {"side", "closing"}}, {"/side", "(allowed here: stiffness)"});
  expect("friction", 3, {"unknown key", "coulomb", "`wheeltap laws` explains"});
  // Missing coefficients and sides.
  expect("coulomb", {{"velocity", 0.1}}, {"/force", "is missing", "[N]"});
  expect("contact", {{"stiffness", 1}, {"side", "closing"}}, {"/gap", "is missing", "[m]"});
  expect("bouc_wen", {{"stiffness", 1}}, {"/yield", "is missing", "[m]"});
  expect("bilinear", {{"stiffness", 1}}, {"/side", "is missing", "opening", "closing"});
  expect("coulomb", json::object(), {"/force", "is missing"});
  // Wrong types of the law, of a coefficient, of the side, and in a list.
  expect("coulomb", true, {"force [N]", "an object with force [N], velocity [m/s]", "or a list"});
  expect("coulomb", nullptr, {"force [N]"});
  expect("contact", 3, {"must be an object with stiffness [N/m], gap [m] and side"});
  expect("contact", "g", {"must be an object with stiffness [N/m], gap [m] and side"});
  expect("coulomb", {{"force", {1, 2}}}, {"/force", "a number or a parameter's name"});
  expect("bilinear", {{"stiffness", 1}, {"side", "left"}}, {"/side", "\"opening\", \"closing\""});
  expect("contact", json::array(), {"at least one"});
  expect("contact", {stop, 3}, {"/contact/1", "must be an object"});
  expect("contact", {stop, {{"stiffness", 1}}}, {"/contact/1/", "is missing"});
  expect("coulomb", json::array({json::array({3})}), {"/coulomb/0", "force [N]"});
  // Values out of bounds, and unknown names.
  expect("contact", {{"stiffness", 1}, {"gap", -1e-3}, {"side", "closing"}},
         {"/gap", "-0.001", ">= 0"});
  expect("bouc_wen", {{"stiffness", 1}, {"yield", 0}}, {"/yield", "> 0"});
  expect("coulomb", "F", {"no parameter has this name", "k, k3"});
  // Valid entries.
  for (const auto& [law, entry] :
       std::initializer_list<std::pair<const char*, json>>{{"contact", stop},
                                                           {"contact", {stop, stop}},
                                                           {"coulomb", 3},
                                                           {"coulomb", {3, {{"force", 1}}}}}) {
    EXPECT_EQ(refusal(where, with((link + law).c_str(), entry)), "not refused") << entry;
  }
}

TEST(SidCase, NamesLineAndColumnOfDamagedRecords) {
  const Workspace where;
  const std::string header = "time [s],force [N],displacement [m]\n";
  const auto rows = [&](int n, const auto& row) {
    std::string text = header;
    for (int i = 0; i < n; ++i) text += row(i);
    where.write("record.csv", text);
    return refusal(where, from_file("record.csv"));
  };
  const auto good = [](int i) {
    return std::to_string(0.01 * i) + (i % 2 == 0 ? ",1,2\n" : ",1,1\n");
  };
  EXPECT_EQ(rows(150, good), "not refused");
  EXPECT_THAT(rows(150, [&](int i) { return i == 4 ? "0.04,1\n" : good(i); }),
              HasSubstr("record.csv, line 6: 2 columns, must be 3"));
  EXPECT_THAT(rows(150, [&](int i) { return i == 4 ? "nan,1,2\n" : good(i); }),
              HasSubstr("record.csv, line 6, column 1"));
  EXPECT_THAT(rows(150, [&](int i) { return i == 4 ? "0.04,,2\n" : good(i); }),
              HasSubstr("record.csv, line 6, column 2"));
  EXPECT_THAT(rows(150, [&](int i) { return i == 4 ? std::string() : good(i); }),
              HasSubstr("record.csv, line 6"));
  // Times with few digits, and one row short.
  EXPECT_THAT(
      rows(150, [&](int i) { return i == 4 ? std::string() : good(i).substr(0, 4) + ",1,2\n"; }),
      HasSubstr("same step everywhere"));
  EXPECT_THAT(refusal(where, from_file("none.csv"), Exit::no_input), HasSubstr("none.csv"));
  json c = from_file("record.csv");
  where.write("record.csv", header + "0,1,2\n0.01,1,2\n0.02,1,2\n0.03,1,2\n");
  c["record"]["channels"][0]["column"] = "forze";
  EXPECT_THAT(refusal(where, c),
              testing::AllOf(HasSubstr("/record/channels/0/column"), HasSubstr("force [N]")));
}

// Fault: a column used twice counted its data, or its force, twice.
TEST(SidCase, DataThatWouldCountTwiceAreRefused) {
  const Workspace where;
  std::string text = "force [N],other [N],d [m],copy [mm],velocity [m/s]\n";
  for (int i = 0; i < 150; ++i) {
    const double d = std::sin(0.7 * i) + std::cos(0.31 * i * i);
    text += json(std::cos(0.2 * i)).dump() + "," + json(std::cos(0.3 * i)).dump() + "," +
            json(d).dump() + "," + json(1000.0 * d + 5.0).dump() + "," + json(d).dump() + "\n";
  }
  where.write("record.csv", text);
  json c = from_file("record.csv");
  c["record"]["sample_rate"] = 100;
  c["record"]["initial"] = "rest";
  const json force = {{"column", "force"}, {"role", "force"}, {"mass", 1}};
  const json response = {
      {"column", "d"}, {"role", "response"}, {"mass", 1}, {"quantity", "displacement"}};
  const auto said = [&](json third, const char* column) {
    third["column"] = column;
    c["record"]["channels"] = {force, response, third};
    return refusal(where, c);
  };
  const std::string twice = "/record/channels/2/column: ";
  EXPECT_THAT(said(response, "d"), AllOf(HasSubstr(twice), HasSubstr("response of mass 1")));
  EXPECT_THAT(said(response, "3"), AllOf(HasSubstr(twice), HasSubstr("in channel 1")));
  EXPECT_THAT(said(response, "copy"), AllOf(HasSubstr(twice), HasSubstr("equals channel 1")));
  EXPECT_THAT(said(force, "force [N]"), AllOf(HasSubstr(twice), HasSubstr("force on mass 1")));
  EXPECT_EQ(said(force, "other"), "not refused");
  json other = response;
  other["quantity"] = "velocity";
  EXPECT_EQ(said(other, "velocity"), "not refused");
}

/// A record of 150 rows: 0.01 s, 2 N and about 3 mm per row (exactly in row 7), in the units of the
/// header.
json from_units(const Workspace& where, const std::string& header, double time, double force,
                double displacement) {
  std::string text = header + "\n";
  for (int i = 0; i < 150; ++i) {
    text += json(time * i).dump() + "," + json(force).dump() + "," +
            json(displacement * (1.0 + 0.1 * std::sin(0.1 * (i - 7)))).dump() + "\n";
  }
  static_cast<void>(where.write("record.csv", text));
  json c = from_file("record.csv");
  c["record"]["channels"][0]["column"] = "force";
  c["record"]["channels"][1]["column"] = "displacement";
  c["record"]["initial"] = "rest";
  return c;
}

// Fault: a column "time [ms]" was read as seconds.
TEST(SidCase, TimeInMillisecondsIsNotReadAsSeconds) {
  const Workspace where;
  json c = from_units(where, "time [ms],force [N],displacement [m]", 10, 2, 0.003);
  EXPECT_DOUBLE_EQ(parse_sid(where, c).sid.sample_rate_hz, 100.0);
  c["record"]["channels"].push_back({{"column", "time"}, {"role", "time"}});
  EXPECT_DOUBLE_EQ(parse_sid(where, c).sid.sample_rate_hz, 100.0);
  c["record"]["channels"][2]["scale"] = 1e-6;
  EXPECT_DOUBLE_EQ(parse_sid(where, c).sid.sample_rate_hz, 1e5) << "the case's scale wins";
  c["record"]["channels"][2]["scale"] = "k";
  EXPECT_THAT(refusal(where, c), HasSubstr("/record/channels/2/scale"));
  c = from_units(where, "time [ticks],force [N],displacement [m]", 10, 2, 0.003);
  EXPECT_THAT(refusal(where, c), testing::AllOf(HasSubstr("'ticks'"), HasSubstr("s, ms, us")));
  c["record"]["channels"].push_back({{"column", "time"}, {"role", "time"}, {"scale", 0.001}});
  EXPECT_DOUBLE_EQ(parse_sid(where, c).sid.sample_rate_hz, 100.0);
}

// Fault: kN and mm gave only a warning.
TEST(SidCase, KnownUnitsConvertWhereNoScaleIsGiven) {
  const Workspace where;
  const auto si = [](const SidChannel& channel) {
    return channel.signal.scale.value * channel.signal.samples[7];
  };
  json c = from_units(where, "time [s],force [kN],displacement [mm]", 0.01, 0.002, 3);
  const SidCaseFile converted = parse_sid(where, c);
  EXPECT_DOUBLE_EQ(si(converted.sid.channels[0]), 2.0);
  EXPECT_DOUBLE_EQ(si(converted.sid.channels[1]), 0.003);
  EXPECT_TRUE(record_remarks(converted.sid).empty());
  c["record"]["channels"][1]["scale"] = 2.0;
  EXPECT_DOUBLE_EQ(si(parse_sid(where, c).sid.channels[1]), 6.0) << "the case's scale wins";

  // Unknown units, or units of another quantity: reported once per channel, numbers unchanged.
  for (const char* unit : {"V", "N"}) {
    c = from_units(where, std::string("time [s],force [N],displacement [") + unit + "]", 0.01, 2,
                   3);
    const SidCaseFile warned = parse_sid(where, c);
    EXPECT_DOUBLE_EQ(si(warned.sid.channels[1]), 3.0);
    const auto remarks = record_remarks(warned.sid);
    ASSERT_EQ(remarks.size(), 1U);
    EXPECT_EQ(std::get<remark::UnknownUnits>(remarks[0]).channels.at(0).unit, unit);
  }
}

TEST(SidCase, AChannelSaysItsUnitWhereTheHeaderDoesNot) {
  const Workspace where;
  json c = from_units(where, "time [s],force,displacement [m]", 0.01, 0.002, 3);
  const auto channel = [&](std::size_t i) -> json& { return c["record"]["channels"][i]; };
  channel(0)["unit"] = "kN";
  channel(1)["unit"] = "mm";  // the unit of the case takes precedence over the header
  const SidCase converted = parse_sid(where, c).sid;
  EXPECT_DOUBLE_EQ(converted.channels[0].signal.scale.value, 1e3);
  EXPECT_DOUBLE_EQ(converted.channels[1].signal.scale.value, 1e-3);
  EXPECT_TRUE(record_remarks(converted).empty());
  // Units that cannot be converted are kept, labelled and reported: "V" may be intended, "KN" is a
  // mistake.
  channel(0)["unit"] = channel(1)["unit"] = "V";
  const SidCase volts = parse_sid(where, c).sid;
  EXPECT_EQ(volts.channels[1].used_unit(), "V");
  EXPECT_EQ(parameter_units(volts).at("k3"), "V/V^3");
  const auto remarks = record_remarks(volts);
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_EQ(std::get<remark::UnknownUnits>(remarks[0]).channels.size(), 2U);
  channel(0)["scale"] = 2.0;  // ambiguous: raw numbers or kilonewtons
  EXPECT_THAT(refusal(where, c), HasSubstr("/record/channels/0/unit"));
  channel(0).erase("scale");
  channel(1)["role"] = "ignore";
  channel(1).erase("mass");
  channel(1).erase("quantity");
  EXPECT_THAT(refusal(where, c), HasSubstr("/record/channels/1/unit"));
}

// A simulated record has the units of its headers.
TEST(SidCase, SimulatesInTheUnitsOfTheHeaders) {
  const Workspace where;
  json c = small_sid_case();
  const SidCase si = parse_sid(where, c).sid;
  c["record"]["channels"][0]["column"] = "force [mN]";
  c["record"]["channels"][1]["column"] = "displacement [mm]";
  c["record"]["channels"].push_back({{"column", "time [ms]"}, {"role", "time"}});
  const SidCase milli = parse_sid(where, c).sid;
  EXPECT_NEAR(milli.sample_rate_hz, si.sample_rate_hz, 1e-9);
  static_cast<void>(where.write("record.csv", record_csv(simulate_record(milli, 1), "simulated")));
  c["record"]["file"] = "record.csv";
  const SidCase back = parse_sid(where, c).sid;
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(back.channels[i].signal.scale.value, 1e-3);
    for (std::size_t n = 0; n < 200; ++n) {
      const double expected = si.channels[i].signal.samples[n];
      EXPECT_NEAR(1e-3 * milli.channels[i].signal.samples[n], expected,
                  1e-12 + 1e-9 * std::abs(expected));
      EXPECT_NEAR(1e-3 * back.channels[i].signal.samples[n], expected,
                  1e-9 + 1e-8 * std::abs(expected));
    }
  }
}

TEST(SidCase, ASimulatedRecordReadBackIsTheRecordInMemory) {
  const Workspace where;
  json c = small_sid_case();
  c["record"]["channels"][1]["scale"] = 0.001;  // recorded in mm
  c["record"]["channels"][1]["offset"] = 0.2;
  const SidCase in_memory = parse_sid(where, c).sid;
  where.write("record.csv", signals::record_csv(simulate_record(in_memory, 1), "simulated"));
  c["record"]["file"] = "record.csv";
  const SidCase from_disk = parse_sid(where, c).sid;
  EXPECT_FALSE(from_disk.simulated);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& a = in_memory.channels[i].signal.samples;
    const auto& b = from_disk.channels[i].signal.samples;
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t n = 0; n < a.size(); ++n) EXPECT_NEAR(a[n], b[n], 1e-9 * std::abs(a[n]));
  }
  // Another seed gives another record.
  EXPECT_NE(simulate_record(in_memory, 2).columns[1].values,
            simulate_record(in_memory, 1).columns[1].values);
}

// Fault: responses were written with exit code 0. The first had 86 of 100 samples not finite, the
// second was wrong by a third; the third was rejected as unbounded.
TEST(SidCase, ASimulationChecksItsSteps) {
  const Workspace where;
  const auto simulated = [&](const char* law, const json& coefficients, double rate) {
    json c = with("/truth/sample_rate", rate);
    c["truth"]["noise"] = 0.0;
    c["models"][1]["links"][0].erase("cubic");
    c["models"][1]["links"][0][law] = coefficients;
    c["parameters"].erase("k3");
    c["truth"]["parameters"].erase("k3");
    return c;
  };
  const json yielding =
      simulated("bouc_wen", {{"stiffness", 500}, {"yield", 1e-8}, {"exponent", 10}}, 20.0);
  EXPECT_THAT(refusal(where, yielding),
              testing::AllOf(HasSubstr("/truth"), HasSubstr("the shortest permitted time steps")));
  for (const json& c : {simulated("bouc_wen", {{"stiffness", 500}, {"yield", 1e-3}}, 20.0),
                        simulated("quadratic_damping", 1000.0, 20.0)}) {
    ASSERT_EQ(refusal(where, c), "not refused");
    json fine = c;
    fine["integration"] = {{"step_limit", 0.01}};
    const auto a = simulate_record(parse_sid(where, c).sid, 1).columns[2].values;
    const auto b = simulate_record(parse_sid(where, fine).sid, 1).columns[2].values;
    double difference = 0.0, size = 0.0;
    for (std::size_t n = 0; n < a.size(); ++n) {
      difference += (a[n] - b[n]) * (a[n] - b[n]);
      size += b[n] * b[n];
    }
    EXPECT_LT(std::sqrt(difference / size), 1e-5);
  }
  EXPECT_THAT(refusal(where, with("/truth/parameters/k3", -1e9)), HasSubstr("grows without bound"));
}

TEST(SidCase, WindowsAndLeadInsCutTheRecord) {
  const Workspace where;
  const SidCase whole = parse_sid(where, small_sid_case()).sid;
  json c = small_sid_case();
  c["record"]["samples"] = {50, 120};
  c["record"]["lead_in"] = 20;
  const SidCase part = parse_sid(where, c).sid;
  ASSERT_EQ(part.channels[1].signal.samples.size(), 90U);
  EXPECT_EQ(part.channels[1].signal.samples[0], whole.channels[1].signal.samples[30]);
  EXPECT_EQ(part.channels[1].signal.samples[89], whole.channels[1].signal.samples[119]);
}

// Check of the published study: a short window must have the spectrum of the full record.
TEST(SidCase, ComparesTheWindowWithTheRecord) {
  const Workspace where;
  signals::Noise noise(5);
  std::vector<double> x = signals::white_noise(4000, 1.0, noise);
  for (std::size_t n = 3000; n < x.size(); ++n) x[n] *= 0.1;
  std::string text = "time [s],force [N],displacement [m]\n";
  for (std::size_t n = 0; n < x.size(); ++n) {
    const std::string value = std::to_string(x[n]);
    text += std::to_string(0.01 * static_cast<double>(n)) + ',' + value + ',' + value + '\n';
  }
  static_cast<void>(where.write("record.csv", text));
  const auto told = [](const SidCaseFile& c) {
    return std::ranges::any_of(record_remarks(c.sid), [](const Remark& remark) {
      return std::holds_alternative<remark::PeculiarWindow>(remark);
    });
  };
  json c = from_file("record.csv");
  c["record"]["samples"] = {1000, 2000};
  const SidCaseFile typical = parse_sid(where, c);
  ASSERT_TRUE(typical.sid.channels[0].window.has_value());
  EXPECT_FALSE(told(typical));
  c["record"]["samples"] = {3000, 4000};
  const SidCaseFile quiet = parse_sid(where, c);
  EXPECT_LT(quiet.sid.channels[0].window->power_ratio, 0.05);
  EXPECT_TRUE(told(quiet));
  c["record"].erase("samples");
  EXPECT_FALSE(parse_sid(where, c).sid.channels[0].window.has_value());
}

}  // namespace
}  // namespace wheeltap::apps
