// Cases with structures, and their parsed form.
#pragma once

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/cases/structures/structure_case.hpp"
#include "fem/structures/modes/structure_modes.hpp"

namespace wheeltap::apps {

/// The example of docs/structures.md: a portal frame with a semi-rigid joint, a hinge and springs.
inline nlohmann::json portal_frame() {
  return nlohmann::json::parse(R"({
    "kind": "damage", "title": "Portal frame",
    "structure": {
      "dimension": 2,
      "materials": {"steel": {"young": "E", "poisson": 0.3, "density": 7850}},
      "sections": {"post": {"shape": "rectangle", "width": 0.05, "height": 0.01}},
      "nodes": {"A": [0, 0], "B": [0, 1], "C": [1, 1], "D": [1, 0]},
      "members": [{"name": "left post", "nodes": ["A", "B"], "elements": 8, "material": "steel", "section": "post"},
                  {"name": "beam", "nodes": ["B", "C"], "elements": 8, "material": "steel", "section": "post", "ends": {"B": {"rotation": 1e4}, "C": "hinge"}},
                  {"name": "right post", "nodes": ["C", "D"], "elements": 8, "material": "steel", "section": "post", "axial_force": -100}],
      "supports": [{"node": "A", "fix": ["x", "y", "rotation"]}, {"node": "D", "fix": ["x", "y"], "stiffness": {"rotation": 1e4}}],
      "masses": [{"node": "B", "mass": 2.0, "inertia": 0.0}],
      "springs": [{"nodes": ["B", "D"], "stiffness": 1e5}]
    },
    "parameters": {"E": {"log_normal": [26.07, 0.05]}},
    "baseline": {"data": {"frequencies": [3.1, 9.9], "cov": 0.002}},
    "data": {"frequencies": [3.0, 9.8], "cov": 0.002,
             "sensors": [{"node": "B", "direction": "x"}, {"member": "beam", "at": 0.5, "direction": "y"}],
             "shapes": [[1.0, 0.2], [0.4, -1.0]], "shape_sd": 0.02},
    "damage": [{"kind": "crack", "count": {"min": 0, "max": 1, "prior": "uniform"}, "depth": {"uniform": [0.01, 0.6]}},
               {"kind": "joint", "on": ["B", "C"], "count": {"min": 0, "max": 1, "prior": "uniform"}, "reduction": {"uniform": [0, 0.9]}}]
  })");
}

/// A cantilever of 2 m along `axis` in space, clamped at its first node.
inline nlohmann::json cantilever_in_space(const std::vector<double>& axis = {1, 0, 0}) {
  const nlohmann::json tip = {2 * axis[0], 2 * axis[1], 2 * axis[2]};
  return {{"kind", "damage"},
          {"structure",
           {{"dimension", 3},
            {"materials", {{"steel", {{"young", 210e9}, {"poisson", 0.3}, {"density", 7850}}}}},
            {"sections", {{"bar", {{"shape", "rectangle"}, {"width", 0.02}, {"height", 0.05}}}}},
            {"nodes", {{"A", {0, 0, 0}}, {"B", tip}}},
            {"members",
             {{{"name", "arm"},
               {"nodes", {"A", "B"}},
               {"elements", 10},
               {"material", "steel"},
               {"section", "bar"}}}},
            {"supports", {{{"node", "A"}, {"fix", {"x", "y", "z", "rx", "ry", "rz"}}}}}}}};
}

inline nlohmann::json chain(const std::vector<double>& masses,
                            const std::vector<double>& stiffnesses) {
  nlohmann::json links = nlohmann::json::array();
  for (std::size_t i = 0; i < stiffnesses.size(); ++i)
    links.push_back({{"between", {i, i + 1}}, {"stiffness", stiffnesses[i]}});
  return {{"kind", "update"}, {"structure", {{"chain", {{"masses", masses}, {"links", links}}}}}};
}

/// The structure as parsed by the program.
inline identification::StructureModel parsed(const nlohmann::json& json,
                                             std::vector<std::string>* remarks = nullptr,
                                             const std::filesystem::path& path = "case.json") {
  CaseFile file{.path = path, .json = json};
  validate_against_schema(file, "structure");
  return parse_structure(file, remarks);
}

inline fem::Structure members_of(const nlohmann::json& json) {
  return std::get<fem::Structure>(parsed(json).nominal);
}

inline std::vector<double> frequencies(const identification::AnyStructure& structure, int modes) {
  const auto found = fem::structure_modes(identification::discretise(structure), modes);
  EXPECT_TRUE(found.certified);
  return {found.frequencies_hz.begin(), found.frequencies_hz.end()};
}

inline void expect_near(const std::vector<double>& values, const std::vector<double>& expected,
                        double relative) {
  ASSERT_GE(values.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(values[i], expected[i], relative * expected[i]) << "mode " << i + 1;
}

/// Expects exit code 65 and one line with file, place and reason.
inline void expect_refused(const nlohmann::json& json, const std::string& message) {
  try {
    (void)parsed(json);
    ADD_FAILURE() << "accepted; expected: " << message;
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.exit(), Exit::bad_input);
    EXPECT_THAT(failure.what(), testing::StartsWith("case.json: /"));
    EXPECT_THAT(failure.what(), testing::HasSubstr(message));
    EXPECT_THAT(failure.what(), testing::Not(testing::HasSubstr("\n")));
  }
}

}  // namespace wheeltap::apps
