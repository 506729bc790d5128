#include "apps/commands/section_command.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "fem/sections/section.hpp"
#include "program.hpp"

namespace wheeltap::apps {
namespace {

using nlohmann::json;
using testing::HasSubstr;

const json kChannel = {{0, 0}, {8.5, 0}, {8.5, 1}, {1, 1}, {1, 18}, {8.5, 18}, {8.5, 19}, {0, 19}};

json polygon(const json& outline) {
  return {{"shape", "polygon"}, {"outline", outline}};
}

json of_section(const json& section, double poisson = 0.3) {
  return {{"section", section}, {"poisson", poisson}};
}

/// Output of `wheeltap section --json` for a case.
json properties(const Workspace& where, const json& section_case, const std::string& more = "") {
  const Outcome outcome = wheeltap(
      where, "section " + where.write_json("s.json", section_case).string() + " --json " + more);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return outcome.exit_code == 0 ? json::parse(outcome.out) : json();
}

void expect_share(const json& value, double expected, double tolerance) {
  ASSERT_TRUE(value.is_number()) << value;
  EXPECT_NEAR(value.get<double>() / expected, 1.0, tolerance) << value;
}

json beam(const json& section) {
  return {{"kind", "damage"},
          {"beam",
           {{"length", 100.0},
            {"elements", 20},
            {"supports", "simply-supported"},
            {"material", {{"young", 2e11}, {"poisson", 0.3}, {"density", 7850}}},
            {"section", section}}}};
}

TEST(SectionCommand, ContractsKeys) {
  const Workspace where;
  const json p = properties(where, of_section(polygon(kChannel), 1.0 / 3.0));
  expect_share(p["area"], 34.0, 1e-12);
  expect_share(p["centroid"][0], 2.375, 1e-12);
  expect_share(p["centroid"][1], 9.5, 1e-12);
  expect_share(p["second_moments"]["yy"], 1787.8333333, 1e-9);
  expect_share(p["second_moments"]["zz"], 223.3020833, 1e-9);
  EXPECT_NEAR(p["second_moments"]["yz"].get<double>(), 0.0, 1e-9);
  expect_share(p["torsion_constant"], 11.2682, 1e-4);
  expect_share(p["warping_constant"], 12766, 1e-4);
  expect_share(p["shear_centre"][0], -(2.8685 + 2.375 - 0.5), 1e-4);
  expect_share(p["shear_coefficients"]["y"], 1.0 / 3.4129, 1e-4);
  expect_share(p["shear_coefficients"]["z"], 1.0 / 2.1548, 1e-4);
  EXPECT_NEAR(p["shear_coefficients"]["yz"].get<double>(), 0.0, 1e-4);
  EXPECT_TRUE(p["converged"].get<bool>());
  EXPECT_LT(p["errors"]["torsion_constant"].get<double>(), 2e-4);
}

TEST(SectionCommand, BareSectionsBeamsAndStructures) {
  const Workspace where;
  const double expected =
      properties(where, of_section(polygon(kChannel)))["torsion_constant"].get<double>();
  json bare = polygon(kChannel);
  bare["poisson"] = 0.3;
  EXPECT_EQ(properties(where, bare)["torsion_constant"], expected);
  EXPECT_EQ(properties(where, beam(polygon(kChannel)))["torsion_constant"], expected);
  const json structure = {
      {"kind", "damage"},
      {"structure",
       {{"materials", {{"steel", {{"young", "E"}, {"poisson", 0.3}, {"density", 7850}}}}},
        {"sections",
         {{"c", polygon(kChannel)}, {"r", {{"shape", "rectangle"}, {"width", 1}, {"height", 2}}}}},
        {"members", {{{"section", "c"}, {"material", "steel"}}}}}}};
  EXPECT_EQ(properties(where, structure, "--name c")["torsion_constant"], expected);
  const std::string path = where.write_json("s.json", structure).string();
  Outcome outcome = wheeltap(where, "section " + path);
  EXPECT_EQ(outcome.exit_code, 64);
  EXPECT_THAT(outcome.err, HasSubstr("c, r"));
  EXPECT_EQ(wheeltap(where, "section " + path + " --name q").exit_code, 64);
  // The material may stand in the pieces of a member; properties that the case gives are ignored.
  json pieces = structure;
  pieces["structure"]["members"] = json::parse(
      R"([{"section": 5}, {"pieces": [{"to": 1, "section": "c", "material": "steel"}]}])");
  pieces["structure"]["sections"]["c"]["depth"] = 19;
  EXPECT_EQ(properties(where, pieces, "--name c")["torsion_constant"], expected);
}

TEST(SectionCommand, ShapesHaveCowpersCoefficientBesideTheirOwn) {
  const Workspace where;
  const json rectangle = {{"shape", "rectangle"}, {"width", 1.0}, {"height", 2.0}};
  const json p = properties(where, of_section(rectangle));
  expect_share(p["shear_coefficients"]["y"], 1.0 / 1.27479, 2e-5);
  expect_share(p["shear_coefficients"]["z"], 1.0 / 1.20056, 2e-5);
  expect_share(p["shear_coefficients_cowper"]["z"], fem::cowper_rectangle(0.3), 1e-12);
  const json circle = properties(where, of_section({{"shape", "circle"}, {"diameter", 0.2}}));
  expect_share(circle["shear_coefficients"]["z"], 1.0 / 1.175542, 2e-5);
  expect_share(circle["area"], std::numbers::pi * 0.01, 1e-12);
  expect_share(circle["shear_coefficients_cowper"]["y"], fem::cowper_circle(0.3), 1e-12);
  const json tube = properties(
      where, of_section({{"shape", "tube"}, {"outer_diameter", 2.0}, {"thickness", 0.3}}));
  expect_share(tube["torsion_constant"], std::numbers::pi / 2 * (1 - std::pow(0.7, 4)), 2e-5);
  for (const char* shape : {"i", "box"}) {
    const json sized = {{"shape", shape},
                        {"height", 0.2},
                        {"width", 0.1},
                        {"flange_thickness", 0.01},
                        {"web_thickness", 0.006}};
    const json q = properties(where, of_section(sized));
    const fem::Section s = shape == std::string("i")
                               ? fem::section(fem::ISection{0.2, 0.1, 0.01, 0.006}, 0.3)
                               : fem::section(fem::Box{0.2, 0.1, 0.01, 0.006}, 0.3);
    expect_share(q["area"], s.area, 1e-9);
    expect_share(q["second_moments"]["yy"], s.second_moment, 1e-9);
    expect_share(q["shear_coefficients"]["z"], s.shear_coefficient, 0.05);
  }
}

TEST(SectionCommand, BeamsBendAboutTheWidth) {
  const Workspace where;
  const auto frequencies = [&](const json& section_case) {
    const Outcome outcome = wheeltap(
        where, "modes --modes 3 --json " + where.write_json("b.json", section_case).string());
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return json::parse(outcome.out)["frequencies_hz"].get<std::vector<double>>();
  };
  const json p = properties(where, beam(polygon(kChannel)));
  const auto outlined = frequencies(beam(polygon(kChannel))),
             stated = frequencies(beam({{"area", p["area"]},
                                        {"second_moment", p["second_moments"]["yy"]},
                                        {"shear_coefficient", p["shear_coefficients"]["z"]}}));
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(outlined[i] / stated[i], 1.0, 1e-12);
  // Parts of the case's material have no effect; a light filling of the same stiffness has.
  json parts = polygon({{0, 0}, {1, 0}, {1, 2}, {0, 2}});
  const auto half = frequencies(
      beam({{"shape", "rectangle"}, {"width", 2.0}, {"height", 2.0}, {"shear_coefficient", 0.85}}));
  parts["shear_coefficient"] = 0.85;
  parts["regions"] = {{{"outline", {{1, 0}, {2, 0}, {2, 2}, {1, 2}}}}};
  const auto joined = frequencies(beam(parts));
  parts["regions"][0]["density"] = 1570.0;
  const auto light = frequencies(beam(parts));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(joined[i] / half[i], 1.0, 1e-9);
    EXPECT_NEAR(light[i] / half[i], std::sqrt(1.0 / 0.6), 1e-9);
  }
}

TEST(SectionCommand, ReadsDrawingsAndTables) {
  const Workspace where;
  where.write("o.csv", "y [mm],z [mm]\n0,0\n100,0\n100,50\n0,50\n\n20,20\n30,20\n30,30\n20,30\n");
  const json table = of_section({{"shape", "polygon"}, {"file", "o.csv"}});
  expect_share(properties(where, table)["area"], 0.0049, 1e-12);
  where.write(
      "o.dxf",
      "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n5\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n"
      "0\nCIRCLE\n10\n0\n20\n0\n40\n10\n0\nCIRCLE\n10\n0\n20\n0\n40\n7\n0\nENDSEC\n0\nEOF\n");
  json drawing = of_section({{"shape", "polygon"}, {"file", "o.dxf"}});
  const json p = properties(where, drawing);
  expect_share(p["area"], std::numbers::pi * (0.01 - 0.0049), 1e-9);
  expect_share(p["torsion_constant"], std::numbers::pi / 2 * (1e-4 - std::pow(0.07, 4)), 2e-5);
  // The case must not state a unit that the file states.
  drawing["section"]["unit"] = "mm";
  const std::string path = where.write_json("s.json", drawing).string();
  EXPECT_EQ(wheeltap(where, "section " + path).exit_code, 65);
}

TEST(SectionCommand, Draws) {
  const Workspace where;
  const std::string path = where.write_json("s.json", of_section(polygon(kChannel))).string();
  const Outcome outcome = wheeltap(where, "section " + path + " -o " + (where / "s.svg").string());
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.out, HasSubstr("torsion constant"));
  EXPECT_THAT(outcome.out, HasSubstr("m⁴"));
  const std::string svg = read_all(where / "s.svg");
  EXPECT_THAT(svg, testing::StartsWith("<svg"));
  EXPECT_THAT(svg, HasSubstr("shear centre"));
  EXPECT_EQ(wheeltap(where, "section " + path + " -o " + (where / "no/s.svg").string()).exit_code,
            73);
}

TEST(SectionCommand, BadOutlinesSayWhere) {
  const Workspace where;
  const auto refused = [&](const json& section_case, const std::string& place,
                           const std::string& what) {
    const Outcome outcome =
        wheeltap(where, "section " + where.write_json("s.json", section_case).string());
    EXPECT_EQ(outcome.exit_code, 65) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr("s.json: " + place + ": "));
    EXPECT_THAT(outcome.err, HasSubstr(what));
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1);
  };
  const json square = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  refused(of_section(polygon({{0, 0}, {1, 1}, {1, 0}, {0, 1}})), "/section/outline", "(0, 0)");
  refused(beam(polygon({{0, 0}, {1, 1}, {1, 0}, {0, 1}})), "/beam/section/outline", "crosses");
  refused(of_section(polygon({{0, 0}, {1, 0}})), "/section/outline", "at least 3");
  refused(of_section(polygon({{0, 0}, {1, 0}, {1, "x"}})), "/section/outline/2/1",
          "must be a number");
  json holed = polygon(square);
  holed["holes"] = {{{2, 2}, {3, 2}, {3, 3}}};
  refused(of_section(holed), "/section/holes/0", "outside");
  json parts = polygon(square);
  parts["regions"] = {{{"outline", {{0.5, 0}, {1.5, 0}, {1.5, 1}, {0.5, 1}}}}};
  refused(of_section(parts), "/section/regions/0", "overlaps");
  parts["regions"] = {{{"outline", {{5, 0}, {6, 0}, {6, 1}}}}};
  refused(of_section(parts), "/section", "2 unconnected parts");
  parts["regions"][0]["young"] = 1e9;
  refused(of_section(parts), "/section/regions/0/young", "needs a reference value");
  refused({{"section", polygon(square)}}, "/poisson", "is missing");
  refused(of_section(polygon(square), 0.6), "/poisson", "0.5");
  refused(of_section({{"shape", "polygon"}}), "/section/outline", "is missing");
  refused(of_section({{"shape", "rectangle"}, {"width", 1}}), "/section/height", "is missing");
  json bare = polygon({{0, 0}, {1, 1}, {1, 0}, {0, 1}});
  bare["poisson"] = 0.3;
  refused(bare, "/outline", "crosses");
}

}  // namespace
}  // namespace wheeltap::apps
