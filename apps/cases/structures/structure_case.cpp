#include "apps/cases/structures/structure_case.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "apps/cases/structures/matrix_case.hpp"
#include "apps/cases/structures/structure_parameters.hpp"
#include "apps/cases/structures/structure_section.hpp"
#include "apps/law_words.hpp"
#include "apps/nearest.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

using fem::Direction;

const Pointer kStructure("/structure");

/// Memory for assembly and solution, measured on plane and space frames [bytes].
constexpr double kBytesPerPlaneDof = 4e3, kBytesPerSpaceDof = 6e3;

class MemberParser {
 public:
  MemberParser(const CaseFile& file, std::vector<std::string>* remarks)
      : file_(file), json_(file.json.at(kStructure)), remarks_(remarks), parameters_(file) {}

  StructureModel parse() {
    s_.dimension = json_.value("dimension", 2);
    if (json_.value("mass", "") == "lumped") s_.mass = fem::Structure::Mass::lumped;
    s_.rotary_inertia = json_.value("rotary_inertia", true);
    if (json_.contains("rotary_inertia") && s_.mass == fem::Structure::Mass::lumped)
      file_.refuse(kStructure / "rotary_inertia", "is allowed with \"mass\": \"consistent\" only");
    parse_nodes();
    refuse_cost();
    each("members", [&](const Pointer& at) { parse_member(at); });
    each("supports", [&](const Pointer& at) { parse_support(at); });
    each("masses", [&](const Pointer& at) { parse_mass(at); });
    each("springs", [&](const Pointer& at) { parse_spring(at); });
    each("dashpots", [&](const Pointer& at) { parse_dashpot(at); });
    try {
      fem::validate(s_);
    } catch (const fem::InvalidStructure& error) {
      refuse_structure(file_, s_, error);
    }
    return std::move(parameters_).model(std::move(s_));
  }

 private:
  template <class Work>
  void each(const std::string& key, const Work& work) {
    if (!json_.contains(key)) return;
    for (std::size_t i = 0; i < json_.at(key).size(); ++i) work(kStructure / key / i);
  }
  [[nodiscard]] const Json& at(const Pointer& where) const { return file_.json.at(where); }
  [[nodiscard]] bool space() const { return s_.dimension == 3; }

  // ---- nodes and directions

  void parse_nodes() {
    const auto size = static_cast<std::size_t>(s_.dimension);
    for (const auto& [name, place] : json_.at("nodes").items()) {
      const Pointer where = kStructure / "nodes" / name;
      if (place.size() != size)
        file_.refuse(where, space() ? "must be [x, y, z]: the structure has dimension 3"
                                    : "must be [x, y]: the structure has dimension 2");
      fem::Node node{.name = name};
      const std::size_t index = s_.nodes.size();
      for (std::size_t k = 0; k < size; ++k) {
        node.at[k] = parameters_.place(where / k, {}, [index, k](AnyStructure& s, double x) {
          std::get<fem::Structure>(s).nodes[index].at[k] = x;
        });
        moving_ = moving_ || place[k].is_string();
      }
      s_.nodes.push_back(std::move(node));
    }
    // If nodes move, the lengths of a member's segments change in proportion to its length.
    if (moving_) parameters_.follow_all(stretch_members);
  }

  static void stretch_members(AnyStructure& any, std::span<const double> /*values*/) {
    auto& s = std::get<fem::Structure>(any);
    for (std::size_t m = 0; m < s.members.size(); ++m) {
      auto& pieces = s.members[m].pieces;
      const double factor = fem::member_frame(s, static_cast<int>(m)).length / pieces.back().to;
      for (fem::Member::Piece& piece : pieces) piece.to *= factor;
    }
  }

  int find_node(const Pointer& where) const {
    const auto name = at(where).get<std::string>();
    const auto found = std::ranges::find(s_.nodes, name, &fem::Node::name);
    if (found != s_.nodes.end()) return static_cast<int>(found - s_.nodes.begin());
    std::vector<std::string> names;
    for (const auto& node : s_.nodes) names.push_back(node.name);
    file_.refuse(where, "no node has this name" + did_you_mean(name, names));
  }

  [[nodiscard]] Direction direction(const Pointer& where, const std::string& name) const {
    static const std::vector<std::string> names = {"x", "y", "z", "rx", "ry", "rz"};
    const std::string global = name == "rotation" && !space() ? "rz" : name;
    const auto found = std::ranges::find(names, global);
    const bool there =
        found != names.end() && (space() || global == "x" || global == "y" || global == "rz");
    if (!there)
      file_.refuse(where,
                   std::string("unknown direction: a structure of dimension ") +
                       (space() ? "3 has x, y, z, rx, ry and rz" : "2 has x, y and rotation"));
    return static_cast<Direction>(found - names.begin());
  }
  [[nodiscard]] Direction direction(const Pointer& where) const {
    return direction(where, at(where).get<std::string>());
  }

  fem::Vector3 vector(const Pointer& where) const {
    const Json& list = at(where);
    if (list.size() != static_cast<std::size_t>(s_.dimension))
      file_.refuse(where, "must have " + std::to_string(s_.dimension) + " numbers, like the nodes");
    fem::Vector3 out{};
    for (std::size_t k = 0; k < list.size(); ++k) out[k] = list[k].get<double>();
    return out;
  }

  // ---- memory

  void refuse_cost() const {
    if (!json_.contains("members")) return;
    long long stations = static_cast<long long>(s_.nodes.size());
    Pointer finest;
    long long most = 0;
    for (std::size_t i = 0; i < json_.at("members").size(); ++i) {
      const auto elements = json_.at("members")[i].at("elements").get<long long>();
      stations += elements - 1;
      if (elements > most) {
        most = elements;
        finest = kStructure / "members" / i / "elements";
      }
    }
    const long long dofs = stations * (space() ? 6 : 3);
    if (dofs <= kMostDegreesOfFreedom) return;
    const double bytes =
        static_cast<double>(dofs) * (space() ? kBytesPerSpaceDof : kBytesPerPlaneDof);
    file_.refuse(finest, "the structure would have " + std::to_string(dofs) +
                             " degrees of freedom and take about " +
                             plain_number(std::ceil(bytes / 1e9)) + " GB: at most " +
                             std::to_string(kMostDegreesOfFreedom) +
                             " are allowed; use fewer elements");
  }

  // ---- members

  struct Piece {
    double to;
    std::string material = {}, section = {};
    Pointer material_at{}, section_at{};
  };

  void parse_member(const Pointer& where) {
    const Json& m = at(where);
    const std::size_t index = s_.members.size();
    fem::Member member{.name = m.value("name", "member " + std::to_string(index + 1))};
    for (const fem::Member& other : s_.members)
      if (other.name == member.name) file_.refuse(where / "name", "two members have this name");
    for (std::size_t end = 0; end < 2; ++end) member.nodes[end] = find_node(where / "nodes" / end);
    if (member.nodes[0] == member.nodes[1])
      file_.refuse(where / "nodes", "are the same node: the member has no length");
    member.elements = m.at("elements").get<int>();
    if (m.contains("up")) {
      if (!space())
        file_.refuse(where / "up",
                     "is allowed with dimension 3 only: plane members need no direction");
      member.up = vector(where / "up");
    }
    parse_ends(where, index, member);
    const auto member_at = [index](AnyStructure& any) -> fem::Member& {
      return std::get<fem::Structure>(any).members[index];
    };
    if (m.contains("axial_force"))
      member.axial_force =
          parameters_.place(where / "axial_force", {},
                            [=](AnyStructure& s, double x) { member_at(s).axial_force = x; });
    if (m.contains("foundation"))
      member.foundation =
          parameters_.place(where / "foundation", kNotNegative,
                            [=](AnyStructure& s, double x) { member_at(s).foundation = x; });
    s_.members.push_back(std::move(member));
    double length = 0.0;
    try {
      length = fem::member_frame(s_, static_cast<int>(index)).length;
    } catch (const fem::InvalidStructure& error) {
      file_.refuse(where, error.what());
    }
    for (const Piece& piece : pieces(where, length)) add_piece(index, piece);
  }

  std::vector<Piece> pieces(const Pointer& where, double length) const {
    const Json& m = at(where);
    const auto named = [&](const Pointer& here, const char* key, Piece& piece) {
      const Pointer own = here / key, common = where / key;
      const Pointer place_of_name = file_.json.contains(own) ? own : common;
      if (!file_.json.contains(place_of_name))
        file_.refuse(own,
                     std::string("is missing: must be the name of one of /structure/") + key + "s");
      const auto name = at(place_of_name).get<std::string>();
      const Json& all = json_.value(std::string(key) + "s", Json::object());
      if (!all.contains(name)) {
        std::vector<std::string> names;
        for (const auto& [one, ignored] : all.items()) names.push_back(one);
        file_.refuse(place_of_name,
                     std::string("no ") + key + " has this name" + did_you_mean(name, names));
      }
      const Pointer place = kStructure / (std::string(key) + "s") / name;
      (key == std::string("material") ? piece.material : piece.section) = name;
      (key == std::string("material") ? piece.material_at : piece.section_at) = place;
    };
    std::vector<Piece> list;
    if (!m.contains("pieces")) {
      Piece whole{.to = length};
      named(where, "material", whole);
      named(where, "section", whole);
      return {whole};
    }
    double before = 0.0;
    for (std::size_t p = 0; p < m.at("pieces").size(); ++p) {
      const Pointer here = where / "pieces" / p;
      const bool last = p + 1 == m.at("pieces").size();
      Piece piece{.to = length};
      if (at(here).contains("to"))
        piece.to = at(here).at("to").get<double>();
      else if (!last)
        file_.refuse(here / "to", "is missing: must be the end of the segment, in m");
      if (!(piece.to > before))
        file_.refuse(here / "to", "must be greater than the end of the previous segment, " +
                                      plain_number(before) + " m");
      if (last ? std::abs(piece.to - length) > 1e-6 * length : !(piece.to < length))
        file_.refuse(here / "to", (last ? "the last segment must end at the member's length, "
                                        : "must be less than the member's length, ") +
                                      plain_number(length) + " m");
      before = piece.to;
      named(here, "material", piece);
      named(here, "section", piece);
      list.push_back(std::move(piece));
    }
    return list;
  }

  void add_piece(std::size_t member, const Piece& piece) {
    const Pointer& m = piece.material_at;
    MaterialCoefficients material;
    material.young = parameters_.coefficient(m / "young", kPositive);
    material.poisson = parameters_.coefficient(
        m / "poisson",
        {.lower = -1.0, .upper = 0.5, .open = true, .words = "above -1 and below 0.5"});
    material.density = parameters_.coefficient(m / "density", kNotNegative);
    const auto key = std::pair(piece.material, piece.section);
    auto found = sections_.find(key);
    if (found == sections_.end()) {
      PieceSection section =
          parse_piece_section(file_, piece.section_at, material, s_.dimension, parameters_);
      if (remarks_ != nullptr)
        for (const std::string& remark : section.remarks)
          if (std::ranges::find(*remarks_, remark) == remarks_->end()) remarks_->push_back(remark);
      found = sections_.emplace(key, std::move(section)).first;
    }
    const PieceSection& section = found->second;
    const std::size_t p = s_.members[member].pieces.size();
    const double factor = section.density_factor;
    s_.members[member].pieces.push_back({.to = piece.to,
                                         .material = {.young = material.young.nominal,
                                                      .poisson = material.poisson.nominal,
                                                      .density = factor * material.density.nominal},
                                         .section = section.at(parameters_.nominal())});
    const auto piece_at = [member, p](AnyStructure& any) -> fem::Member::Piece& {
      return std::get<fem::Structure>(any).members[member].pieces[p];
    };
    parameters_.follow(material.young,
                       [=](AnyStructure& s, double x) { piece_at(s).material.young = x; });
    parameters_.follow(material.poisson,
                       [=](AnyStructure& s, double x) { piece_at(s).material.poisson = x; });
    parameters_.follow(material.density, [=](AnyStructure& s, double x) {
      piece_at(s).material.density = factor * x;
    });
    if (section.depends)
      parameters_.follow_all([=, at = section.at](AnyStructure& s, std::span<const double> values) {
        piece_at(s).section = at(values);
      });
  }

  /// Parses offsets and joints, given by the names of the member's nodes.
  void parse_ends(const Pointer& where, std::size_t index, fem::Member& member) {
    const auto end_of = [&](const Pointer& list, const std::string& name) -> std::size_t {
      for (std::size_t end = 0; end < 2; ++end)
        if (s_.nodes[static_cast<std::size_t>(member.nodes[end])].name == name) return end;
      file_.refuse(list / name, "is not an end node of this member");
    };
    const Json& m = at(where);
    const Json offsets = m.value("offsets", Json::object()), ends = m.value("ends", Json::object());
    for (const auto& [name, ignored] : offsets.items())
      member.ends[end_of(where / "offsets", name)].offset = vector(where / "offsets" / name);
    for (const auto& [name, joint] : ends.items()) {
      const Pointer here = where / "ends" / name;
      const std::size_t end = end_of(where / "ends", name);
      if (joint == "hinge") {
        member.ends[end].rotation[1] = 0.0;
        if (space()) member.ends[end].rotation[2] = 0.0;
        continue;
      }
      if (joint == "rigid") continue;
      for (const auto& [key, value] : joint.items()) {
        // A plane member bends about its local y axis, which is normal to the plane.
        const std::size_t axis = !space() ? 1 : key == "rx" ? 0 : key == "ry" ? 1 : 2;
        if (space() == (key == "rotation"))
          file_.refuse(here / key,
                       space() ? "in a three-dimensional structure, the keys of an end are \"rx\", "
                                 "\"ry\" and \"rz\", about the local axes of the member"
                               : "in a plane structure, the only key of an end is \"rotation\"");
        member.ends[end].rotation[axis] =
            parameters_.place(here / key, kNotNegative, [=](AnyStructure& s, double x) {
              std::get<fem::Structure>(s).members[index].ends[end].rotation[axis] = x;
            });
      }
    }
  }

  // ---- supports, masses, springs

  void parse_support(const Pointer& where) {
    const Json& j = at(where);
    fem::NodeSupport support{.node = find_node(where / "node")};
    const std::size_t index = s_.supports.size();
    if (!j.contains("fix") && !j.contains("stiffness"))
      file_.refuse(where / "fix", "is missing: a support needs fix, stiffness or both");
    for (std::size_t i = 0; i < j.value("fix", Json::array()).size(); ++i)
      support.fix[static_cast<std::size_t>(direction(where / "fix" / i))] = true;
    const Json springs = j.value("stiffness", Json::object());
    for (const auto& [name, ignored] : springs.items()) {
      const Pointer here = where / "stiffness" / name;
      const auto d = static_cast<std::size_t>(direction(here, name));
      if (support.fix[d])
        file_.refuse(here, "is fixed already: a direction has either a fixed support or a spring");
      support.stiffness[d] = parameters_.place(here, kNotNegative, [=](AnyStructure& s, double x) {
        std::get<fem::Structure>(s).supports[index].stiffness[d] = x;
      });
    }
    s_.supports.push_back(support);
  }

  void parse_mass(const Pointer& where) {
    const Json& j = at(where);
    fem::NodeMass mass{.node = find_node(where / "node")};
    const std::size_t index = s_.masses.size();
    const auto mass_at = [index](AnyStructure& any) -> fem::NodeMass& {
      return std::get<fem::Structure>(any).masses[index];
    };
    if (!j.contains("mass") && !j.contains("inertia"))
      file_.refuse(where / "mass", "is missing: must be a mass in kg");
    if (j.contains("mass"))
      mass.mass = parameters_.place(where / "mass", kNotNegative,
                                    [=](AnyStructure& s, double x) { mass_at(s).mass = x; });
    if (j.contains("inertia") && j.at("inertia").is_array()) {
      if (!space())
        file_.refuse(where / "inertia", "in a plane structure, must be one number, about z");
      for (std::size_t k = 0; k < 3; ++k)
        mass.inertia[k] =
            parameters_.place(where / "inertia" / k, kNotNegative,
                              [=](AnyStructure& s, double x) { mass_at(s).inertia[k] = x; });
    } else if (j.contains("inertia")) {
      const std::size_t first = space() ? 0 : 2;
      const double x =
          parameters_.place(where / "inertia", kNotNegative, [=](AnyStructure& s, double value) {
            for (std::size_t k = first; k < 3; ++k) mass_at(s).inertia[k] = value;
          });
      for (std::size_t k = first; k < 3; ++k) mass.inertia[k] = x;
    }
    s_.masses.push_back(mass);
  }

  /// Parses the nodes of a spring or a dashpot, and its direction.
  fem::NodeSpring parse_line(const Pointer& where) {
    const Json& j = at(where);
    fem::NodeSpring line;
    if (j.contains("node") == j.contains("nodes"))
      file_.refuse(where,
                   "must have \"nodes\": two names, or \"node\" and \"direction\" to ground");
    if (j.contains("node")) {
      line.nodes[0] = find_node(where / "node");
      if (!j.contains("direction"))
        file_.refuse(where / "direction", "is missing: a connection to ground needs a direction");
    } else {
      for (std::size_t end = 0; end < 2; ++end) line.nodes[end] = find_node(where / "nodes" / end);
      if (line.nodes[0] == line.nodes[1])
        file_.refuse(where / "nodes", "must be two different nodes");
    }
    if (j.contains("direction")) line.direction = static_cast<int>(direction(where / "direction"));
    return line;
  }

  void parse_spring(const Pointer& where) {
    fem::NodeSpring spring = parse_line(where);
    spring.stiffness = parameters_.place(where / "stiffness", kNotNegative,
                                         [index = s_.springs.size()](AnyStructure& s, double x) {
                                           std::get<fem::Structure>(s).springs[index].stiffness = x;
                                         });
    s_.springs.push_back(spring);
  }

  /// Validates a dashpot. Dashpots have no further use, because they do not affect undamped modes.
  void parse_dashpot(const Pointer& where) {
    (void)parse_line(where);
    (void)parameters_.coefficient(where / "damping", kNotNegative);
  }

  const CaseFile& file_;
  const Json& json_;
  std::vector<std::string>* remarks_;
  StructureParameters parameters_;
  fem::Structure s_;
  bool moving_ = false;  // the position of a node depends on a parameter
  std::map<std::pair<std::string, std::string>, PieceSection> sections_;
};

StructureModel parse_chain(const CaseFile& file) {
  const Pointer where = kStructure / "chain";
  const Json& j = file.json.at(where);
  StructureParameters parameters(file);
  fem::LumpedChain chain;
  for (std::size_t i = 0; i < j.at("masses").size(); ++i)
    chain.masses.push_back(parameters.place(
        where / "masses" / i, kPositive,
        [i](AnyStructure& s, double x) { std::get<fem::LumpedChain>(s).masses[i] = x; }));
  const auto masses = static_cast<int>(chain.masses.size());
  std::set<std::string> names;
  for (std::size_t l = 0; l < j.at("links").size(); ++l) {
    const Pointer here = where / "links" / l;
    const Json& link = file.json.at(here);
    fem::LumpedChain::Link out{.name = link.value("name", "link " + std::to_string(l + 1)),
                               .between = {},
                               .stiffness = 0.0};
    if (!names.insert(out.name).second) file.refuse(here / "name", "two links have this name");
    for (std::size_t end = 0; end < 2; ++end) {
      out.between[end] = link.at("between")[end].get<int>();
      if (out.between[end] > masses)
        file.refuse(here / "between" / end, "unknown mass: there are masses 1 to " +
                                                std::to_string(masses) + ", and 0 is the ground");
    }
    if (out.between[0] == out.between[1])
      file.refuse(here / "between", "must join two different masses");
    out.stiffness = parameters.place(here / "stiffness", kPositive, [l](AnyStructure& s, double x) {
      std::get<fem::LumpedChain>(s).links[l].stiffness = x;
    });
    if (link.contains("damping")) (void)parameters.coefficient(here / "damping", kNotNegative);
    chain.links.push_back(std::move(out));
  }
  return std::move(parameters).model(std::move(chain));
}

}  // namespace

bool has_structure(const CaseFile& file) {
  const bool structure = file.json.contains("structure");
  if (structure && file.json.contains("beam"))
    file.refuse(kStructure, "replaces \"beam\": give only one of the two keys");
  return structure;
}

StructureModel parse_structure(const CaseFile& file, std::vector<std::string>* remarks) {
  const Json& s = file.json.at(kStructure);
  // Kinds of structure and their keys.
  static const std::vector<std::pair<std::string, std::vector<std::string>>> kinds = {
      {"chain", {"chain"}},
      {"matrices", {"matrices", "mass", "stiffness", "scale", "change", "dofs"}},
      {"nodes",
       {"dimension", "materials", "sections", "nodes", "members", "supports", "masses", "springs",
        "dashpots", "mass", "rotary_inertia"}}};
  for (const auto& [kind, keys] : kinds) {
    if (!s.contains(kind)) continue;
    for (const auto& [key, ignored] : s.items())
      if (std::ranges::find(keys, key) == keys.end())
        file.refuse(kStructure / key,
                    "is not allowed with \"" + kind + "\", which has " + listed(keys));
    if (kind == "chain") return parse_chain(file);
    if (kind == "matrices") return parse_matrices(file);
    if (s.contains("mass") && s["mass"] != "consistent" && s["mass"] != "lumped")
      file.refuse(kStructure / "mass", "must be \"consistent\" or \"lumped\"");
    return MemberParser(file, remarks).parse();
  }
  file.refuse(kStructure, "must have \"nodes\" (and members), a \"chain\" or \"matrices\"");
}

void refuse_structure(const CaseFile& file, const AnyStructure& structure,
                      const fem::InvalidStructure& error) {
  using Part = fem::InvalidStructure::Part;
  const auto index = static_cast<std::size_t>(error.index());
  const auto place = [&]() -> Pointer {
    if (error.part() == Part::whole) return kStructure;
    if (const auto* members = std::get_if<fem::Structure>(&structure)) {
      switch (error.part()) {
        case Part::nodes:
          return kStructure / "nodes" / members->nodes[index].name;
        case Part::members:
          return kStructure / "members" / index;
        case Part::supports:
          return kStructure / "supports" / index;
        case Part::masses:
          return kStructure / "masses" / index;
        default:
          return kStructure / "springs" / index;
      }
    }
    if (std::holds_alternative<fem::LumpedChain>(structure))
      return kStructure / "chain" / (error.part() == Part::masses ? "masses" : "links") / index;
    const auto& parts = std::get<fem::MatrixStructure>(structure).parts;
    return error.part() == Part::masses ? kStructure / "mass"
                                        : kStructure / "stiffness" / parts[index].name;
  };
  file.refuse(place(), error.what());
}

}  // namespace wheeltap::apps
