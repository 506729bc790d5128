#include "apps/cases/structures/structure_section.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "apps/cases/structures/section_case.hpp"
#include "apps/law_words.hpp"
#include "fem/sections/section_shapes.hpp"

namespace wheeltap::apps {
namespace {

using fem::MemberSection;
using Values = std::span<const double>;
using OutlineKeys = std::vector<std::string>;

/// Axes count as principal if their product of inertia is below this fraction of the larger moment.
constexpr double kPrincipal = 1e-6;
/// A shear centre this close to the centroid counts as coincident (distance / radius of
/// gyration).
constexpr double kCentred = 1e-3;

class SectionParser {
 public:
  SectionParser(const CaseFile& file, Pointer where, const MaterialCoefficients& material,
                int dimension, StructureParameters& parameters)
      : file_(file),
        where_(std::move(where)),
        s_(file.json.at(where_)),
        material_(material),
        space_(dimension == 3),
        parameters_(parameters) {}

  PieceSection parse() {
    const auto shape = s_.value("shape", std::string());
    given_depth_ = optional("depth", kPositive);
    if (space_) given_torsion_ = optional("torsion_constant", kPositive);
    parse_shear();
    PieceSection out;
    if (shape.empty()) {
      out = by_stiffnesses();
    } else if (shape == "polygon") {
      allow("a polygon", {"outline", "holes", "file", "regions", "unit"});
      out = by_outline();
    } else {
      out = by_sizes(*fem::find_section_shape(shape));
    }
    out.depends = out.depends || depends_;
    const auto nominal = parameters_.nominal();
    try {
      (void)out.at(nominal);
    } catch (const std::invalid_argument& error) {
      file_.refuse(where_, error.what());
    }
    return out;
  }

 private:
  /// Rejects keys that belong to other shapes.
  void allow(const std::string& what, const OutlineKeys& sizes) const {
    static const OutlineKeys always = {"shape", "shear_coefficient", "torsion_constant", "depth"};
    for (const auto& [key, ignored] : s_.items())
      if (std::ranges::find(sizes, key) == sizes.end() &&
          std::ranges::find(always, key) == always.end())
        file_.refuse(where_ / key,
                     "is not a dimension of " + what + ", which has " + listed(sizes));
  }
  Coefficient take(const Pointer& at, const Bounds& bounds) {
    const Coefficient c = parameters_.coefficient(at, bounds);
    depends_ = depends_ || !c.known();
    return c;
  }
  Coefficient needed(const std::string& key, const std::string& what, const OutlineKeys& sizes) {
    if (!s_.contains(key))
      file_.refuse(where_ / key, "is missing: " + what + " has " + listed(sizes) + "; write \"" +
                                     key + "\" with its value in SI units");
    return take(where_ / key, kPositive);
  }
  std::optional<Coefficient> optional(const char* key, const Bounds& bounds) {
    if (!s_.contains(key)) return {};
    return take(where_ / key, bounds);
  }

  void parse_shear() {
    if (!s_.contains("shear_coefficient")) return;
    const Pointer at = where_ / "shear_coefficient";
    const Json& value = file_.json.at(at);
    if (value == "none") {
      shear_z_ = shear_y_ = Coefficient{.nominal = MemberSection::kNoShear};
    } else if (value.is_object()) {
      for (const auto& [axis, into] : {std::pair{"z", &shear_z_}, std::pair{"y", &shear_y_}}) {
        if (!value.contains(axis)) continue;
        if (!space_ && into == &shear_y_)
          file_.refuse(at / axis, "a plane structure has shear along z only");
        *into = value.at(axis) == "none" ? Coefficient{.nominal = MemberSection::kNoShear}
                                         : take(at / axis, kPositive);
      }
    } else {
      shear_z_ = take(at, kPositive);
      if (space_) shear_y_ = shear_z_;
    }
  }

  PieceSection by_stiffnesses() {
    const OutlineKeys sizes = {"area", "second_moment", "second_moments"};
    const std::string what = "a section without a shape";
    allow(what, sizes);
    const Coefficient area =
        needed("area", what, {"area", "second_moment (or second_moments)", "shear_coefficient"});
    if (s_.contains("second_moment") == s_.contains("second_moments"))
      file_.refuse(where_ / "second_moment",
                   "give second_moment, or second_moments {\"yy\": ∫z², \"zz\": ∫y²}");
    Coefficient yy, zz;
    if (s_.contains("second_moment")) {
      if (space_)
        file_.refuse(where_ / "second_moment",
                     "in a three-dimensional structure, give second_moments {\"yy\": ∫z², \"zz\": "
                     "∫y²}");
      yy = take(where_ / "second_moment", kPositive);
    } else {
      yy = take(where_ / "second_moments" / "yy", kPositive);
      if (space_) zz = take(where_ / "second_moments" / "zz", kPositive);
    }
    if (!shear_z_ || (space_ && !shear_y_))
      file_.refuse(where_ / "shear_coefficient",
                   "is missing: must be a number, \"none\" (stiff in shear)" +
                       std::string(space_ ? " or {\"y\": …, \"z\": …}" : ""));
    if (space_ && !given_torsion_)
      file_.refuse(where_ / "torsion_constant", "is missing: must be J in m⁴");
    const auto depth = given_depth_;
    const auto torsion = given_torsion_.value_or(Coefficient{});
    const auto shear_z = *shear_z_, shear_y = shear_y_.value_or(*shear_z_);
    return {.at = [=](Values v) {
      return MemberSection{.area = area.at(v),
                           .second_moment_y = yy.at(v),
                           .second_moment_z = zz.at(v),
                           .torsion_constant = torsion.at(v),
                           .shear_coefficient_z = shear_z.at(v),
                           .shear_coefficient_y = shear_y.at(v),
                           .depth = depth ? depth->at(v) : 0.0};
    }};
  }

  PieceSection by_sizes(const fem::SectionShape& shape) {
    const std::string what = "a \"" + shape.name + "\" section";
    allow(what, shape.sizes);
    std::vector<Coefficient> sizes;
    for (const std::string& key : shape.sizes) sizes.push_back(needed(key, what, shape.sizes));
    if (!shear_z_ || (space_ && !shear_y_)) depends_ = depends_ || !material_.poisson.known();
    const bool mesh_torsion = space_ && !given_torsion_ && shape.torsion_constant == nullptr;
    const bool mesh_shear = space_ && !shear_y_ && shape.shear_coefficient_y == nullptr;
    Coefficient torsion = given_torsion_.value_or(Coefficient{});
    std::optional<Coefficient> shear_y = shear_y_;
    if (mesh_torsion || mesh_shear) {
      for (std::size_t i = 0; i < sizes.size(); ++i)
        if (!sizes[i].known())
          file_.refuse(where_ / shape.sizes[i],
                       "must be a number: " + what +
                           " needs a mesh for its torsion and its shear along y; or give "
                           "torsion_constant and shear_coefficient");
      const MeshedSection meshed = mesh(mesh_shear);
      if (mesh_torsion) torsion.nominal = meshed.analysis.properties.torsion_constant;
      if (mesh_shear)
        shear_y = Coefficient{.nominal = 1.0 / meshed.analysis.properties.shear_flexibility.yy};
    }
    const bool given_torsion = given_torsion_ || mesh_torsion;
    const fem::SectionShape* const formulas = &shape;  // element of a static list
    return {.at = [=, space = space_, shear_z = shear_z_, depth = given_depth_,
                   poisson = material_.poisson](Values v) {
      std::vector<double> x;
      for (const Coefficient& size : sizes) x.push_back(size.at(v));
      const double nu = poisson.at(v);
      const fem::Section plane = formulas->plane(x, nu);
      MemberSection out{.area = plane.area,
                        .second_moment_y = plane.second_moment,
                        .shear_coefficient_z = shear_z ? shear_z->at(v) : plane.shear_coefficient,
                        .depth = depth ? depth->at(v) : formulas->depth(x)};
      if (!space) return out;
      out.second_moment_z = formulas->second_moment_z(x);
      out.shear_coefficient_y = shear_y ? shear_y->at(v) : formulas->shear_coefficient_y(x, nu);
      out.torsion_constant = given_torsion ? torsion.at(v) : formulas->torsion_constant(x);
      return out;
    }};
  }

  /// Properties of the outline, computed on its mesh. With `shear`, they depend on Poisson's ratio.
  [[nodiscard]] MeshedSection mesh(bool shear) const {
    CaseFile bare = file_;
    Json& section = bare.json.at(where_);
    for (const char* key : {"shear_coefficient", "torsion_constant", "depth"}) section.erase(key);
    bool composite_young = false, composite_density = false;
    for (const Json& region : section.value("regions", Json::array())) {
      composite_young = composite_young || region.contains("young");
      composite_density = composite_density || region.contains("density");
    }
    const auto must_be_known = [&](const Coefficient& c, const char* key, bool matters) {
      if (matters && !c.known())
        file_.refuse(where_,
                     std::string("the section is meshed once: ") + key +
                         " of its material must be a number, not a parameter" +
                         (key == std::string("poisson") ? "; or give shear_coefficient" : ""));
    };
    must_be_known(material_.poisson, "poisson", shear || section.contains("regions"));
    must_be_known(material_.young, "young", composite_young);
    must_be_known(material_.density, "density", composite_density);
    if (composite_density && !(material_.density.nominal > 0.0))
      file_.refuse(where_,
                   "has parts with a density: the material of the section also needs a density");
    MeshedSection meshed = analyse(bare, where_,
                                   {.poisson = material_.poisson.nominal,
                                    .young = material_.young.nominal,
                                    .density = reference_density()});
    if (!meshed.analysis.converged)
      file_.refuse(where_,
                   "the properties of the section did not converge: remove unimportant details of "
                   "the outline "
                   "(see wheeltap section)");
    return meshed;
  }

  /// The reference density; 1 for parts without mass, because only the ratio of densities matters.
  [[nodiscard]] double reference_density() const {
    return material_.density.nominal > 0.0 ? material_.density.nominal : 1.0;
  }

  PieceSection by_outline() {
    const MeshedSection meshed = mesh(!shear_z_ || (space_ && !shear_y_));
    const fem::SectionProperties& p = meshed.analysis.properties;
    const fem::SecondMoments& i = p.second_moments;
    PieceSection out;
    if (space_ && std::abs(i.yz) > kPrincipal * std::max(i.yy, i.zz)) {
      const double angle = fem::principal_axes(i).angle;
      file_.refuse(where_,
                   "the axes y and z of the section are not principal axes: they are rotated by " +
                       plain_number(angle) +
                       " rad. Define the outline in its principal axes, and rotate the "
                       "direction \"up\" of each member by the same angle");
    }
    const double gyration = std::sqrt((i.yy + i.zz) / p.area);
    if (space_ && p.shear_centre.norm() > kCentred * gyration)
      out.remarks.push_back("the shear centre of section " + where_.back() + " is " +
                            plain_number(std::round(1e4 * p.shear_centre.norm()) / 10.0) +
                            " mm from its centroid; the member model neglects this distance, so "
                            "that bending causes no twist");
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const fem::Region& region : meshed.outline.regions)
      for (const auto& corner : region.outer) {
        low = std::min(low, corner.y());
        high = std::max(high, corner.y());
      }
    // The shear stiffness κ G A uses G of the reference material and the weighted A.
    const double weight = p.shear_area / p.area;
    MemberSection section{.area = p.area,
                          .second_moment_y = i.yy,
                          .second_moment_z = i.zz,
                          .torsion_constant = p.torsion_constant,
                          .shear_coefficient_z = weight / p.shear_flexibility.zz,
                          .shear_coefficient_y = weight / p.shear_flexibility.yy,
                          .depth = high - low};
    out.density_factor = p.mass_per_length / p.area / reference_density();
    out.at = [section, depth = given_depth_, torsion = given_torsion_, shear_z = shear_z_,
              shear_y = shear_y_](Values v) {
      MemberSection at = section;
      if (depth) at.depth = depth->at(v);
      if (torsion) at.torsion_constant = torsion->at(v);
      if (shear_z) at.shear_coefficient_z = shear_z->at(v);
      if (shear_y) at.shear_coefficient_y = shear_y->at(v);
      return at;
    };
    return out;
  }

  const CaseFile& file_;
  const Pointer where_;
  const Json& s_;
  const MaterialCoefficients& material_;
  const bool space_;
  StructureParameters& parameters_;
  bool depends_ = false;
  std::optional<Coefficient> given_depth_, given_torsion_, shear_z_, shear_y_;
};

}  // namespace

PieceSection parse_piece_section(const CaseFile& file, const Pointer& where,
                                 const MaterialCoefficients& material, int dimension,
                                 StructureParameters& parameters) {
  return SectionParser(file, where, material, dimension, parameters).parse();
}

}  // namespace wheeltap::apps
