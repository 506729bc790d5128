#include "fem/structures/self_maps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "base/index.hpp"

namespace wheeltap::fem {
namespace {

constexpr double kSameCoordinate = 1e-6;  // relative to the structure's size

class MapSearch {
 public:
  explicit MapSearch(const Structure& structure) : s_(structure) {
    const std::size_t n = s_.nodes.size();
    for (const Node& node : s_.nodes)
      for (std::size_t k = 0; k < 3; ++k) centroid_[k] += node.at[k] / static_cast<double>(n);
    for (const Node& node : s_.nodes) radii_.push_back(norm(difference(node.at, centroid_)));
    tolerance_ = kSameCoordinate * *std::ranges::max_element(radii_);
    choose_references();
    for (std::size_t m = 0; m < s_.members.size(); ++m)
      members_[ends(s_.members[m].nodes[0], s_.members[m].nodes[1])].push_back(static_cast<int>(m));
  }

  std::vector<SelfMap> find() {
    std::vector<int> images;
    extend(images);
    return std::move(found_);
  }

 private:
  static std::array<int, 2> ends(int a, int b) { return {std::min(a, b), std::max(a, b)}; }
  [[nodiscard]] double distance(int a, int b) const {
    return norm(difference(s_.nodes[index(a)].at, s_.nodes[index(b)].at));
  }
  [[nodiscard]] bool same(double a, double b) const { return std::abs(a - b) <= tolerance_; }

  // Chooses nodes that span the structure together with the centroid. The first node has a distance
  // from the centroid that the fewest nodes have.
  void choose_references() {
    std::optional<int> first;
    std::ptrdiff_t fewest = 0;
    for (std::size_t i = 0; i < radii_.size(); ++i) {
      if (radii_[i] <= 1e-3 * tolerance_ / kSameCoordinate) continue;
      const auto alike =
          std::ranges::count_if(radii_, [&](double r) { return same(r, radii_[i]); });
      if (!first || alike < fewest) {
        first = static_cast<int>(i);
        fewest = alike;
      }
    }
    if (!first) return;
    references_ = {*first};
    const Vector3 along = difference(s_.nodes[index(*first)].at, centroid_);
    const auto farthest = [&](auto&& off) {
      int best = 0;
      for (std::size_t i = 1; i < s_.nodes.size(); ++i)
        if (off(static_cast<int>(i)) > off(best)) best = static_cast<int>(i);
      return best;
    };
    const auto off_line = [&](int i) {
      return norm(cross(along, difference(s_.nodes[index(i)].at, centroid_))) / norm(along);
    };
    const int second = farthest(off_line);
    if (off_line(second) <= 1e-3 * tolerance_ / kSameCoordinate) return;
    references_.push_back(second);
    const Vector3 normal = cross(along, difference(s_.nodes[index(second)].at, centroid_));
    const auto off_plane = [&](int i) {
      return std::abs(dot(normal, difference(s_.nodes[index(i)].at, centroid_))) / norm(normal);
    };
    const int third = farthest(off_plane);
    if (off_plane(third) > 1e-3 * tolerance_ / kSameCoordinate) references_.push_back(third);
  }

  // Finds images of one reference node after the other, then of all nodes.
  void extend(std::vector<int>& images) {
    if (static_cast<int>(found_.size()) >= kMostSelfMaps) return;
    if (images.size() == references_.size()) {
      if (!images.empty()) accept(images);
      return;
    }
    const int reference = references_[images.size()];
    for (int j = 0; j < static_cast<int>(s_.nodes.size()); ++j) {
      if (!same(radii_[index(j)], radii_[index(reference)])) continue;
      bool fits = true;
      for (std::size_t k = 0; fits && k < images.size(); ++k)
        fits = same(distance(j, images[k]), distance(reference, references_[k]));
      if (!fits) continue;
      images.push_back(j);
      extend(images);
      images.pop_back();
    }
  }

  void accept(const std::vector<int>& images) {
    SelfMap map;
    std::vector<bool> taken(s_.nodes.size());
    bool moves = false;
    for (int i = 0; i < static_cast<int>(s_.nodes.size()); ++i) {
      int image = -1;
      for (int j = 0; image < 0 && j < static_cast<int>(s_.nodes.size()); ++j) {
        if (taken[index(j)] || !same(radii_[index(j)], radii_[index(i)])) continue;
        bool fits = true;
        for (std::size_t k = 0; fits && k < images.size(); ++k)
          fits = same(distance(j, images[k]), distance(i, references_[k]));
        if (fits) image = j;
      }
      if (image < 0) return;
      taken[index(image)] = true;
      moves = moves || image != i;
      map.node.push_back(image);
    }
    if (!moves) return;
    std::vector<bool> used(s_.members.size());
    for (const Member& member : s_.members) {
      const int a = map.node[index(member.nodes[0])], b = map.node[index(member.nodes[1])];
      const auto between = members_.find(ends(a, b));
      if (between == members_.end()) return;
      const auto free =
          std::ranges::find_if(between->second, [&](int m) { return !used[index(m)]; });
      if (free == between->second.end()) return;
      used[index(*free)] = true;
      map.member.push_back(*free);
      map.reversed.push_back(s_.members[index(*free)].nodes[0] != a);
    }
    found_.push_back(std::move(map));
  }

  const Structure& s_;
  Vector3 centroid_ = {};
  double tolerance_ = 0.0;
  std::vector<double> radii_;
  std::vector<int> references_;
  std::map<std::array<int, 2>, std::vector<int>> members_;
  std::vector<SelfMap> found_;
};

}  // namespace

std::vector<SelfMap> self_maps(const Structure& structure) {
  if (structure.nodes.size() < 2 || static_cast<int>(structure.nodes.size()) > kMostMappedNodes)
    return {};
  std::vector<SelfMap> maps = MapSearch(structure).find();
  if (static_cast<int>(maps.size()) >= kMostSelfMaps) maps.clear();
  return maps;
}

std::vector<SelfMap> self_maps(const LumpedChain& chain) {
  const auto n = static_cast<int>(chain.masses.size());
  // The map does not change number 0, the ground.
  const auto image = [n](int mass) { return mass == 0 ? 0 : n + 1 - mass; };
  SelfMap map;
  for (int i = 0; i < n; ++i) map.node.push_back(n - 1 - i);
  std::vector<bool> used(chain.links.size());
  for (const LumpedChain::Link& link : chain.links) {
    const int a = image(link.between[0]), b = image(link.between[1]);
    int found = -1;
    for (std::size_t j = 0; found < 0 && j < chain.links.size(); ++j) {
      const auto& other = chain.links[j].between;
      const bool same = (other[0] == a && other[1] == b) || (other[0] == b && other[1] == a);
      if (same && !used[j]) found = static_cast<int>(j);
    }
    if (found < 0) return {};
    used[index(found)] = true;
    map.member.push_back(found);
    map.reversed.push_back(false);
  }
  bool moves = false;
  for (std::size_t i = 0; i < map.member.size(); ++i)
    moves = moves || map.member[i] != static_cast<int>(i);
  return moves ? std::vector<SelfMap>{map} : std::vector<SelfMap>{};
}

}  // namespace wheeltap::fem
