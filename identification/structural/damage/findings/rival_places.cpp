#include "identification/structural/damage/findings/rival_places.hpp"

#include <algorithm>
#include <string>

namespace wheeltap::identification {
namespace {

constexpr double kWorthNaming = 0.05;

struct Site {
  int kind, stretch;
};

// All parts of the lines of all kinds, except beams, for which locations are reported directly.
std::vector<Site> sites_of(const DamageCase& damage_case) {
  std::vector<Site> out;
  for (std::size_t k = 0; k < damage_case.kinds.size(); ++k) {
    const SiteLine& line = damage_case.kinds[k].line;
    if (line.is_beam()) continue;
    for (std::size_t s = 0; s < line.stretches().size(); ++s)
      out.push_back({static_cast<int>(k), static_cast<int>(s)});
  }
  return out;
}

/// Calls visit(weight, sites) for every draw; `sites`: the damaged sites, sorted and unique.
template <class Visit>
void for_each_draw(const UnpackedDraws& draws, const std::vector<Site>& sites, const Visit& visit) {
  const std::vector<DefectKind>& kinds = draws.problem().damage_case.kinds;
  std::vector<std::size_t> first(kinds.size(), 0);  // index of each kind's first site
  for (std::size_t i = sites.size(); i-- > 0;) first[static_cast<std::size_t>(sites[i].kind)] = i;
  std::vector<std::size_t> held;
  draws.for_each([&](std::size_t c, std::size_t i) {
    held.clear();
    for (const DamageProblem::Component& component : draws.at(c, i)) {
      const auto kind = static_cast<std::size_t>(component.kind);
      const SiteLine& line = kinds[kind].line;
      if (line.is_beam()) continue;
      held.push_back(first[kind] + static_cast<std::size_t>(line.spot(component.location).stretch));
    }
    std::ranges::sort(held);
    held.erase(std::ranges::unique(held).begin(), held.end());
    visit(draws.weight(c, i), held);
  });
}

/// Removes improbable sites from `sites`, because a large frame has thousands of sites. Returns the
/// probabilities of the remaining sites and of their pairs.
PlaceProbabilities probabilities(const UnpackedDraws& draws, std::vector<Site>& sites) {
  double all = 0.0;
  std::vector<double> each(sites.size());
  for_each_draw(draws, sites, [&](double weight, const std::vector<std::size_t>& held) {
    all += weight;
    for (const std::size_t a : held) each[a] += weight;
  });
  std::vector<int> among(sites.size(), -1);
  std::vector<Site> named;
  PlaceProbabilities out;
  for (std::size_t a = 0; a < sites.size(); ++a) {
    if (each[a] < kWorthNaming * all) continue;
    among[a] = static_cast<int>(named.size());
    named.push_back(sites[a]);
    out.each.push_back(each[a] / all);
  }
  out.both.assign(named.size(), std::vector<double>(named.size()));
  for_each_draw(draws, sites, [&](double weight, const std::vector<std::size_t>& held) {
    for (const std::size_t a : held)
      for (const std::size_t b : held)
        if (among[a] >= 0 && among[b] >= 0)
          out.both[static_cast<std::size_t>(among[a])][static_cast<std::size_t>(among[b])] +=
              weight / all;
  });
  sites = std::move(named);
  return out;
}

// True if all members of the group are images of each other.
bool are_images(const std::vector<int>& group, const std::vector<std::string>& names,
                const std::optional<SymmetryFinding>& symmetry) {
  return symmetry && std::ranges::any_of(symmetry->alike, [&](const auto& alike) {
           return std::ranges::all_of(group, [&](int place) {
             return std::ranges::find(alike, names[static_cast<std::size_t>(place)]) != alike.end();
           });
         });
}

}  // namespace

std::vector<std::vector<int>> exclusive_groups(const PlaceProbabilities& places) {
  constexpr double kTogether = 0.1, kTogetherInAll = 0.5;
  const auto p = [&](int i) { return places.each[static_cast<std::size_t>(i)]; };
  std::vector<int> left;
  for (int i = 0; i < static_cast<int>(places.each.size()); ++i)
    if (p(i) >= kWorthNaming) left.push_back(i);
  std::ranges::stable_sort(left, [&](int a, int b) { return p(a) > p(b); });
  std::vector<std::vector<int>> groups;
  while (!left.empty()) {
    std::vector<int> group, others;
    double sum = 0.0;
    for (const int i : left) {
      const bool excluded = std::ranges::all_of(group, [&](int g) {
        return places.both[static_cast<std::size_t>(g)][static_cast<std::size_t>(i)] <=
               kTogether * std::min(p(g), p(i));
      });
      (excluded ? group : others).push_back(i);
      if (excluded) sum += p(i);
    }
    if (group.size() > 1 && sum >= kTogetherInAll) groups.push_back(std::move(group));
    left = std::move(others);
  }
  return groups;
}

void add_rival_remarks(const UnpackedDraws& draws, const std::optional<SymmetryFinding>& symmetry,
                       std::vector<Remark>& remarks) {
  const std::vector<DefectKind>& kinds = draws.problem().damage_case.kinds;
  std::vector<Site> sites = sites_of(draws.problem().damage_case);
  if (sites.empty()) return;
  const PlaceProbabilities found = probabilities(draws, sites);
  std::vector<std::string> names;
  for (const Site& site : sites)
    names.push_back(kinds[static_cast<std::size_t>(site.kind)]
                        .line.stretches()[static_cast<std::size_t>(site.stretch)]
                        .name);
  for (const std::vector<int>& group : exclusive_groups(found)) {
    if (are_images(group, names, symmetry)) continue;
    remark::RivalPlaces rivals;
    for (const int place : group) {
      const auto at = static_cast<std::size_t>(place);
      rivals.places.push_back(
          {.kind = sites[at].kind, .name = names[at], .probability = found.each[at]});
    }
    remarks.push_back(std::move(rivals));
  }
}

}  // namespace wheeltap::identification
