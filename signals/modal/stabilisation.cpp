#include "signals/modal/stabilisation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "base/parallel.hpp"
#include "signals/modal/average_linkage.hpp"

namespace wheeltap::signals {
namespace {

constexpr double kNeverJoined = std::numeric_limits<double>::infinity();
// Limits of the distance threshold for all diagrams.
constexpr double kLeastThreshold = 0.005, kLargestThreshold = 0.08;
constexpr std::size_t kLeastMembers = 3;
constexpr double kGoodScatter = 1.1, kLucky = 1.25;
constexpr double kWorse = 2.0, kSameShape = 0.9;
constexpr double kUncertain = 3.0;  // standard deviations
constexpr double kSteady =
    0.5;  // a mode that occurs in at least this share of its orders counts as steady
constexpr double kOverlap = 5.0;  // distance of overlapping modes, in half-power half widths

double scatter(const Pole& p) {
  return std::sqrt(p.frequency_sd / p.frequency_hz * p.damping_sd / std::abs(p.damping));
}

double median(std::vector<double> x) {
  const auto half = x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2);
  std::nth_element(x.begin(), half, x.end());
  return *half;
}

/// Mean + 2 standard deviations of the distances to the previous order, over the class of stable
/// poles.
double threshold_of(const std::vector<Pole>& poles) {
  std::vector<double> logs;
  for (const Pole& p : poles) {
    double nearest = kNeverJoined;
    for (const Pole& q : poles)
      if (q.order == p.order - 2) nearest = std::min(nearest, pole_distance(p, q));
    if (nearest > 0.0 && nearest < kNeverJoined) logs.push_back(std::log(nearest));
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

/// Largest scatter of candidates: about that of the best tenth, unless one order is much better
/// than all others.
double good_scatter(const std::vector<double>& sorted) {
  return kGoodScatter * std::min(sorted[sorted.size() / 10], kLucky * sorted.front());
}

/// The representative of the members of orders >= `from`, if some of them have a small scatter or
/// if their number is sufficient. Otherwise, the representative of all members.
int representative(const std::vector<Pole>& poles, const std::vector<int>& members, int from = 0) {
  std::vector<double> all;
  for (const int m : members) {
    const double one = scatter(poles[static_cast<std::size_t>(m)]);
    all.push_back(std::isnan(one) ? 1.0 : one);
  }
  const auto late = [&](std::size_t i) {
    return poles[static_cast<std::size_t>(members[i])].order >= from;
  };
  std::vector<double> sorted = all, later;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (late(i)) later.push_back(all[i]);
  std::ranges::sort(sorted);
  double good = good_scatter(sorted);
  if (later.empty() || *std::ranges::min_element(later) > good) {
    std::ranges::sort(later);
    if (later.size() < kLeastMembers || later.front() > kWorse * sorted.front())
      return representative(poles, members);
    good = good_scatter(later);
  }
  std::vector<int> best;
  std::vector<double> frequencies;
  for (std::size_t i = 0; i < members.size(); ++i) {
    if (!(all[i] <= good) || !late(i)) continue;
    best.push_back(members[i]);
    frequencies.push_back(poles[static_cast<std::size_t>(members[i])].frequency_hz);
  }
  // A mode that distorts a shape may be missing in the diagram. Lower orders are therefore omitted
  // if the scatter of higher orders is as small.
  if (!std::isnan(poles[static_cast<std::size_t>(members.front())].frequency_sd)) {
    const auto half = static_cast<std::ptrdiff_t>((best.size() - 1) / 2);
    best.erase(best.begin(), best.begin() + half);
    frequencies.erase(frequencies.begin(), frequencies.begin() + half);
  }
  const double middle = median(frequencies);
  return best[static_cast<std::size_t>(std::ranges::find(frequencies, middle) -
                                       frequencies.begin())];
}

/// The lowest order that resolves all modes that could distort this mode: all steady modes, and all
/// modes whose peaks overlap.
int settled_order(const Stabilisation& of, const ModeCluster& cluster) {
  const auto pole = [&](int m) -> const Pole& { return of.poles[static_cast<std::size_t>(m)]; };
  const Pole& own = pole(cluster.chosen);
  int out = 0;
  for (const ModeCluster& other : of.modes) {
    const Pole& p = pole(other.chosen);
    const bool skirts = std::abs(p.frequency_hz - own.frequency_hz) <
                        kOverlap * (std::abs(p.damping) * p.frequency_hz +
                                    std::abs(own.damping) * own.frequency_hz);
    if (other.share() >= kSteady || skirts) out = std::max(out, pole(other.members.front()).order);
  }
  return out;
}

/// Repeats the choice among the orders from `settled_order` on.
void select_again(Stabilisation& of) {
  std::vector<int> chosen;
  for (const ModeCluster& c : of.modes)
    chosen.push_back(representative(of.poles, c.members, settled_order(of, c)));
  for (std::size_t i = 0; i < chosen.size(); ++i) of.modes[i].chosen = chosen[i];
}

bool is_splinter(const Stabilisation& of, const ModeCluster& c, const ModeCluster& whole) {
  const Pole &a = of.poles[static_cast<std::size_t>(c.chosen)],
             &b = of.poles[static_cast<std::size_t>(whole.chosen)];
  return c.members.size() < whole.members.size() && scatter(a) > kWorse * scatter(b) &&
         std::abs(a.frequency_hz - b.frequency_hz) <
             kUncertain * std::hypot(a.frequency_sd, b.frequency_sd) &&
         modal_assurance(a.shape, b.shape) > kSameShape;
}

/// Too large orders split a mode into two clusters; the less certain cluster is not a mode.
void drop_splinters(Stabilisation& of) {
  const std::vector<ModeCluster> all = of.modes;
  std::erase_if(of.modes, [&](const ModeCluster& c) {
    const bool splinter =
        std::ranges::any_of(all, [&](const ModeCluster& d) { return is_splinter(of, c, d); });
    if (splinter) of.rejected.push_back({.cluster = c, .why = Rejection::splinter});
    return splinter;
  });
}

/// True if two clusters belong to one peak of the spectrum: the shapes are the same, the half-power
/// widths overlap, and frequencies and damping ratios agree within three standard deviations.
bool explain_one_peak(const std::vector<Pole>& poles, const ModeCluster& one,
                      const ModeCluster& other) {
  const Pole &a = poles[static_cast<std::size_t>(one.chosen)],
             &b = poles[static_cast<std::size_t>(other.chosen)];
  const double apart = std::abs(a.frequency_hz - b.frequency_hz);
  const double width = std::abs(a.damping) * a.frequency_hz + std::abs(b.damping) * b.frequency_hz;
  return apart < width && apart < kUncertain * std::hypot(a.frequency_sd, b.frequency_sd) &&
         std::abs(a.damping - b.damping) < kUncertain * std::hypot(a.damping_sd, b.damping_sd) &&
         modal_assurance(a.shape, b.shape) > kSameShape;
}

/// The poles of both clusters. If an order has two poles, the more certain pole is kept.
ModeCluster joined(const std::vector<Pole>& poles, const ModeCluster& one,
                   const ModeCluster& other) {
  ModeCluster out{.members = one.members, .orders = std::max(one.orders, other.orders)};
  for (const int m : other.members) {
    const Pole& p = poles[static_cast<std::size_t>(m)];
    const auto same = std::ranges::find_if(
        out.members, [&](int k) { return poles[static_cast<std::size_t>(k)].order == p.order; });
    if (same == out.members.end())
      out.members.push_back(m);
    else if (scatter(p) < scatter(poles[static_cast<std::size_t>(*same)]))
      *same = m;
  }
  std::ranges::sort(out.members);
  out.chosen = representative(poles, out.members);
  return out;
}

/// If a pole changes between orders more than other poles, but within its uncertainty, it belongs
/// to several clusters. This function joins these clusters, the nearest first.
void join_clusters_of_one_peak(const std::vector<Pole>& poles, std::vector<ModeCluster>& clusters) {
  while (true) {
    std::size_t first = 0, second = 0;
    double least = kNeverJoined;
    for (std::size_t i = 0; i < clusters.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        if (!explain_one_peak(poles, clusters[i], clusters[j])) continue;
        const double distance = pole_distance(poles[static_cast<std::size_t>(clusters[i].chosen)],
                                              poles[static_cast<std::size_t>(clusters[j].chosen)]);
        if (distance < least) {
          least = distance;
          first = j;
          second = i;
        }
      }
    if (least == kNeverJoined) return;
    clusters[first] = joined(poles, clusters[first], clusters[second]);
    clusters.erase(clusters.begin() + static_cast<std::ptrdiff_t>(second));
  }
}

/// Removes clusters outside the band.
void cut_to_band(Stabilisation& of, double lowest_hz, double highest_hz) {
  std::vector<int> place(of.poles.size(), -1);
  Stabilisation out{.threshold = of.threshold, .orders = of.orders};
  for (std::size_t i = 0; i < of.poles.size(); ++i) {
    const double f = of.poles[i].frequency_hz;
    if (f < lowest_hz || f > highest_hz) continue;
    place[i] = static_cast<int>(out.poles.size());
    out.poles.push_back(std::move(of.poles[i]));
    out.hard.push_back(of.hard[i]);
  }
  const auto now = [&](int m) { return place[static_cast<std::size_t>(m)]; };
  const auto within = [&](ModeCluster& c) {
    if (now(c.chosen) < 0) return false;
    std::erase_if(c.members, [&](int m) { return now(m) < 0; });
    for (int& m : c.members) m = now(m);
    c.chosen = now(c.chosen);
    return true;
  };
  for (ModeCluster& c : of.modes)
    if (within(c)) out.modes.push_back(std::move(c));
  for (RejectedCluster& r : of.rejected)
    if (within(r.cluster)) out.rejected.push_back(std::move(r));
  of = std::move(out);
}

/// The index of the pole that `chosen` names.
int find_pole(const Stabilisation& of, const ChosenPole& chosen, long place) {
  const int largest = 2 * of.orders;
  if (chosen.order < 2 || chosen.order > largest || chosen.order % 2 != 0)
    throw ChosenPoleError(place, "the diagram has no order " + std::to_string(chosen.order) +
                                     ": orders are even numbers from 2 to " +
                                     std::to_string(largest));
  int best = -1;
  const auto apart = [&](int i) {
    return std::abs(of.poles[static_cast<std::size_t>(i)].frequency_hz - chosen.frequency_hz);
  };
  for (int i = 0; i < static_cast<int>(of.poles.size()); ++i)
    if (of.poles[static_cast<std::size_t>(i)].order == chosen.order &&
        (best < 0 || apart(i) < apart(best)))
      best = i;
  const std::string order = "order " + std::to_string(chosen.order);
  if (best < 0) throw ChosenPoleError(place, order + " has no pole within the band");
  if (!(apart(best) <= kChosenWithin * chosen.frequency_hz))
    throw ChosenPoleError(
        place, order + " has no pole within 0.5 % of " + std::to_string(chosen.frequency_hz) +
                   " Hz: the nearest one is at " +
                   std::to_string(of.poles[static_cast<std::size_t>(best)].frequency_hz) + " Hz");
  return best;
}

}  // namespace

void choose_poles(Stabilisation& of, std::span<const ChosenPole> chosen) {
  std::vector<ModeCluster> free = of.modes, found;
  for (const RejectedCluster& r : of.rejected) free.push_back(r.cluster);
  std::vector<int> taken;
  for (long i = 0; i < std::ssize(chosen); ++i) {
    const int p = find_pole(of, chosen[static_cast<std::size_t>(i)], i);
    if (const auto twice = std::ranges::find(taken, p); twice != taken.end())
      throw ChosenPoleError(i, "is the same pole as number " +
                                   std::to_string(twice - taken.begin() + 1) +
                                   " of the list: omit one of the two");
    taken.push_back(p);
    const auto own = std::ranges::find_if(free, [p](const ModeCluster& c) {
      return std::ranges::find(c.members, p) != c.members.end();
    });
    if (own == free.end()) {
      const int order = of.poles[static_cast<std::size_t>(p)].order;
      found.push_back({.members = {p}, .orders = (2 * of.orders - order) / 2 + 1, .chosen = p});
      continue;
    }
    found.push_back(std::move(*own));
    found.back().chosen = p;
    free.erase(own);
  }
  const auto is_free = [&](const ModeCluster& c) {
    return std::ranges::any_of(free, [&](const ModeCluster& f) { return f.members == c.members; });
  };
  std::erase_if(of.rejected, [&](const RejectedCluster& r) { return !is_free(r.cluster); });
  for (ModeCluster& c : of.modes)
    if (is_free(c)) of.rejected.push_back({.cluster = std::move(c), .why = Rejection::not_chosen});
  of.modes = std::move(found);
  const auto frequency = [&](const ModeCluster& c) {
    return of.poles[static_cast<std::size_t>(c.chosen)].frequency_hz;
  };
  std::ranges::sort(of.modes, {}, frequency);
  std::ranges::sort(of.rejected, {},
                    [&](const RejectedCluster& r) { return frequency(r.cluster); });
}

double pole_distance(const Pole& a, const Pole& b) {
  return std::abs(a.frequency_hz - b.frequency_hz) / std::max(a.frequency_hz, b.frequency_hz) +
         1.0 - modal_assurance(a.shape, b.shape);
}

std::size_t two_classes(const std::vector<double>& sorted) {
  const std::size_t n = sorted.size();
  const double total = std::accumulate(sorted.begin(), sorted.end(), 0.0);
  // The variance within the classes is smallest for the largest (Σ low)² / n_low + (Σ high)² /
  // n_high.
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
  const int orders = std::max(0, (largest - smallest) / 2 + 1);
  std::vector<std::vector<Pole>> by_order(static_cast<std::size_t>(orders));
  // Unresolved modes outside the band distort shapes inside it as well.
  const PoleWindow window{.lowest_hz = 0.0,
                          .highest_hz = std::numeric_limits<double>::infinity(),
                          .lowest_damping = options.lowest_damping,
                          .highest_damping = options.highest_damping};
  // Computes the largest orders first, because they take the longest time.
  base::parallel_for(orders, options.threads, [&](int i) {
    const int k = orders - 1 - i;
    by_order[static_cast<std::size_t>(k)] = subspace.poles(smallest + 2 * k, window);
  });
  return stabilise(std::move(by_order), options);
}

Stabilisation stabilise(std::vector<std::vector<Pole>> by_order,
                        const StabilisationOptions& options) {
  Stabilisation out{.orders = static_cast<int>(by_order.size())};
  const int smallest = std::max(2, options.smallest_order + options.smallest_order % 2);
  const int largest = smallest + 2 * (out.orders - 1);
  std::vector<Pole> hard;
  std::vector<int> place;
  for (std::vector<Pole>& some : by_order)
    for (Pole& p : some) {
      if (p.damping < options.lowest_damping || p.damping > options.highest_damping) continue;
      const bool good = p.frequency_sd <= options.largest_relative_sd * p.frequency_hz ||
                        options.largest_relative_sd == kNeverJoined;
      if (good) {
        hard.push_back(p);
        place.push_back(static_cast<int>(out.poles.size()));
      }
      out.hard.push_back(good);
      out.poles.push_back(std::move(p));
    }
  if (hard.empty()) {
    cut_to_band(out, options.lowest_hz, options.highest_hz);
    return out;
  }
  out.threshold = threshold_of(hard);
  std::vector<int> orders;
  for (const Pole& p : hard) orders.push_back(p.order);
  const auto distance = [&](int i, int j) {
    return pole_distance(hard[static_cast<std::size_t>(i)], hard[static_cast<std::size_t>(j)]);
  };
  std::vector<ModeCluster> clusters;
  for (const std::vector<int>& found : average_linkage(orders, distance, out.threshold)) {
    if (found.size() < kLeastMembers) continue;
    ModeCluster cluster;
    cluster.orders = (largest - hard[static_cast<std::size_t>(found.front())].order) / 2 + 1;
    for (const int m : found) cluster.members.push_back(place[static_cast<std::size_t>(m)]);
    cluster.chosen = representative(out.poles, cluster.members);
    clusters.push_back(std::move(cluster));
  }
  join_clusters_of_one_peak(out.poles, clusters);
  for (ModeCluster& cluster : clusters) {
    if (cluster.share() < options.least_share ||
        static_cast<double>(cluster.members.size()) < 0.1 * out.orders)
      out.rejected.push_back({.cluster = std::move(cluster), .why = Rejection::few_orders});
    else
      out.modes.push_back(std::move(cluster));
  }
  drop_splinters(out);
  select_again(out);
  cut_to_band(out, options.lowest_hz, options.highest_hz);
  const auto frequency = [&](const ModeCluster& c) {
    return out.poles[static_cast<std::size_t>(c.chosen)].frequency_hz;
  };
  std::ranges::sort(out.modes, {}, frequency);
  std::ranges::sort(out.rejected, {},
                    [&](const RejectedCluster& r) { return frequency(r.cluster); });
  return out;
}

}  // namespace wheeltap::signals
