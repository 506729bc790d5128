// Common mistakes in cases and on command lines: each message names the place of the mistake and a
// correction.
#include <gmock/gmock.h>

#include <functional>
#include <string>
#include <vector>

#include "program.hpp"
#include "sid_cases.hpp"
#include "structure_cases.hpp"

namespace wheeltap::apps {
namespace {

using nlohmann::json;
using testing::HasSubstr;

struct Mistake {
  std::string what;     ///< for the test's own messages
  std::string command;  ///< with CASE for the case's path
  json base;
  std::string at;  ///< pointer of the value to change; empty: see `edit`
  json value;      ///< the wrong value at this place; discarded: none
  std::string place, remedy;
  int exit_code = 65;
  std::function<void(json&)> edit = {};
};

json gone() {
  return json(json::value_t::discarded);
}

json update_case() {
  return json::parse(R"({
    "kind": "update",
    "structure": {"chain": {"masses": [6.0, 6.0], "links": [
      {"between": [0, 1], "stiffness": "k1"}, {"between": [1, 2], "stiffness": "k2"}]}},
    "parameters": {"k1": {"uniform": [1e4, 1e6]}, "k2": {"uniform": [1e4, 1e6]}},
    "data": {"frequencies": [12.7, 33.2], "cov": 0.005}
  })");
}

json frame_case() {
  json frame = portal_frame();
  frame.erase("baseline");
  return frame;
}

json modal_case() {
  return json::parse(R"({
    "kind": "modal",
    "record": {"file": "record.csv", "sample_rate": 100, "channels": [
      {"column": "a1", "role": "response", "node": "A", "direction": "x"},
      {"column": "a2", "role": "response", "node": "B", "direction": "x"}]},
    "band": [1, 20]
  })");
}

json section_case() {
  return json::parse(
      R"({"section": {"shape": "rectangle", "width": 0.1, "height": 0.2}, "poisson": 0.3})");
}

void write_record(const Workspace& where) {
  std::string text = "a1,a2\n";
  for (int i = 0; i < 400; ++i)
    text += std::to_string((i * 37) % 101) + "," + std::to_string((i * 53) % 97) + "\n";
  (void)where.write("record.csv", text);
}

std::vector<Mistake> mistakes() {
  const std::string damage = "damage CASE --dry-run", update = "update CASE --dry-run";
  const std::string sid = "sid CASE --dry-run", modal = "modal CASE --dry-run";
  const std::string section = "section CASE", modes = "modes CASE";
  const json beam = small_case(), frame = frame_case(), chain_of_two = update_case();
  const json record = small_sid_case(), vibration = modal_case(), profile = section_case();
  const json steel = {{"gaussian", {210e9, 10e9}}};
  const std::string bare = "";  // the command line contains the case
  return {
      // Numbers as texts, and their units.
      {"percent", damage, beam, "/data/cov", "0.1%", "/data/cov", "write 0.001"},
      {"length with its unit", damage, beam, "/beam/length", "0.9m", "/beam/length",
       "write 0.9 (m)"},
      {"modulus in GPa", damage, beam, "/beam/material/young", "210 GPa", "/beam/material/young",
       "write 210e9 (Pa)"},
      {"decimal comma in a text", damage, beam, "/data/frequencies/1", "55,3",
       "/data/frequencies/1", "write 55.3"},
      {"millimetres", damage, beam, "/beam/section/height", "6 mm", "/beam/section/height",
       "write 0.006 (m)"},
      {"density in g/cm3", damage, beam, "/beam/material/density", "2.7 g/cm3",
       "/beam/material/density", "write 2700 (kg/m3)"},
      {"whole number as a text", damage, beam, "/beam/elements", "10", "/beam/elements",
       "write 10"},
      {"stiffness in kN/m", update, chain_of_two, "/structure/chain/links/0/stiffness", "100 kN/m",
       "/structure/chain/links/0/stiffness", "write 100000 (N/m)"},
      {"damping as a text", sid, record, "/models/0/links/0/damping", "0,1",
       "/models/0/links/0/damping", "write 0.1"},
      {"sampling rate in kHz", modal, vibration, "/record/sample_rate", "0.1 kHz",
       "/record/sample_rate", "write 100 (Hz)"},
      {"frequencies in one text", damage, beam, "/data/frequencies", "13.8, 55.3, 124",
       "/data/frequencies", "write [13.8, 55.3, 124]"},
      {"per cent as a number", damage, beam, "/data/cov", 5, "/data/cov", "write 0.05 for 5 %"},
      {"a decimal comma in a list",
       damage,
       beam,
       "/data/frequencies",
       {13, 85, 55, 4},
       "/data/frequencies",
       "[13.85, 55.4]"},
      // Names of keys.
      {"E for young", damage, beam, "/beam/material/E", 70e9, "/beam/material/E",
       "did you mean \"young\"", 65, [](json& c) { c["beam"]["material"].erase("young"); }},
      {"rho for density", damage, beam, "/beam/material/rho", 2700, "/beam/material/rho",
       "did you mean \"density\"", 65, [](json& c) { c["beam"]["material"].erase("density"); }},
      {"capitals", damage, beam, "/beam/Length", 1.0, "/beam/Length", "did you mean \"length\"", 65,
       [](json& c) { c["beam"].erase("length"); }},
      {"a key of JSON files of results",
       damage,
       beam,
       "/data/frequencies_hz",
       {13.8},
       "/data/frequencies_hz",
       "did you mean \"frequencies\"",
       65,
       [](json& c) { c["data"].erase("frequencies"); }},
      {"two letters exchanged",
       damage,
       beam,
       "/damage/locaiton",
       {{"uniform", {0, 1}}},
       "/damage/locaiton",
       "did you mean \"location\"",
       65,
       [](json& c) { c["damage"].erase("location"); }},
      {"a key at the top", damage, beam, "/cov", 0.01, "/cov", "it belongs in /data"},
      {"a key of the material at the beam", damage, beam, "/beam/young", 70e9, "/beam/young",
       "it belongs in /beam/material"},
      {"supports at the top", damage, beam, "/supports", "cantilever", "/supports",
       "it belongs in /beam"},
      {"noise outside its model", sid, record, "/noise", 0.05, "/noise", "it belongs in /models/N"},
      {"sampling rate by another name", modal, vibration, "/record/fs", 100, "/record/fs",
       "did you mean \"sample_rate\"", 65, [](json& c) { c["record"].erase("sample_rate"); }},
      {"a key of another kind of case", damage, beam, "/models", json::array(), "/models",
       "\"sid\""},
      {"order at the record",
       modal,
       vibration,
       "/record/order",
       {{"max", 40}},
       "/record/order",
       "it belongs in the case itself"},
      // Missing keys.
      {"no Poisson's ratio", damage, beam, "/beam/material/poisson", gone(),
       "/beam/material/poisson", "write \"poisson\": 0.3"},
      {"no noise", damage, beam, "/data/cov", gone(), "/data/cov", "write \"cov\": 0.005"},
      {"no count", damage, beam, "/damage/count", gone(), "/damage/count",
       "write \"count\": {\"max\": 2"},
      {"no role", sid, record, "/record/channels/0/role", gone(), "/record/channels/0/role",
       "write \"role\": \"response\""},
      {"no links", sid, record, "/models/0/links", gone(), "/models/0/links",
       "write \"links\": [{\"between\": [0, 1]"},
      {"no height", section, profile, "/section/height", gone(), "/section/height",
       "write \"height\": "},
      {"no node of a support", damage, frame, "/structure/supports/0/node", gone(),
       "/structure/supports/0/node", "write \"node\": \"A\""},
      // Kinds of value.
      {"a number for a list", damage, beam, "/data/frequencies", 13.8, "/data/frequencies",
       "write [13.8]"},
      {"a list for a prior",
       damage,
       beam,
       "/damage/location",
       {0, 1},
       "/damage/location",
       "write {\"uniform\": [0, 1]}"},
      {"true as a text", damage, beam, "/balance", "true", "/balance", "write true"},
      {"a prior for a parameter's name",
       damage,
       beam,
       "/beam/material/young",
       {{"normal", {70e9, 1e9}}},
       "/beam/material/young",
       "\"parameters\": {\"young\": {\"normal\": [70e9, 1e9]}}"},
      {"a word that is no support", damage, beam, "/beam/supports", "simply supported",
       "/beam/supports", "write \"simply-supported\""},
      {"a role that does not exist", modal, vibration, "/record/channels/0/role", "respons",
       "/record/channels/0/role", "write \"response\""},
      {"a mode that was not measured", damage, beam, "/data/frequencies/1", "-",
       "/data/frequencies/1", "write null"},
      {"zero for a mode that was not measured", damage, beam, "/data/frequencies/1", 0,
       "/data/frequencies/1", "write null"},
      {"a text for a list of texts", damage, frame, "/structure/supports/0/fix", "x",
       "/structure/supports/0/fix", "write [\"x\"]"},
      // Priors.
      {"gaussian", update, chain_of_two, "/parameters/k1", steel, "/parameters/k1/gaussian",
       "did you mean \"normal\""},
      {"named bounds",
       update,
       chain_of_two,
       "/parameters/k1/uniform",
       {{"min", 1e4}, {"max", 1e5}},
       "/parameters/k1/uniform",
       "write [10000, 100000]"},
      {"a normal prior of a noise",
       sid,
       record,
       "/parameters/k3",
       {{"normal", {1000, 300}}},
       "/parameters/k3",
       "write {\"truncated_normal\": [1000, 300, 0, 2800]}",
       65,
       [](json& c) {
         for (json& model : c["models"]) model["noise"] = "k3";
       }},
      {"a normal prior of a modulus",
       update,
       chain_of_two,
       "/parameters/k1",
       {{"normal", {1e5, 1e4}}},
       "/parameters/k1",
       "write {\"truncated_normal\": [100000, 10000, 0, 160000]}"},
      {"a reduction beyond 1",
       damage,
       beam,
       "/damage/reduction",
       {{"uniform", {0, 60}}},
       "/damage/reduction",
       "write {\"uniform\": [0, 0.999]}"},
      {"a location beyond the beam",
       damage,
       beam,
       "/damage/location",
       {{"uniform", {0, 1000}}},
       "/damage/location",
       "write {\"uniform\": [0, 1]}"},
      {"bounds in the wrong order",
       update,
       chain_of_two,
       "/parameters/k1/uniform",
       {1e6, 1e4},
       "/parameters/k1/uniform",
       "write [10000, 1e6]"},
      {"a prior without a standard deviation",
       update,
       chain_of_two,
       "/parameters/k1",
       {{"normal", {1e5}}},
       "/parameters/k1/normal",
       "two numbers"},
      // References: names, numbers, columns.
      {"an unknown node", damage, frame, "/structure/members/0/nodes/1", "b",
       "/structure/members/0/nodes/1", "did you mean \"B\""},
      {"an unknown section", damage, frame, "/structure/members/0/section", "posts",
       "/structure/members/0/section", "did you mean \"post\""},
      {"two members of one name", damage, frame, "/structure/members/1/name", "left post",
       "/structure/members/1/name", "two members have this name"},
      {"a mass that does not exist", sid, record, "/record/channels/1/mass", 2,
       "/record/channels/1/mass", "masses 1 to 1"},
      {"a column counted from 0", modal, vibration, "/record/channels/0/column", 0,
       "/record/channels/0/column", "from 1"},
      {"a column that is not there", modal, vibration, "/record/channels/0/column", "a3",
       "/record/channels/0/column", "a1"},
      {"one standard deviation too few",
       damage,
       beam,
       "/data/sd",
       {0.1, 0.2},
       "/data/sd",
       "one value per mode: 3",
       65,
       [](json& c) { c["data"].erase("cov"); }},
      {"an unused parameter",
       update,
       chain_of_two,
       "/parameters/k3",
       {{"uniform", {0, 1}}},
       "/parameters/k3",
       "remove the parameter"},
      // Command lines.
      {"--quik", "damage CASE -o out --quik", beam, bare, {}, "--quik", "did you mean --quick", 64},
      {"a folder without -o", "damage CASE results", beam, bare, {}, "results", "-o results", 64},
      {"no command", "CASE -o results", beam, bare, {}, "no command", "wheeltap damage ", 64},
      {"another kind's command", "damage CASE -o out", record, bare, {}, "/kind", "`wheeltap sid`"},
      {"-o is missing", "update CASE", chain_of_two, bare, {}, "--output", "-o results", 64},
      {"a slash in --set",
       "damage CASE -o out --set beam/length=2",
       beam,
       bare,
       {},
       "beam/length",
       "write --set beam.length=2",
       64},
  };
}

// The parts of a message: place of the mistake, and correction.
TEST(Mistakes, MessagesNameThePlaceAndTheRemedy) {
  const Workspace where;
  write_record(where);
  const auto list = mistakes();
  ASSERT_GE(list.size(), 60U);
  for (const Mistake& mistake : list) {
    json c = mistake.base;
    if (mistake.edit) mistake.edit(c);
    if (!mistake.at.empty()) {
      const json::json_pointer at(mistake.at);
      if (mistake.value.is_discarded()) {
        c.at(at.parent_pointer()).erase(at.back());
      } else {
        c[at] = mistake.value;
      }
    }
    const std::string path = where.write_json("case.json", c).string();
    std::string command = mistake.command;
    command.replace(command.find("CASE"), 4, path);
    const Outcome outcome = wheeltap(where, command);
    EXPECT_EQ(outcome.exit_code, mistake.exit_code) << mistake.what << ": " << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(mistake.place)) << mistake.what;
    EXPECT_THAT(outcome.err, HasSubstr(mistake.remedy)) << mistake.what;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }
}

struct Typo {
  std::string right, wrong, remedy;
};

// The file is not JSON: the message has line, column and correction.
TEST(Mistakes, SyntaxErrorsNameTheTextToWrite) {
  const Workspace where;
  const std::string text = small_case().dump(1);
  for (const Typo& typo : std::vector<Typo>{
           {"\"cov\": 0.01", "\"cov\": 1%", "write 0.01"},
           {"\"length\": 1.0", "\"length\": 0,9", "write 0.9"},
           {"\"length\": 1.0", "\"length\": 900 mm", "write 0.9 (m)"},
           {"\"length\": 1.0", "\"length\": .9", "write 0.9"},
           {"\"cov\": 0.01", "'cov': 0.01", "write \"cov\""},
           {"\"cov\": 0.01", "cov: 0.01", "write \"cov\":"},
           {"\"cov\": 0.01", "\"cov\": None", "write null"},
           {"\"simply-supported\"", "simply-supported", "write \"simply-supported\""},
           {"\"cov\": 0.01,", "\"cov\": 0.01", "a comma is missing"},
           {"\"length\": 1.0,", "\"length\": 1.0, // metres\n", "JSON has no comments"},
           {"\"min\": 0,\n   \"prior\": \"uniform\"", "\"min\": 0,\n   \"prior\": \"uniform\",",
            "remove the comma"},
       }) {
    std::string wrong = text;
    const auto at = wrong.find(typo.right);
    ASSERT_NE(at, std::string::npos) << typo.right << " in " << text;
    wrong.replace(at, typo.right.size(), typo.wrong);
    const Outcome outcome = wheeltap(where, "modes " + where.write("typo.json", wrong).string());
    EXPECT_EQ(outcome.exit_code, 65) << typo.wrong;
    EXPECT_THAT(outcome.err, HasSubstr("typo.json:")) << typo.wrong;
    EXPECT_THAT(outcome.err, HasSubstr(typo.remedy)) << typo.wrong;
  }
}

}  // namespace
}  // namespace wheeltap::apps
