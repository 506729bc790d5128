#include "signals/stabilisation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "base/parallel.hpp"

namespace wheeltap::signals {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
// The threshold stays within these, whatever the distances say.
constexpr double kLeastThreshold = 0.005, kLargestThreshold = 0.08;
constexpr std::size_t kLeastMembers = 3;
constexpr double kGoodScatter = 1.25;
constexpr double kWorse = 2.0, kSameShape = 0.9;

double scatter(const Pole& p) {
  return std::sqrt(p.frequency_sd / p.frequency_hz * p.damping_sd / std::abs(p.damping));
}

double median(std::vector<double> x) {
  const auto half = x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2);
  std::nth_element(x.begin(), half, x.end());
  return *half;
}

/// Mean + 2 standard deviations of the distances, in the class that stays, to the order before.
double threshold_of(const std::vector<Pole>& poles) {
  std::vector<double> logs;
  for (const Pole& p : poles) {
    double nearest = kNever;
    for (const Pole& q : poles)
      if (q.order == p.order - 2) nearest = std::min(nearest, pole_distance(p, q));
    if (nearest > 0.0 && nearest < kNever) logs.push_back(std::log(nearest));
  }
  if (logs.size() < 4) return 0.02;
  std::ranges::sort(logs);
  const std::size_t stays = two_classes(logs);
  double mean = 0.0, square = 0.0;
  for (std::size_t i = 0; i < stays; ++i) mean += std::exp(logs[i]) / static_cast<double>(stays);
  for (std::size_t i = 0; i < stays; ++i)
    square += std::pow(std::exp(logs[i]) - mean, 2) / static_cast<double>(stays);
  return std::clamp(mean + 2.0 * std::sqrt(square), kLeastThreshold, kLargestThreshold);
}

/// Average linkage with Lance & Williams' update, up to `threshold`; poles of one order never join.
std::vector<std::vector<int>> clusters(const std::vector<Pole>& poles, double threshold) {
  const std::size_t n = poles.size();
  std::vector<std::vector<int>> members(n);
  std::vector<std::set<int>> orders(n);
  std::vector<bool> alive(n, true);
  std::vector<std::vector<double>> d(n, std::vector<double>(n, kNever));
  for (std::size_t i = 0; i < n; ++i) {
    members[i] = {static_cast<int>(i)};
    orders[i] = {poles[i].order};
    for (std::size_t j = 0; j < i; ++j)
      if (poles[i].order != poles[j].order) d[i][j] = d[j][i] = pole_distance(poles[i], poles[j]);
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
    orders[a].insert(orders[b].begin(), orders[b].end());
    alive[b] = false;
    for (std::size_t k = 0; k < n; ++k) {
      if (!alive[k] || k == a) continue;
      const double joined = (na * d[a][k] + nb * d[b][k]) / (na + nb);
      d[a][k] = d[k][a] = joined;  // infinite where either is
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
  return out;
}

int representative(const std::vector<Pole>& poles, const std::vector<int>& members) {
  std::vector<double> all;
  for (const int m : members) all.push_back(scatter(poles[static_cast<std::size_t>(m)]));
  std::vector<double> sorted = all;
  std::ranges::sort(sorted);
  const double good = kGoodScatter * sorted[sorted.size() / 10];
  std::vector<int> best;
  std::vector<double> frequencies;
  for (std::size_t i = 0; i < members.size(); ++i) {
    if (!(all[i] <= good)) continue;
    best.push_back(members[i]);
    frequencies.push_back(poles[static_cast<std::size_t>(members[i])].frequency_hz);
  }
  const double middle = median(frequencies);
  return best[static_cast<std::size_t>(std::ranges::find(frequencies, middle) -
                                       frequencies.begin())];
}

bool is_splinter(const Stabilisation& of, const ModeCluster& c, const ModeCluster& whole) {
  const Pole &a = of.poles[static_cast<std::size_t>(c.chosen)],
             &b = of.poles[static_cast<std::size_t>(whole.chosen)];
  return c.members.size() < whole.members.size() && scatter(a) > kWorse * scatter(b) &&
         std::abs(a.frequency_hz - b.frequency_hz) <
             3.0 * std::hypot(a.frequency_sd, b.frequency_sd) &&
         modal_assurance(a.shape, b.shape) > kSameShape;
}

/// Orders that are too large split a mode in two: the worse part is none of its own.
void drop_splinters(Stabilisation& of) {
  const std::vector<ModeCluster> all = of.modes;
  std::erase_if(of.modes, [&](const ModeCluster& c) {
    return std::ranges::any_of(all, [&](const ModeCluster& d) { return is_splinter(of, c, d); });
  });
}

}  // namespace

double pole_distance(const Pole& a, const Pole& b) {
  return std::abs(a.frequency_hz - b.frequency_hz) / std::max(a.frequency_hz, b.frequency_hz) +
         1.0 - modal_assurance(a.shape, b.shape);
}

std::size_t two_classes(const std::vector<double>& sorted) {
  const std::size_t n = sorted.size();
  const double total = std::accumulate(sorted.begin(), sorted.end(), 0.0);
  // Least squares within = most between: (Σ low)² / n_low + (Σ high)² / n_high.
  double low = 0.0, most = -1.0;
  std::size_t place = 1;
  for (std::size_t i = 1; i < n; ++i) {
    low += sorted[i - 1] - total / static_cast<double>(n);
    const double between =
        low * low * (1.0 / static_cast<double>(i) + 1.0 / static_cast<double>(n - i));
    if (between > most) {
      most = between;
      place = i;
    }
  }
  return place;
}

Stabilisation stabilise(const StochasticSubspace& subspace, const StabilisationOptions& options) {
  const int largest = options.largest_order > 0
                          ? std::min(options.largest_order, subspace.largest_order())
                          : subspace.largest_order();
  const int smallest = std::max(2, options.smallest_order + options.smallest_order % 2);
  Stabilisation out{.orders = std::max(0, (largest - smallest) / 2 + 1)};
  std::vector<std::vector<Pole>> by_order(static_cast<std::size_t>(out.orders));
  const PoleWindow window{.lowest_hz = options.lowest_hz,
                          .highest_hz = options.highest_hz,
                          .lowest_damping = options.lowest_damping,
                          .highest_damping = options.highest_damping};
  // The largest orders first: they take longest.
  base::parallel_for(out.orders, options.threads, [&](int i) {
    const int k = out.orders - 1 - i;
    by_order[static_cast<std::size_t>(k)] = subspace.poles(smallest + 2 * k, window);
  });
  std::vector<Pole> hard;
  std::vector<int> place;
  for (std::vector<Pole>& some : by_order)
    for (Pole& p : some) {
      const bool good = p.frequency_sd <= options.largest_relative_sd * p.frequency_hz;
      if (good) {
        hard.push_back(p);
        place.push_back(static_cast<int>(out.poles.size()));
      }
      out.hard.push_back(good);
      out.poles.push_back(std::move(p));
    }
  if (hard.empty()) return out;
  out.threshold = threshold_of(hard);
  for (const std::vector<int>& found : clusters(hard, out.threshold)) {
    ModeCluster cluster;
    cluster.orders = (largest - hard[static_cast<std::size_t>(found.front())].order) / 2 + 1;
    for (const int m : found) cluster.members.push_back(place[static_cast<std::size_t>(m)]);
    if (found.size() < kLeastMembers || cluster.share() < options.least_share ||
        static_cast<double>(found.size()) < 0.1 * out.orders)
      continue;
    cluster.chosen = representative(out.poles, cluster.members);
    out.modes.push_back(std::move(cluster));
  }
  drop_splinters(out);
  std::ranges::sort(out.modes, {}, [&](const ModeCluster& c) {
    return out.poles[static_cast<std::size_t>(c.chosen)].frequency_hz;
  });
  return out;
}

}  // namespace wheeltap::signals
