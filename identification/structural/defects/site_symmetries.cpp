#include "identification/structural/defects/site_symmetries.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/index.hpp"
#include "base/random.hpp"
#include "identification/structural/defects/mass.hpp"

namespace wheeltap::identification {
namespace {

using Sites = DefectType::Sites;

constexpr double kSameFrequency = 1e-9;
constexpr double kSameWithLostMass = 1e-6;  // see fem::StructureReanalysis
constexpr double kSameExtent = 1e-9;
constexpr std::uint64_t kSeed = 1;

/// The image of each stretch of a line, and whether the image is reversed.
struct LineMap {
  std::vector<int> stretch;
  std::vector<bool> turned;
};

/// Index of the group that is the image of this one; -1 if there is none.
int image_of_group(const fem::SelfMap& map, const std::vector<std::vector<int>>& groups,
                   const std::vector<int>& group) {
  std::vector<int> image;
  for (const int member : group) image.push_back(map.member[index(member)]);
  const auto found = std::ranges::find_if(groups, [&](const std::vector<int>& other) {
    return std::ranges::is_permutation(other, image);
  });
  return found == groups.end() ? -1 : static_cast<int>(found - groups.begin());
}

/// Map of a kind's line onto itself; empty if `map` does not preserve the line.
LineMap line_map(const fem::SelfMap& map, const DefectKind& kind) {
  const auto& stretches = kind.line.stretches();
  LineMap out;
  for (const SiteLine::Stretch& s : stretches) {
    const bool node = kind.type->sites == Sites::nodes;
    const bool group = kind.type->sites == Sites::substructures;
    const int image = node    ? map.node[index(s.site)]
                      : group ? image_of_group(map, kind.groups, kind.groups[index(s.site)])
                              : map.member[index(s.site)];
    const auto to = std::ranges::find(stretches, image, &SiteLine::Stretch::site);
    if (to == stretches.end()) return {};
    const double extent = s.end - s.start;
    if (std::abs(to->end - to->start - extent) > kSameExtent * extent) return {};
    out.stretch.push_back(static_cast<int>(to - stretches.begin()));
    out.turned.push_back(!node && !group && map.reversed[index(s.site)]);
  }
  return out;
}

/// True if the map moves no place, for example if each group has members on both sides.
bool is_identity(const std::vector<LineMap>& of_kinds) {
  return std::ranges::all_of(of_kinds, [](const LineMap& map) {
    for (std::size_t s = 0; s < map.stretch.size(); ++s)
      if (map.stretch[s] != static_cast<int>(s) || map.turned[s]) return false;
    return true;
  });
}

std::function<double(double)> image_on(const SiteLine& line, const LineMap& map) {
  return [line, map](double x) {
    if (!(x >= 0.0 && x <= line.length())) return std::numeric_limits<double>::quiet_NaN();
    const int from = line.stretch_of_cell(line.cell_at(x));
    const SiteLine::Stretch& a = line.stretches()[index(from)];
    const SiteLine::Stretch& b = line.stretches()[index(map.stretch[index(from)])];
    const double along = std::clamp(x - a.start, 0.0, a.end - a.start);
    return map.turned[index(from)] ? b.end - along : b.start + along;
  };
}

bool same_frequencies(const std::vector<double>& a, const std::vector<double>& b,
                      double tolerance) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)  // near-zero stiffness: rigid-body modes
    if (std::abs(a[i] - b[i]) > tolerance * std::max(a[i], 1e-6 * a.back())) return false;
  return true;
}

/// Collects, over all maps and kinds, sites that are images of each other or are reversed.
void collect_images(const std::vector<DefectKind>& kinds,
                    const std::vector<std::vector<LineMap>>& maps, SiteSymmetries& out) {
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    const auto& stretches = kinds[k].line.stretches();
    std::vector<int> group(stretches.size());
    std::iota(group.begin(), group.end(), 0);
    for (const std::vector<LineMap>& of_kinds : maps) {
      const LineMap& map = of_kinds[k];
      for (std::size_t s = 0; s < stretches.size(); ++s) {
        const int a = group[s], b = group[index(map.stretch[s])];
        std::ranges::replace(group, std::max(a, b), std::min(a, b));
        if (map.stretch[s] == static_cast<int>(s) && map.turned[s] &&
            std::ranges::find(out.turned, stretches[s].name) == out.turned.end())
          out.turned.push_back(stretches[s].name);
      }
    }
    for (std::size_t g = 0; g < stretches.size(); ++g) {
      std::vector<std::string> names;
      for (std::size_t s = 0; s < stretches.size(); ++s)
        if (group[s] == static_cast<int>(g)) names.push_back(stretches[s].name);
      if (names.size() > 1 && std::ranges::find(out.alike, names) == out.alike.end())
        out.alike.push_back(std::move(names));
    }
  }
}

}  // namespace

SiteSymmetries find_symmetries(const AnyStructure& structure, const std::vector<DefectKind>& kinds,
                               const SolveDefects& solve) {
  std::vector<fem::SelfMap> candidates;
  if (const auto* members = std::get_if<fem::Structure>(&structure))
    candidates = fem::self_maps(*members);
  if (const auto* chain = std::get_if<fem::LumpedChain>(&structure))
    candidates = fem::self_maps(*chain);

  const bool loses_mass = std::ranges::any_of(kinds, [](const DefectKind& kind) {
    return kind.type == &defects::kMass && kind.severity_prior() &&
           kind.severity_prior()->lower() < 0.0;
  });
  const double tolerance = loses_mass ? kSameWithLostMass : kSameFrequency;
  base::Random random(kSeed, 0, 0, base::Purpose::simulation);
  std::vector<std::vector<PlacedDefect>> trials;
  std::vector<PlacedDefect> all;
  for (std::size_t k = 0; k < kinds.size(); ++k)
    for (const SiteLine::Stretch& s : kinds[k].line.stretches()) {
      const double share = 0.1 + 0.8 * random.uniform();
      const inference::Prior* prior = kinds[k].severity_prior();
      const double severity =
          prior ? prior->from_standard_normal(random.normal()) : kinds[k].known_severity();
      const double extent =
          kinds[k].extent_prior ? kinds[k].extent_prior->from_standard_normal(0.0) : 0.0;
      all.push_back({static_cast<int>(k), s.start + share * (s.end - s.start), severity, extent});
      trials.push_back({all.back()});
    }
  trials.push_back(all);
  std::vector<std::vector<double>> frequencies;

  SiteSymmetries out;
  std::vector<std::vector<LineMap>> kept;
  for (const fem::SelfMap& candidate : candidates) {
    std::vector<LineMap> of_kinds;
    inference::Symmetry symmetry;
    for (std::size_t k = 0; k < kinds.size(); ++k) {
      of_kinds.push_back(line_map(candidate, kinds[k]));
      if (of_kinds.back().stretch.empty()) break;
      symmetry.parts.push_back({static_cast<int>(k), 0, image_on(kinds[k].line, of_kinds.back())});
    }
    if (symmetry.parts.size() != kinds.size() || is_identity(of_kinds)) continue;
    if (frequencies.empty())
      for (const auto& trial : trials) frequencies.push_back(solve(trial));
    bool same = true;
    for (std::size_t t = 0; same && t < trials.size(); ++t) {
      std::vector<PlacedDefect> images = trials[t];
      for (PlacedDefect& d : images) d.location = symmetry.parts[index(d.kind)].image(d.location);
      same = same_frequencies(frequencies[t], solve(images), tolerance);
    }
    if (!same) continue;
    out.maps.push_back(std::move(symmetry));
    kept.push_back(std::move(of_kinds));
  }
  collect_images(kinds, kept, out);
  return out;
}

}  // namespace wheeltap::identification
