#include "signals/modal/average_linkage.hpp"

#include <algorithm>
#include <limits>

namespace wheeltap::signals {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

}  // namespace

std::vector<std::vector<int>> average_linkage(const std::vector<int>& groups,
                                              const std::function<double(int, int)>& distance,
                                              double threshold) {
  const std::size_t n = groups.size();
  std::vector<std::vector<int>> members(n);
  std::vector<bool> alive(n, true);
  std::vector<std::vector<double>> d(n, std::vector<double>(n, kNever));
  for (std::size_t i = 0; i < n; ++i) {
    members[i] = {static_cast<int>(i)};
    for (std::size_t j = 0; j < i; ++j)
      if (groups[i] != groups[j])
        d[i][j] = d[j][i] = distance(static_cast<int>(i), static_cast<int>(j));
  }
  std::vector<std::size_t> nearest(n, 0);
  const auto look = [&](std::size_t i) {
    nearest[i] = static_cast<std::size_t>(std::ranges::min_element(d[i]) - d[i].begin());
  };
  for (std::size_t i = 0; i < n; ++i) look(i);
  while (true) {
    std::size_t best = n;
    for (std::size_t i = 0; i < n; ++i)
      if (alive[i] && (best == n || d[i][nearest[i]] < d[best][nearest[best]])) best = i;
    if (best == n || !(d[best][nearest[best]] <= threshold)) break;
    const std::size_t a = best, b = nearest[best];
    const auto na = static_cast<double>(members[a].size()),
               nb = static_cast<double>(members[b].size());
    members[a].insert(members[a].end(), members[b].begin(), members[b].end());
    alive[b] = false;
    for (std::size_t k = 0; k < n; ++k) {
      if (!alive[k] || k == a) continue;
      const double joined = (na * d[a][k] + nb * d[b][k]) / (na + nb);
      d[a][k] = d[k][a] = joined;  // infinite if either distance is infinite
      d[b][k] = d[k][b] = kNever;
    }
    d[a][b] = d[b][a] = kNever;
    for (std::size_t k = 0; k < n; ++k)
      if (alive[k] && (k == a || nearest[k] == a || nearest[k] == b)) look(k);
  }
  std::vector<std::vector<int>> out;
  for (std::size_t i = 0; i < n; ++i) {
    if (!alive[i]) continue;
    std::ranges::sort(members[i]);
    out.push_back(std::move(members[i]));
  }
  std::ranges::sort(out, {}, [](const std::vector<int>& cluster) { return cluster.front(); });
  return out;
}

}  // namespace wheeltap::signals
