#include "identification/rival_places.hpp"

#include <algorithm>
#include <numeric>
#include <string>

namespace wheeltap::identification {
namespace {

struct Site {
  int kind, stretch;
};

// Every stretch of every kind's line, beams left out: those are told by their places.
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

PlaceProbabilities probabilities(const UnpackedDraws& draws, const std::vector<Site>& sites) {
  const std::vector<DefectKind>& kinds = draws.problem().damage_case.kinds;
  std::vector<std::size_t> first(kinds.size(), 0);  // place of each kind's first stretch
  for (std::size_t i = sites.size(); i-- > 0;) first[static_cast<std::size_t>(sites[i].kind)] = i;
  PlaceProbabilities out{std::vector<double>(sites.size()),
                         std::vector(sites.size(), std::vector<double>(sites.size()))};
  double all = 0.0;
  std::vector<std::size_t> held;
  draws.for_each([&](std::size_t c, std::size_t i) {
    const double weight = draws.weight(c, i);
    all += weight;
    held.clear();
    for (const DamageProblem::Component& component : draws.at(c, i)) {
      const auto kind = static_cast<std::size_t>(component.kind);
      const SiteLine& line = kinds[kind].line;
      if (line.is_beam()) continue;
      held.push_back(first[kind] + static_cast<std::size_t>(line.spot(component.location).stretch));
    }
    std::ranges::sort(held);
    held.erase(std::ranges::unique(held).begin(), held.end());
    for (const std::size_t a : held) {
      out.each[a] += weight;
      for (const std::size_t b : held) out.both[a][b] += weight;
    }
  });
  for (double& p : out.each) p /= all;
  for (auto& row : out.both)
    for (double& p : row) p /= all;
  return out;
}

// All of them are images of each other.
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
  constexpr double kWorthNaming = 0.05, kTogether = 0.1, kTogetherInAll = 0.5;
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

void tell_rivals(const UnpackedDraws& draws, const std::optional<SymmetryFinding>& symmetry,
                 std::vector<Remark>& remarks) {
  const std::vector<DefectKind>& kinds = draws.problem().damage_case.kinds;
  const std::vector<Site> sites = sites_of(draws.problem().damage_case);
  if (sites.empty()) return;
  std::vector<std::string> names;
  for (const Site& site : sites)
    names.push_back(kinds[static_cast<std::size_t>(site.kind)]
                        .line.stretches()[static_cast<std::size_t>(site.stretch)]
                        .name);
  const PlaceProbabilities found = probabilities(draws, sites);
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
