#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "apps/cases/damage_parts.hpp"
#include "apps/cases/structures/structure_case.hpp"
#include "apps/nearest.hpp"
#include "apps/whole_number.hpp"
#include "fem/structures/modes/structure_modes.hpp"
#include "identification/structural/defects/floor_mass.hpp"
#include "identification/structural/defects/member_group.hpp"
#include "identification/structural/defects/substructure.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

using Sites = DefectType::Sites;

/// Possible locations of defects: their names and sites.
struct DamagePlaces {
  std::string what;  ///< "member"
  std::vector<std::string> names;
};

class KindParser {
 public:
  KindParser(const CaseFile& file, DamageCase& out) : file_(file), out_(out) {
    if (const auto* members = std::get_if<fem::Structure>(&out.structure->nominal))
      mesh_.emplace(*members);
  }

  DefectKind parse(const Pointer& where) {
    const Json& b = file_.json.at(where);
    const auto type_name = b.at("kind").get<std::string>();
    const DefectType* type = find_defect_type(type_name);
    // A chain has masses instead of members.
    if (type == &defects::kMass &&
        std::holds_alternative<fem::LumpedChain>(out_.structure->nominal))
      type = &defects::kFloorMass;
    if (type == &defects::kSubstructure && mesh_) type = &defects::kMemberGroup;
    if (type == nullptr || type->place_in_structure == nullptr)
      file_.refuse(where / "kind", "unknown kind of defect; there are " + known());
    const DamagePlaces places = places_of(*type, where);
    const std::string severity(type->severity);
    for (const DefectType* other : defect_types()) {
      const std::string key(other->severity);
      if (key != severity && b.contains(key))
        file_.refuse(where / key, "a " + type_name + " has a " + severity + ", not a " + key);
    }
    refuse_unless(where, "extent", type_name, "reduction");
    refuse_unless(where, "law", type_name, "crack");
    refuse_unless(where, "fix", type_name, "support");
    refuse_unless(where, "groups", type_name, "substructure");
    if (type == &defects::kSubstructure && b.contains("groups"))
      file_.refuse(where / "groups",
                   "is allowed with members only; the parts of \"matrices\" have names");
    const int min = b["count"].value("min", 0), max = b["count"].at("max").get<int>();
    if (min > max)
      file_.refuse(where / "count" / "min", "must not exceed max, which is " + std::to_string(max));
    DefectKind kind{.type = type,
                    .name = b.value("name", std::string(type->noun)),
                    .plural = {},
                    .min_count = min,
                    .max_count = max,
                    .weights = parse_count_prior(file_, where / "count", min, max),
                    .location = inference::Uniform{0.0, 1.0},
                    .severity = DefectKind::Rigid{}};
    kind.plural = b.value("plural", b.contains("name") ? kind.name + "s" : type->noun_plural());
    kind.line = line(where, *type, places);
    if (type == &defects::kMemberGroup) kind.groups = groups(where);
    kind.location = inference::Uniform{0.0, kind.line.length()};
    if (!type->may_be_known && !b.contains(severity))
      file_.refuse(where / severity, "is missing: must be a prior");
    if (b.contains(severity) && b[severity].is_number())
      kind.severity = b[severity].get<double>();
    else if (b.contains(severity) && b[severity].is_object())
      kind.severity = bounded_prior(file_, where / severity, type->lower, type->upper,
                                    std::string(type->bounds_words));
    if (mesh_) parse_extent(file_, where, longest_member(), kind);
    if (type_name == "crack") kind.crack_law = parse_crack_law(file_, where);
    if (type_name == "support") kind.direction = direction(where / "fix");
    if (type_name == "crack") require_depths(where, kind);
    parse_truth(where, kind, places);
    return kind;
  }

 private:
  static std::string known() {
    std::string list;
    for (const DefectType* t : defect_types())
      if (t->place_in_structure != nullptr)
        list += (list.empty() ? "\"" : ", \"") + std::string(t->name) + "\"";
    return list;
  }

  void refuse_unless(const Pointer& where, const char* key, const std::string& type,
                     const char* goes_with) const {
    if (type != goes_with && file_.json.at(where).contains(key))
      file_.refuse(where / key,
                   "is allowed with \"kind\": \"" + std::string(goes_with) + "\" only");
  }

  DamagePlaces places_of(const DefectType& type, const Pointer& where) const {
    DamagePlaces out;
    const auto* chain = std::get_if<fem::LumpedChain>(&out_.structure->nominal);
    if (type.sites == Sites::links) {
      if (chain == nullptr)
        file_.refuse(where / "kind",
                     "a storey is a link of a \"chain\"; this structure is not a chain");
      out.what = "link";
      for (const auto& link : chain->links) out.names.push_back(link.name);
      return out;
    }
    const auto* matrices = std::get_if<fem::MatrixStructure>(&out_.structure->nominal);
    if (&type == &defects::kMemberGroup) {
      out.what = "substructure";
      if (!file_.json.at(where).contains("groups"))
        file_.refuse(where / "groups",
                     "is missing: must be an object that maps each substructure to its members, "
                     "{\"columns\": [\"left\", \"right\"]}");
      for (const auto& [name, members] : file_.json.at(where)["groups"].items())
        out.names.push_back(name);
      return out;
    }
    if (type.sites == Sites::substructures) {
      if (matrices == nullptr)
        file_.refuse(where / "kind",
                     "a substructure is a part of \"matrices\" or a group of members; use "
                     "\"storey\" for a \"chain\"");
      out.what = "substructure";
      for (const auto& part : matrices->parts) out.names.push_back(part.name);
      return out;
    }
    if (chain != nullptr && &type == &defects::kFloorMass) {
      out.what = "mass";
      for (std::size_t i = 0; i < chain->masses.size(); ++i)
        out.names.push_back("mass " + std::to_string(i + 1));
      return out;
    }
    if (!mesh_)
      file_.refuse(where / "kind", chain
                                       ? "needs members; use \"storey\" or \"mass\" for a \"chain\""
                                       : "needs members; use \"substructure\" for \"matrices\"");
    const fem::Structure& s = mesh_->structure();
    if (type.sites == Sites::nodes) {
      out.what = "node";
      for (const auto& node : s.nodes) out.names.push_back(node.name);
    } else {
      out.what = "member";
      for (const auto& member : s.members) out.names.push_back(member.name);
    }
    return out;
  }

  int find(const Pointer& where, const DamagePlaces& places, const std::string& name) const {
    const auto found = std::ranges::find(places.names, name);
    if (found != places.names.end()) return static_cast<int>(found - places.names.begin());
    file_.refuse(where,
                 "there is no " + places.what + " of this name" + did_you_mean(name, places.names));
  }

  /// Parses a site: its name, or its number in the order of the case.
  int site_of(const Pointer& where, const DamagePlaces& places) const {
    const Json& named = file_.json.at(where);
    if (!named.is_number()) return find(where, places, named.get<std::string>());
    const auto last = static_cast<std::int64_t>(places.names.size()) - 1;
    const auto number = whole_number(named.get<double>(), 0, last);
    if (!number)
      file_.refuse(where, "must be the name of a " + places.what + ", or its number from 0 to " +
                              std::to_string(last));
    return static_cast<int>(*number);
  }

  /// Members of each group, in the order of their names.
  std::vector<std::vector<int>> groups(const Pointer& where) const {
    DamagePlaces members{.what = "member", .names = {}};
    for (const auto& member : mesh_->structure().members) members.names.push_back(member.name);
    std::vector<std::vector<int>> out;
    for (const auto& [name, list] : file_.json.at(where)["groups"].items()) {
      const Pointer at = where / "groups" / name;
      out.emplace_back();
      for (std::size_t i = 0; i < list.size(); ++i) {
        const int member = find(at / i, members, list[i].get<std::string>());
        if (std::ranges::find(out.back(), member) != out.back().end())
          file_.refuse(at / i, "is in this substructure already");
        out.back().push_back(member);
      }
      // Data could not distinguish two equal groups.
      const auto same = std::ranges::find_if(out, [&](const std::vector<int>& other) {
        return std::ranges::is_permutation(other, out.back());
      });
      if (same != std::prev(out.end()))
        file_.refuse(at, "has the same members as another substructure");
    }
    return out;
  }

  SiteLine line(const Pointer& where, const DefectType& type, const DamagePlaces& places) const {
    const Json& b = file_.json.at(where);
    if (places.names.empty())
      file_.refuse(where / "kind",
                   "the structure has no " + places.what + " for this kind of defect");
    std::vector<int> sites;
    std::vector<double> weights;
    if (!b.contains("on")) {
      sites.resize(places.names.size());
      std::iota(sites.begin(), sites.end(), 0);
    } else if (b["on"].is_array()) {
      for (std::size_t i = 0; i < b["on"].size(); ++i)
        sites.push_back(find(where / "on" / i, places, b["on"][i].get<std::string>()));
    } else {
      for (const auto& [name, weight] : b["on"].items()) {
        if (!(weight.get<double>() > 0.0)) continue;
        sites.push_back(find(where / "on" / name, places, name));
        weights.push_back(weight.get<double>());
      }
      if (sites.empty()) file_.refuse(where / "on", "at least one weight must be > 0");
    }
    // In the order of the case, without duplicates.
    std::vector<std::size_t> order(sites.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, {}, [&](std::size_t i) { return sites[i]; });
    std::vector<int> sorted;
    std::vector<double> sorted_weights;
    std::vector<std::string> names;
    for (const std::size_t i : order) {
      if (!sorted.empty() && sorted.back() == sites[i])
        file_.refuse(where / "on",
                     "names \"" + places.names[static_cast<std::size_t>(sites[i])] + "\" twice");
      sorted.push_back(sites[i]);
      names.push_back(places.names[static_cast<std::size_t>(sites[i])]);
      if (!weights.empty()) sorted_weights.push_back(weights[i]);
    }
    if (type.sites == Sites::members) return SiteLine::of_members(*mesh_, sorted, sorted_weights);
    return SiteLine::of_points(sorted, names, sorted_weights);
  }

  fem::Direction direction(const Pointer& where) const {
    if (!file_.json.contains(where))
      file_.refuse(where,
                   "is missing: must be the direction that the support restrains, e.g. [\"y\"]");
    const auto name = file_.json.at(where)[0].get<std::string>();
    const int dimension = mesh_->structure().dimension;
    for (int d = 0; d < fem::kDirections; ++d) {
      const auto one = static_cast<fem::Direction>(d);
      const bool in_plane =
          one == fem::Direction::x || one == fem::Direction::y || one == fem::Direction::rz;
      if (dimension == 2 && !in_plane) continue;
      if (name == fem::direction_name(one, dimension) || name == fem::direction_name(one, 3))
        return one;
    }
    file_.refuse(where / 0,
                 "is not a direction of a structure of dimension " + std::to_string(dimension));
  }

  double longest_member() const {
    double longest = 0.0;
    for (int m = 0; m < static_cast<int>(mesh_->structure().members.size()); ++m)
      longest = std::max(longest, mesh_->member_length(m));
    return longest;
  }

  void require_depths(const Pointer& where, const DefectKind& kind) const {
    for (const SiteLine::Stretch& s : kind.line.stretches())
      for (const auto& piece : mesh_->structure().members[static_cast<std::size_t>(s.site)].pieces)
        if (!(piece.section.depth > 0.0))
          file_.refuse(where / "kind", "member \"" + s.name +
                                           "\": a crack needs the depth of the section; give the "
                                           "section a \"depth\", or remove the member from \"on\"");
  }

  void parse_truth(const Pointer& where, DefectKind& kind, const DamagePlaces& places) {
    const Json& b = file_.json.at(where);
    if (!b.contains("truth")) return;
    const Json& t = b["truth"];
    const Pointer list_at = t.is_array() ? where / "truth" : where / "truth" / "defects";
    const Json& list = file_.json.at(list_at);
    out_.simulation = parse_simulation(file_, t, out_.simulation.value_or(Simulation{}));
    const std::string severity = kind.severity_name();
    for (std::size_t i = 0; i < list.size(); ++i) {
      const Pointer at = list_at / i;
      const Json& d = list[i];
      const auto number = [&](const std::string& key) {
        if (!d.contains(key) || !d[key].is_number())
          file_.refuse(at / key, "is missing: must be a number");
        return d[key].get<double>();
      };
      if (!d.contains(places.what))
        file_.refuse(at / places.what, "is missing: must be the name of a " + places.what);
      const int site = site_of(at / places.what, places);
      const bool along = kind.type->sites == Sites::members;
      const double s = along ? number("location") : 0.0;
      const double x = kind.line.x_of(site, s);
      if (std::isnan(x))
        file_.refuse(at / places.what, "is not a possible location of this kind of defect");
      if (along && !(s >= 0.0 && s <= mesh_->member_length(site)))
        file_.refuse(at / "location", "is outside the member, which is " +
                                          Json(mesh_->member_length(site)).dump() + " m long");
      DefectKind::True truth{.location = x, .severity = std::numeric_limits<double>::infinity()};
      if (!kind.type->may_be_known || d.contains(severity)) truth.severity = number(severity);
      if (!(truth.severity >= kind.type->lower && truth.severity <= kind.type->upper) &&
          std::isfinite(truth.severity))
        file_.refuse(at / severity, std::string(kind.type->bounds_words));
      truth.extent = true_extent(file_, at, kind);
      kind.truth.push_back(truth);
    }
    std::ranges::sort(kind.truth, {}, &DefectKind::True::location);
  }

  const CaseFile& file_;
  DamageCase& out_;
  std::optional<fem::Mesh> mesh_;
};

}  // namespace

void check_structure_modes(const CaseFile& f, DamageCase& out) {
  try {
    const fem::Discretisation d = discretise(out.structure->nominal);
    out.rigid_body_modes = static_cast<int>(d.rigid_motions.cols());
    int most_supports = 0;  // each may be rigid, which removes a mode
    for (const DefectKind& kind : out.kinds)
      if (kind.type->may_be_known)
        most_supports += std::max(kind.max_count, static_cast<int>(kind.truth.size()));
    const auto most = static_cast<int>(fem::mode_count(d)) - out.rigid_body_modes - most_supports;
    if (!out.states() && out.modes() > most)
      f.refuse(out.data.modes() > 0 ? Pointer("/data") : Pointer("/data/modes"),
               std::to_string(out.modes()) + " modes: must be at most " + std::to_string(most) +
                   ", the number of elastic modes of this mesh" +
                   (most_supports > 0 ? " that remain with rigid supports" : "") +
                   "; refine \"elements\"");
  } catch (const fem::InvalidStructure& error) {
    refuse_structure(f, out.structure->nominal, error);
  }
}

void parse_extent(const CaseFile& file, const Pointer& where, double most,
                  identification::DefectKind& kind) {
  const Json& b = file.json.at(where);
  if (!b.contains("extent")) return;
  const std::string allowed =
      "an extent lies in [0, " + Json(most).dump() + "] m, up to the member's length";
  if (b["extent"].is_number()) {
    kind.extent = b["extent"].get<double>();
    if (*kind.extent > most) file.refuse(where / "extent", allowed);
  }
  if (b["extent"].is_object())
    kind.extent_prior = bounded_prior(file, where / "extent", 0.0, most, allowed);
}

double true_extent(const CaseFile& file, const Pointer& where, const DefectKind& kind) {
  const Json& d = file.json.at(where);
  if (!kind.extent_prior) {
    if (d.contains("extent"))
      file.refuse(where / "extent", "is not an unknown of this kind of defect");
    return 0.0;
  }
  if (!d.contains("extent") || !d["extent"].is_number())
    file.refuse(where / "extent", "is missing: must be a number");
  if (!(d["extent"].get<double>() > 0.0)) file.refuse(where / "extent", "must be positive");
  if (const double length = kind.line.length(); d["extent"].get<double>() > length)
    file.refuse(where / "extent", "must be at most " + Json(length).dump() + " m");
  return d["extent"].get<double>();
}

const fem::CrackLaw* parse_crack_law(const CaseFile& file, const Pointer& where) {
  if (!file.json.at(where).contains("law")) return &fem::crack_laws()[0];
  if (const fem::CrackLaw* law =
          fem::find_crack_law(file.json.at(where / "law").get<std::string>()))
    return law;
  std::string list;
  for (const fem::CrackLaw& law : fem::crack_laws())
    list += (list.empty() ? "\"" : ", \"") + std::string(law.name) + "\"";
  file.refuse(where / "law", "unknown crack law; there are " + list);
}

void parse_structure_kinds(const CaseFile& file, DamageCase& out, std::vector<Pointer>& kinds) {
  KindParser parser(file, out);
  const Json damage = file.json.value("damage", Json::array());
  const Pointer at("/damage");
  if (!damage.is_array()) {
    kinds.push_back(at);
    out.kinds.push_back(parser.parse(at));
    return;
  }
  for (std::size_t i = 0; i < damage.size(); ++i) {
    kinds.push_back(at / i);
    out.kinds.push_back(parser.parse(kinds.back()));
  }
}

}  // namespace wheeltap::apps
