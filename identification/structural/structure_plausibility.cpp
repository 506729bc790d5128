#include "identification/structural/structure_plausibility.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>
#include <utility>

#include "base/index.hpp"

namespace wheeltap::identification {
namespace {

using fem::Vector3;
using Property = remark::ImplausibleMaterial::Property;

constexpr double kYoung[] = {5e8, 1.3e12};    // Pa: soft plastics to diamond
constexpr double kDensity[] = {20.0, 2.5e4};  // kg/m³: foam to iridium
constexpr double kFastest = 2e4;              // √(E/ρ) in m/s; diamond: 17 000
constexpr double kDeepMember = 3.0;           // height over length
constexpr double kTouching = 1e-6;            // relative to the structure's size

struct Unit {
  const char* name;
  double si;
};
// Alternative units, the most probable first.
constexpr Unit kOfYoung[] = {{"GPa", 1e9}, {"MPa (N/mm²)", 1e6}, {"kPa", 1e3}, {"psi", 6894.757}};
constexpr Unit kOfDensity[] = {{"g/cm³ (t/m³)", 1e3}, {"kg/mm³", 1e9}, {"t/mm³", 1e12}};

bool within(double x, const double (&range)[2]) {
  return x >= range[0] && x <= range[1];
}

remark::ImplausibleMaterial outside(const std::string& of, Property property, double value,
                                    const double (&range)[2], std::span<const Unit> units) {
  remark::ImplausibleMaterial out{
      .of = of, .property = property, .value = value, .lowest = range[0], .highest = range[1]};
  for (const Unit& unit : units) {
    if (!within(value * unit.si, range)) continue;
    out.unit = unit.name;
    out.converted = value * unit.si;
    break;
  }
  return out;
}

// Height of a rectangular section.
double height_of(double second_moment, double area) {
  return std::sqrt(12.0 * second_moment / area);
}

void judge_materials(const fem::Structure& structure, std::vector<Remark>& remarks) {
  std::map<std::pair<double, double>, std::vector<std::string>> members;
  for (const fem::Member& m : structure.members) {
    for (const fem::Member::Piece& piece : m.pieces) {
      auto& names = members[{piece.material.young, piece.material.density}];
      if (names.empty() || names.back() != m.name) names.push_back(m.name);
    }
  }
  for (const auto& [material, names] : members) {
    std::string of = "member \"" + names[0] + "\"";
    if (names.size() > 1)
      of += " and " + std::to_string(names.size() - 1) + (names.size() > 2 ? " others" : " other");
    if (const auto odd = implausible_material(of, material.first, material.second))
      remarks.emplace_back(*odd);
  }
}

void judge_depths(const fem::Structure& structure, std::vector<Remark>& remarks) {
  for (std::size_t i = 0; i < structure.members.size(); ++i) {
    const fem::Member& m = structure.members[i];
    const double length = fem::member_frame(structure, static_cast<int>(i)).length;
    for (const fem::Member::Piece& piece : m.pieces) {
      const double height = height_of(piece.section.second_moment_y, piece.section.area);
      if (!(height > kDeepMember * length)) continue;
      remarks.emplace_back(remark::DeepSection{"member \"" + m.name + "\"", height, length});
      return;  // one remark suffices
    }
  }
}

void judge_nodes(const fem::Structure& structure, std::vector<Remark>& remarks) {
  std::vector<bool> joined(structure.nodes.size(), false);
  const auto join = [&](int node) {
    if (node >= 0) joined[index(node)] = true;
  };
  for (const fem::Member& m : structure.members) join(m.nodes[0]), join(m.nodes[1]);
  for (const fem::NodeSpring& s : structure.springs) join(s.nodes[0]), join(s.nodes[1]);
  remark::UnusedNodes unused;
  for (std::size_t i = 0; i < joined.size(); ++i)
    if (!joined[i]) unused.nodes.push_back(structure.nodes[i].name);
  if (!unused.nodes.empty()) remarks.emplace_back(std::move(unused));
}

void judge_twins(const fem::Structure& structure, std::vector<Remark>& remarks) {
  std::map<std::pair<int, int>, std::size_t> seen;
  for (std::size_t i = 0; i < structure.members.size(); ++i) {
    const fem::Member& m = structure.members[i];
    const auto [twin, first] = seen.try_emplace(std::minmax(m.nodes[0], m.nodes[1]), i);
    if (first) continue;
    const auto& nodes = structure.nodes;
    remarks.emplace_back(remark::TwinMembers{.first = structure.members[twin->second].name,
                                             .second = m.name,
                                             .from = nodes[index(m.nodes[0])].name,
                                             .to = nodes[index(m.nodes[1])].name});
  }
}

// ---- members that intersect between their nodes -------------------------------------------------

struct Line {
  Vector3 from, to;
  std::size_t member;
  [[nodiscard]] double low() const { return std::min(from[0], to[0]); }
  [[nodiscard]] double high() const { return std::max(from[0], to[0]); }
};

struct Nearest {
  double distance, s, t;  ///< distance, and relative positions on both lines
};

// Nearest points of two segments (Ericson 2005, Real-Time Collision Detection, section 5.1.9).
Nearest nearest(const Line& p, const Line& q) {
  const Vector3 d1 = fem::difference(p.to, p.from), d2 = fem::difference(q.to, q.from),
                r = fem::difference(p.from, q.from);
  const double a = fem::dot(d1, d1), e = fem::dot(d2, d2), f = fem::dot(d2, r), c = fem::dot(d1, r),
               b = fem::dot(d1, d2), denominator = a * e - b * b;
  double s =
      denominator > 1e-12 * a * e ? std::clamp((b * f - c * e) / denominator, 0.0, 1.0) : 0.0;
  double t = (b * s + f) / e;
  if (t < 0.0) {
    t = 0.0;
    s = std::clamp(-c / a, 0.0, 1.0);
  } else if (t > 1.0) {
    t = 1.0;
    s = std::clamp((b - c) / a, 0.0, 1.0);
  }
  Vector3 apart{};
  for (std::size_t k = 0; k < 3; ++k) apart[k] = p.from[k] + s * d1[k] - q.from[k] - t * d2[k];
  return {fem::norm(apart), s, t};
}

void judge_crossings(const fem::Structure& structure, std::vector<Remark>& remarks) {
  constexpr std::size_t kTold = 4;
  std::vector<Line> lines;
  Vector3 low{}, high{};
  for (std::size_t i = 0; i < structure.nodes.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const double x = structure.nodes[i].at[k];
      low[k] = i == 0 ? x : std::min(low[k], x);
      high[k] = i == 0 ? x : std::max(high[k], x);
    }
  const double near = kTouching * fem::norm(fem::difference(high, low));
  for (std::size_t i = 0; i < structure.members.size(); ++i) {
    const auto& nodes = structure.members[i].nodes;
    lines.push_back({.from = structure.nodes[index(nodes[0])].at,
                     .to = structure.nodes[index(nodes[1])].at,
                     .member = i});
  }
  std::ranges::sort(lines, {}, &Line::low);
  remark::CrossingMembers found;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (std::size_t j = i + 1; j < lines.size() && lines[j].low() <= lines[i].high() + near; ++j) {
      const fem::Member &a = structure.members[lines[i].member],
                        &b = structure.members[lines[j].member];
      // Members with one common node meet there; members with two common nodes are duplicates.
      if (a.nodes[0] == b.nodes[0] || a.nodes[0] == b.nodes[1] || a.nodes[1] == b.nodes[0] ||
          a.nodes[1] == b.nodes[1])
        continue;
      const Nearest at = nearest(lines[i], lines[j]);
      if (!(at.distance <= near)) continue;
      const auto inner = [&](double share, const Line& line) {
        const double length = fem::norm(fem::difference(line.to, line.from));
        return share * length > near && (1.0 - share) * length > near;
      };
      // Coincident nodes of both members are separate on purpose, or one node with two names.
      const bool between = inner(at.s, lines[i]) || inner(at.t, lines[j]);
      ++found.count;
      if (found.pairs.size() == kTold) continue;
      Vector3 place = lines[i].from;
      for (std::size_t k = 0; k < 3; ++k) place[k] += at.s * (lines[i].to[k] - lines[i].from[k]);
      found.pairs.push_back({.first = a.name,
                             .second = b.name,
                             .at = {place[0], place[1], place[2]},
                             .between = between});
    }
  }
  found.dimension = structure.dimension;
  if (found.count > 0) remarks.emplace_back(std::move(found));
}

}  // namespace

std::optional<remark::ImplausibleMaterial> implausible_material(const std::string& of,
                                                                std::optional<double> young,
                                                                std::optional<double> density) {
  // A massless member with a very large modulus is a rigid link.
  const bool rigid_link = density && *density == 0.0 && young && *young > kYoung[1];
  if (young && !within(*young, kYoung) && !rigid_link)
    return outside(of, Property::young, *young, kYoung, kOfYoung);
  if (density && *density != 0.0 && !within(*density, kDensity))
    return outside(of, Property::density, *density, kDensity, kOfDensity);
  if (young && density && *density > 0.0 && std::sqrt(*young / *density) > kFastest)
    return remark::ImplausibleMaterial{.of = of,
                                       .property = Property::speed_of_sound,
                                       .value = std::sqrt(*young / *density),
                                       .lowest = 0.0,
                                       .highest = kFastest};
  return {};
}

std::vector<Remark> implausible(const fem::Beam& beam) {
  std::vector<Remark> remarks;
  if (const auto odd = implausible_material("the beam", beam.material.young, beam.material.density))
    remarks.emplace_back(*odd);
  const double height = height_of(beam.section.second_moment, beam.section.area);
  if (height > beam.length)
    remarks.emplace_back(remark::DeepSection{"the beam", height, beam.length});
  return remarks;
}

std::vector<Remark> implausible(const AnyStructure& any) {
  std::vector<Remark> remarks;
  const auto* structure = std::get_if<fem::Structure>(&any);
  if (structure == nullptr) return remarks;
  judge_materials(*structure, remarks);
  judge_depths(*structure, remarks);
  judge_nodes(*structure, remarks);
  judge_twins(*structure, remarks);
  judge_crossings(*structure, remarks);
  return remarks;
}

std::vector<Remark> implausible(const std::vector<Sensor>& sensors) {
  remark::SensorsAtOnePlace same;
  for (std::size_t i = 0; i < sensors.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (sensors[i].name == sensors[j].name) {
        same.pairs.push_back({static_cast<int>(j) + 1, static_cast<int>(i) + 1, sensors[i].name});
        break;
      }
  std::vector<Remark> remarks;
  if (!same.pairs.empty()) remarks.emplace_back(std::move(same));
  return remarks;
}

}  // namespace wheeltap::identification
