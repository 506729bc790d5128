#include "apps/commands/section_command.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "apps/cases/structures/section_case.hpp"
#include "apps/commands/command_list.hpp"
#include "apps/commands/command_options.hpp"
#include "apps/report/section_figure.hpp"
#include "apps/report/svg_plot.hpp"
#include "apps/results/summary.hpp"
#include "apps/runs/running.hpp"
#include "apps/structure_words.hpp"
#include "apps/words.hpp"
#include "fem/sections/section.hpp"
#include "identification/structural/structure_plausibility.hpp"

namespace wheeltap::apps {
namespace {

/// A section of a case as a separate file {"section": …, "poisson": …}, and its location in the
/// case.
struct Found {
  CaseFile file;
  std::string place;  ///< location in the case: "/beam/section"; "" for a file of one section
  std::string title;
};

Json section_alone(const Json& section, const Json& material) {
  Json alone = {{"section", section}};
  for (const char* key : {"poisson", "young", "density"})
    if (material.contains(key) && material.at(key).is_number()) alone[key] = material.at(key);
  return alone;
}

Found of_structure(const CaseFile& file, const std::string& wanted, const std::string& title) {
  const Pointer where("/structure/sections");
  if (!file.json.contains(where) || !file.json.at(where).is_object() || file.json.at(where).empty())
    file.refuse(where, "is missing: this structure has no sections");
  const Json& sections = file.json.at(where);
  std::vector<std::string> names;
  for (const auto& [name, ignored] : sections.items()) names.push_back(name);
  if (wanted.empty() && names.size() > 1)
    throw Failure(Exit::usage, file.path.string() +
                                   " has several sections: choose one with --name (" +
                                   listed(names) + ")");
  const std::string name = wanted.empty() ? names[0] : wanted;
  if (!sections.contains(name))
    throw Failure(Exit::usage,
                  "--name " + name + ": no section has this name; there are: " + listed(names));
  // Use the material of the first member with this section.
  Json material = Json::object();
  const Json& structure = file.json.at("structure");
  const auto take = [&](const Json& part) {
    const auto says = [&](const char* key) {
      return part.is_object() && part.contains(key) && part.at(key).is_string();
    };
    if (!material.empty() || !says("section") || part.at("section") != name || !says("material"))
      return;
    const Pointer at = Pointer("/materials") / part.at("material").get<std::string>();
    if (structure.contains(at)) material = structure.at(at);
  };
  for (const Json& member : structure.value("members", Json::array())) {
    take(member);
    if (member.is_object() && member.contains("pieces"))
      std::ranges::for_each(member.at("pieces"), take);
  }
  Found found{.file = file, .place = (where / name).to_string(), .title = title};
  Json section = sections.at(name);
  // Properties that the case gives in place of the computed ones.
  if (section.is_object())
    for (const char* key : {"shear_coefficient", "torsion_constant", "depth"}) section.erase(key);
  found.file.json = section_alone(section, material);
  found.title += found.title.empty() ? name : ": " + name;
  return found;
}

Found find_section(const CaseFile& file, const std::string& name) {
  const Json& json = file.json;
  const std::string title = json.contains("title") && json.at("title").is_string()
                                ? json.at("title").get<std::string>()
                                : "";
  if (json.contains("structure")) return of_structure(file, name, title);
  if (!name.empty()) throw Failure(Exit::usage, "--name " + name + ": this case has one section");
  Found found{.file = file, .place = "/section", .title = title};
  const Pointer beam("/beam/section"), material("/beam/material");
  if (json.contains("beam")) {
    if (!json.contains(beam)) file.refuse(beam, "is missing");
    found.place = beam.to_string();
    found.file.json =
        section_alone(json.at(beam), json.contains(material) ? json.at(material) : Json::object());
  } else if (!json.contains("section") &&
             (json.contains("shape") || json.contains("outline") || json.contains("area"))) {
    // The file contains only a section.
    found.place = "";
    Json section = json;
    for (const char* key : {"poisson", "young", "density", "title", "notes", "kind"})
      section.erase(key);
    found.file.json = section_alone(section, json);
  }
  return found;
}

SectionMaterial material_of(const CaseFile& file) {
  const Json& json = file.json;
  const Json regions = json.at("section").value("regions", Json::array());
  const bool own = !regions.empty() && !json.at("section").contains("outline") &&
                   !json.at("section").contains("file");
  const auto first = [&](const char* key) -> std::optional<double> {
    if (json.contains(key)) return json.at(key).get<double>();
    if (own && regions[0].contains(key)) return regions[0].at(key).get<double>();
    return {};
  };
  const auto poisson = first("poisson");
  if (!poisson)
    file.refuse(Pointer("/poisson"),
                "is missing: must be Poisson's ratio, above -1 and at most 0.5");
  return {.poisson = *poisson, .young = first("young"), .density = first("density")};
}

/// Cowper's κ for shear along z; empty for outlines.
std::optional<double> cowper(const CaseFile& file, double poisson, bool along_y) {
  const Json& s = file.json.at("section");
  const std::string shape = s.value("shape", "");
  const bool round = shape == "circle" || shape == "tube";
  if (shape.empty() || shape == "polygon" || poisson >= 0.5) return {};
  if (along_y && !round && shape != "rectangle") return {};
  return parse_sized_section(file, Pointer("/section"), poisson).shear_coefficient;
}

Report pair(const Eigen::Vector2d& v) {
  return {v.x(), v.y()};
}

Report as_json(const Found& found, const MeshedSection& section, const SectionMaterial& material) {
  const fem::SectionAnalysis& a = section.analysis;
  const fem::SectionProperties& p = a.properties;
  const fem::PrincipalAxes axes = fem::principal_axes(p.second_moments);
  const fem::ShearFlexibility& s = p.shear_flexibility;
  Report levels = Report::array();
  for (const fem::SectionLevel& level : a.levels) {
    const fem::SectionProperties& q = level.properties;
    levels.push_back({{"nodes", level.nodes},
                      {"torsion_constant", q.torsion_constant},
                      {"warping_constant", q.warping_constant},
                      {"shear_centre", pair(q.shear_centre)},
                      {"alpha_yy", q.shear_flexibility.yy},
                      {"alpha_zz", q.shear_flexibility.zz},
                      {"alpha_yz", q.shear_flexibility.yz}});
  }
  Report out = {
      {"title", found.title},
      {"poisson", material.poisson},
      {"area", p.area},
      {"geometric_area", p.geometric_area},
      {"shear_area", p.shear_area},
      {"centroid", pair(p.centroid)},
      {"second_moments",
       {{"yy", p.second_moments.yy}, {"zz", p.second_moments.zz}, {"yz", p.second_moments.yz}}},
      {"principal",
       {{"largest", axes.largest}, {"smallest", axes.smallest}, {"angle", axes.angle}}},
      {"torsion_constant", p.torsion_constant},
      {"warping_constant", p.warping_constant},
      {"shear_centre", pair(p.shear_centre)},
      {"trefftz_centre", pair(p.trefftz_centre)},
      {"shear_coefficients", {{"y", 1.0 / s.yy}, {"z", 1.0 / s.zz}, {"yz", s.yz}}}};
  Report by_cowper = Report::object();
  if (const auto y = cowper(found.file, material.poisson, true)) by_cowper["y"] = *y;
  if (const auto z = cowper(found.file, material.poisson, false)) by_cowper["z"] = *z;
  if (!by_cowper.empty()) out["shear_coefficients_cowper"] = by_cowper;
  if (material.density) out["mass_per_length"] = p.mass_per_length;
  if (material.young) out["young"] = *material.young;
  out["errors"] = {{"torsion_constant", a.errors.torsion_constant},
                   {"warping_constant", a.errors.warping_constant},
                   {"shear_centre", a.errors.shear_centre},
                   {"shear_coefficients", a.errors.shear_flexibility}};
  out["converged"] = a.converged;
  out["meshes"] = levels;
  return out;
}

/// A number as text; values below the rounding error `least` are zero.
std::string figure(double x, double least = 0.0) {
  return std::abs(x) <= least ? "0" : significant(x, 6);
}

void print_section(const Found& found, const MeshedSection& section,
                   const SectionMaterial& material) {
  const fem::SectionAnalysis& a = section.analysis;
  const fem::SectionProperties& p = a.properties;
  const fem::PrincipalAxes axes = fem::principal_axes(p.second_moments);
  const fem::ShearFlexibility& s = p.shear_flexibility;
  const bool composite = section.outline.regions.size() > 1;
  const double size = std::sqrt((axes.largest + axes.smallest) / p.area), none = 1e-5 * size;
  const auto point = [&](const Eigen::Vector2d& v) {
    return "(" + figure(v.x(), none) + ", " + figure(v.y(), none) + ")";
  };
  const auto line = [](const std::string& what, const std::string& symbol, const std::string& value,
                       const std::string& unit, const std::string& note = "") {
    // Pad by the number of characters, not of bytes.
    const auto padded = [](const std::string& text, std::size_t width) {
      const auto characters = static_cast<std::size_t>(std::ranges::count_if(
          text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
      return text + std::string(characters < width ? width - characters : 1, ' ');
    };
    std::cout << "  " << padded(what, 34) << padded(symbol, 7) << padded(value, 26)
              << (note.empty() ? unit : padded(unit, 5) + note) << '\n';
  };
  if (!found.title.empty()) std::cout << found.title << "\n\n";
  line("area", "A", figure(p.area), "m²");
  if (composite) line("  without moduli", "", figure(p.geometric_area), "m²");
  line("centroid (y, z)", "", point(p.centroid), "m", "in the outline's axes");
  const fem::SecondMoments& i = p.second_moments;
  line("second moments: bending about y", "Iyy", figure(i.yy), "m⁴", "∫ z²");
  line("                bending about z", "Izz", figure(i.zz), "m⁴", "∫ y²");
  line("                product", "Iyz", figure(i.yz, 1e-9 * axes.largest), "m⁴", "∫ y z");
  line("principal axes: largest", "I1", figure(axes.largest), "m⁴",
       figure(axes.angle * 180.0 / std::numbers::pi, 1e-6) + "° from y");
  line("                smallest", "I2", figure(axes.smallest), "m⁴");
  line("torsion constant", "J", figure(p.torsion_constant), "m⁴");
  line("warping constant", "Γ",
       figure(p.warping_constant, 1e-9 * std::pow(axes.largest + axes.smallest, 2) / p.area), "m⁶",
       "about the shear centre");
  line("shear centre (y, z)", "", point(p.shear_centre), "m", "from the centroid");
  line("shear coefficient: force along y", "κy", figure(1.0 / s.yy), "", "by energy");
  line("                   force along z", "κz", figure(1.0 / s.zz), "", "by energy");
  line("  coupling", "1/κyz", figure(s.yz, 1e-5), "");
  const auto y = cowper(found.file, material.poisson, true),
             z = cowper(found.file, material.poisson, false);
  if (y) line("                   force along y", "κy", figure(*y), "", "after Cowper");
  if (z) line("                   force along z", "κz", figure(*z), "", "after Cowper");
  if (material.density) line("mass", "", figure(p.mass_per_length), "kg/m");
  std::cout << "\nPoisson's ratio " << significant(material.poisson, 6) << ". ";
  if (composite)
    std::cout << "Properties are weighted by E / E_ref (J by G / G_ref)"
              << (material.young ? ",\nE_ref = " + significant(*material.young, 6) + " Pa" : "")
              << ". ";
  std::cout << "Computed with quadratic triangles on " << a.levels.size() << " meshes of up to "
            << a.levels.back().nodes << " nodes;\n";
  std::cout << "the last refinement changed no value by more than "
            << significant(100.0 * a.errors.largest(), 2) << " %.\n";
}

/// The value that the last mesh refinement changed most: "the torsion constant by 2.5 %".
std::string least_settled(const fem::SectionErrors& errors) {
  const std::vector<std::pair<double, const char*>> figures = {
      {errors.torsion_constant, "torsion constant"},
      {errors.warping_constant, "warping constant"},
      {errors.shear_centre, "shear centre"},
      {errors.shear_flexibility, "shear coefficients"}};
  const auto& most = *std::ranges::max_element(figures);
  return std::string("the ") + most.second + " by " + significant(100.0 * most.first, 2) + " %";
}

/// The drawing as an HTML page in the style of reports.
std::string section_page(const MeshedSection& section, const std::string& title) {
  const fem::SectionProperties& p = section.analysis.properties;
  const auto of = [](double x, const char* unit) { return significant(x, 5) + " " + unit; };
  const std::string figure = section_figure(section, title);
  return page_head(title.empty() ? "Cross-section" : title,
                   "A = " + of(p.area, "m²") + ", I_yy = " + of(p.second_moments.yy, "m⁴") +
                       ", I_zz = " + of(p.second_moments.zz, "m⁴"),
                   {"I_yz = " + of(p.second_moments.yz, "m⁴") +
                    ", torsion constant J = " + of(p.torsion_constant, "m⁴") +
                    ", warping constant " + of(p.warping_constant, "m⁶") +
                    "; shear centre from the centroid: (" + significant(p.shear_centre.x(), 5) +
                    ", " + significant(p.shear_centre.y(), 5) + ") m."}) +
         "<h2>The section and its mesh</h2>\n<div class=\"panel\">" + figure + "</div>\n" +
         page_end();
}

}  // namespace

void run_section(const CommonOptions& common, const SectionOptions& options) {
  const CaseFile file = read_case(common.case_path, common.overrides);
  Found found = find_section(file, options.name);
  try {
    validate_against_schema(found.file, "section");
    const SectionMaterial material = material_of(found.file);
    if (found.file.json.at("section").value("shape", "").empty())
      found.file.refuse(
          Pointer("/section/shape"),
          "is missing: without a shape, the case must already contain the properties");
    if (const auto odd =
            identification::implausible_material("the section", material.young, material.density))
      warn_of({*odd});
    const MeshedSection section = analyse(found.file, Pointer("/section"), material);
    if (const fem::SectionAnalysis& a = section.analysis; !a.converged)
      found.file.refuse(
          Pointer("/section"),
          "the properties of the section did not converge: the last mesh refinement changed " +
              least_settled(a.errors) +
              ". Leave out unimportant details of the outline, such as very short "
              "edges and very thin parts");
    if (!common.output.empty())
      write_text(common.output, common.output.extension() == ".html"
                                    ? section_page(section, found.title)
                                    : section_figure(section, found.title));
    if (options.json)
      std::cout << as_json(found, section, material).dump(2) << '\n';
    else
      print_section(found, section, material);
  } catch (const Failure& failure) {
    // The message must name the section's location in the case.
    std::string line = failure.what();
    const std::string stood = file.path.string() + ": /section";
    if (found.place != "/section" && line.starts_with(stood))
      line = file.path.string() + ": " + found.place + line.substr(stood.size());
    throw Failure(failure.exit(), line);
  }
}

Command section_command() {
  const auto section = std::make_shared<SectionOptions>();
  return {.name = "section",
          .summary = "compute properties of the case's cross-section from its outline",
          .add_options =
              [section](CommandOptions& options) {
                options.add_case();
                CLI::App& app = options.app();
                app.add_option("-o,--output", options.invocation().common.output,
                               "file for the drawing of the section")
                    ->type_name("FILE.svg|FILE.html");
                app.add_option("--name", section->name,
                               "name of the section, for a structure with several sections");
                app.add_flag("--json", section->json, "print the section properties as JSON");
              },
          .run = [section](const Invocation& asked) { run_section(asked.common, *section); }};
}

}  // namespace wheeltap::apps
