// Cases with structures that once crashed the program, gave silently wrong results or ended with
// exit code 70. "Before" in each test states the old behaviour.
#include <gmock/gmock.h>

#include "program.hpp"
#include "structure_cases.hpp"

namespace wheeltap::apps {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// Expects exit code 65 and one line with these words.
void expect_refused_by(const Workspace& where, const std::string& command, const json& c,
                       const std::string& words) {
  const Outcome ran = wheeltap(where, command + " " + where.write_json("c.json", c).string());
  EXPECT_EQ(ran.exit_code, 65) << command << ": " << ran.err;
  EXPECT_EQ(std::ranges::count(ran.err, '\n'), 1) << ran.err;
  EXPECT_THAT(ran.err, HasSubstr(words)) << command;
}

// Before: a segmentation fault, which also ended a batch; `modes` showed four modes at 0 Hz.
TEST(EmptyStructures, RejectsEmptyLinksAndMembers) {
  const Workspace where;
  const std::string out = " -o " + (where / "out").string();
  json chain = json::parse(R"({
    "kind": "damage", "structure": {"chain": {"masses": [1, 1, 1, 1], "links": []}},
    "data": {"frequencies": [1.0], "cov": 0.01},
    "damage": {"kind": "storey", "count": {"min": 0, "max": 1}, "reduction": {"uniform": [0, 0.9]},
               "truth": []}})");
  json frame = json::parse(R"({
    "kind": "damage", "structure": {"nodes": {"A": [0, 0], "B": [0, 1]}, "members": []},
    "data": {"frequencies": [1.0], "cov": 0.01},
    "damage": {"kind": "reduction", "count": {"min": 0, "max": 1},
               "reduction": {"uniform": [0, 0.9]}, "truth": []}})");
  for (const std::string& command :
       std::vector<std::string>{"modes", "modes --truth", "damage --quick" + out, "serve",
                                "simulate -o " + (where / "s.json").string()}) {
    expect_refused_by(where, command, chain,
                      "/structure/chain/links: []: is empty: must have at least one");
    expect_refused_by(where, command, frame,
                      "/structure/members: []: is empty: must have at least one");
  }
  for (json* c : {&chain, &frame}) {
    (*c)["kind"] = "update";
    c->erase("damage");
    (*c)["parameters"] = {{"E", {{"uniform", {190e9, 220e9}}}}};
    expect_refused_by(where, "update" + out, *c, "is empty: must have at least one element");
  }
  frame["kind"] = "damage";
  frame.erase("parameters");
  frame["damage"] = {
      {"kind", "reduction"}, {"count", {{"max", 1}}}, {"reduction", {{"uniform", {0, 0.9}}}}};
  frame["structure"].erase("members");
  expect_refused_by(where, "modes", frame, "has neither members nor springs");
  frame["structure"]["springs"] =
      json::parse(R"([{"node": "A", "direction": "x", "stiffness": 1e5}])");
  frame["structure"]["masses"] = json::parse(R"([{"node": "A", "mass": 1}])");
  expect_refused_by(where, "damage" + out, frame,
                    "/damage/kind: \"reduction\": the structure has no");
}

class StructureHardInput : public testing::Test {
 protected:
  /// A column with a beam on top, few elements, one kind of defect.
  static json bracket(const json& damage) {
    json c = json::parse(R"({
      "kind": "damage",
      "structure": {
        "materials": {"steel": {"young": 210e9, "poisson": 0.3, "density": 7850}},
        "sections": {"bar": {"shape": "rectangle", "width": 0.05, "height": 0.01}},
        "nodes": {"A": [0, 0], "B": [0, 1], "C": [1, 1]},
        "members": [{"name": "post", "nodes": ["A", "B"], "elements": 3, "material": "steel", "section": "bar"},
                    {"name": "arm", "nodes": ["B", "C"], "elements": 3, "material": "steel", "section": "bar"}],
        "supports": [{"node": "A", "fix": ["x", "y", "rotation"]}]
      },
      "data": {"cov": 0.01, "modes": 3}
    })");
    c["damage"] = damage;
    return c;
  }
  static json kind(const std::string& text) {
    json k = json::parse(text);
    k["count"] = {{"min", 0}, {"max", 1}, {"prior", "uniform"}};
    return k;
  }
  [[nodiscard]] Outcome run(const json& c) const {
    return wheeltap(where, "damage " + where.write_json("c.json", c).string() + " -o " +
                               (where / "out").string() +
                               " --quiet --chains 2 --warmup 100 --draws 100");
  }
  void expect_refusal(const json& c, const std::string& place, const std::string& words) const {
    const Outcome outcome = run(c);
    EXPECT_EQ(outcome.exit_code, 65) << outcome.err;
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(place)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(words)) << outcome.err;
  }
  Workspace where;
};

// Before: a crash, since there is no reanalysis of a beam to train on.
TEST_F(StructureHardInput, AnEmulatorKnowsNoExtent) {
  json c = small_case();
  c["damage"]["extent"] = 0.2;
  c["predictor"] = json::parse(R"({"sites": [2, 5, 9], "multipliers": [0.4, 1.0]})");
  expect_refusal(c, "/predictor: ", "an emulator supports stiffness reductions of single elements");
}

// Before: exit 65, "log likelihood is nan".
TEST_F(StructureHardInput, MoreMassThanThereIsCannotBeLost) {
  const json c = bracket(kind(R"({"kind": "mass", "mass": {"uniform": [-20, 1]},
                                  "truth": [{"member": "arm", "location": 0.5, "mass": 0.3}]})"));
  const Outcome outcome = run(c);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  json lost = c;
  lost["damage"]["truth"][0]["mass"] = -1e6;
  expect_refusal(lost, "/damage/truth", "lost mass");
}

// Before: 4294967297 was read as member 1.
TEST_F(StructureHardInput, NumbersOfMembersNeverWrap) {
  json c = bracket(kind(R"({"kind": "crack", "depth": {"uniform": [0.05, 0.5]},
                            "truth": [{"member": 1, "location": 0.5, "depth": 0.3}]})"));
  EXPECT_EQ(run(c).exit_code, 0);
  for (const json& member : {json(4294967297), json(-1), json(2), json(0.5), json(1e300)}) {
    c["damage"]["truth"][0]["member"] = member;
    expect_refusal(c, "/damage/truth/0/member", "its number from 0 to 1");
  }
}

// Before: exit 70, "modes = 18: must be at most 17 here".
TEST_F(StructureHardInput, RigidSupportsTakeModes) {
  json c = bracket(kind(R"({"kind": "support", "fix": ["y"], "stiffness": "rigid", "on": ["arm"],
                            "truth": [{"member": "arm", "location": 0.5}]})"));
  c["data"]["modes"] = 18;
  expect_refusal(c, "/data/modes", "must be at most 17, the number of elastic modes of this");
  c["data"]["modes"] = 17;
  EXPECT_EQ(run(c).exit_code, 0);
}

// Before: exit 70.
TEST_F(StructureHardInput, BucklingIsTheCases) {
  json c = bracket(kind(R"({"kind": "crack", "depth": {"uniform": [0.05, 0.5]},
                            "truth": [{"member": 1, "location": 0.5, "depth": 0.3}]})"));
  c["structure"]["members"][0]["axial_force"] = -1e9;
  expect_refusal(c, "/structure", "exceed the buckling load");
  c["structure"]["members"][0]["axial_force"] = -100;
  c["structure"].erase("supports");
  expect_refusal(c, "/structure", "exceed the buckling load");
}

// Before: exit 70, or an error about degrees of freedom without mass.
TEST_F(StructureHardInput, AMassOfAnotherWorldIsTheCases) {
  json c = bracket(kind(R"({"kind": "crack", "depth": {"uniform": [0.05, 0.5]},
                            "truth": [{"member": 1, "location": 0.5, "depth": 0.3}]})"));
  for (const double mass : {1e20, 1e300}) {
    c["structure"]["masses"] = json::array({{{"node", "B"}, {"mass", mass}}});
    expect_refusal(c, "/structure", "powers of ten");
  }
}

}  // namespace
}  // namespace wheeltap::apps
