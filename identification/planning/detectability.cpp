#include "identification/planning/detectability.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "base/index.hpp"
#include "base/number.hpp"
#include "base/parallel.hpp"
#include "base/random.hpp"

namespace wheeltap::identification::planning {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kWanted = 0.9;
/// Bisections of an interval between two nodes; the final interval is 1/16 of it.
constexpr std::size_t kBisections = 4;
/// Smallest effect of a visible defect, in standard errors.
constexpr double kVisible = 3.0;
/// Predictions closer than this, in standard errors, count as equal: images of a symmetry.
constexpr double kImage = 1e-3;
/// Largest number of pairs that a search for separations compares.
constexpr std::size_t kComparedPairs = 64;
/// Largest number of candidates of which a search for separations compares all pairs.
constexpr std::size_t kPairedCandidates = 32;

/// Ends of Wilson's 95 % interval of a proportion.
std::pair<double, double> wilson(double hits, double n) {
  constexpr double z2 = 1.959963984540054 * 1.959963984540054;
  const double p = hits / n, centre = (p + 0.5 * z2 / n) / (1.0 + z2 / n);
  const double half = std::sqrt(z2 * (p * (1.0 - p) / n + 0.25 * z2 / (n * n))) / (1.0 + z2 / n);
  return {centre - half, centre + half};
}

/// Least-squares fit of ascending values (pool adjacent violators).
std::vector<double> isotonic(const std::vector<double>& values) {
  std::vector<std::pair<double, int>> pools;
  for (const double v : values) {
    pools.emplace_back(v, 1);
    while (pools.size() > 1 && pools[pools.size() - 2].first > pools.back().first) {
      const auto [b, nb] = pools.back();
      pools.pop_back();
      auto& [a, na] = pools.back();
      a = (a * na + b * nb) / (na + nb);
      na += nb;
    }
  }
  std::vector<double> out;
  for (const auto& [v, n] : pools) out.insert(out.end(), index(n), v);
  return out;
}

/// Position at which the ascending curve through these points reaches kWanted.
std::optional<double> crossing(const std::vector<double>& at, const std::vector<double>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] < kWanted) continue;
    if (i == 0) return at[0];
    const double share = (kWanted - values[i - 1]) / std::max(values[i] - values[i - 1], 1e-300);
    return std::lerp(at[i - 1], at[i], std::clamp(share, 0.0, 1.0));
  }
  return {};
}

/// Smallest distance from `target` to the piecewise linear curve through the columns of `nodes`.
double distance_to_curve(const VectorXd& target, const MatrixXd& nodes) {
  double best = (target - nodes.col(0)).squaredNorm();
  for (Index i = 0; i + 1 < nodes.cols(); ++i) {
    const VectorXd along = nodes.col(i + 1) - nodes.col(i), from = target - nodes.col(i);
    const double square = along.squaredNorm();
    const double t = square > 0.0 ? std::clamp(from.dot(along) / square, 0.0, 1.0) : 0.0;
    best = std::min(best, (from - t * along).squaredNorm());
  }
  return std::sqrt(best);
}

double distance_between(const MatrixXd& a, const MatrixXd& b) {
  return std::min(distance_to_curve(a.col(a.cols() - 1), b),
                  distance_to_curve(b.col(b.cols() - 1), a));
}

/// The candidates of which pairs are compared: all or, if there are many, those with the lowest
/// costs and, at equal costs, the largest Σ φ² over the modes.
std::vector<int> paired_candidates(const PlannedStructure& structure,
                                   const std::vector<double>& costs) {
  const MatrixXd shapes = structure.intact_shapes();
  VectorXd energy = VectorXd::Zero(shapes.rows());
  for (Index j = 0; j < shapes.cols(); ++j)
    energy += shapes.col(j).cwiseAbs2() / std::max(shapes.col(j).squaredNorm(), 1e-300);
  std::vector<int> out(index(shapes.rows()));
  std::iota(out.begin(), out.end(), 0);
  if (out.size() <= kPairedCandidates) return out;
  std::ranges::stable_sort(out, [&](int a, int b) {
    const double cost_a = costs.empty() ? 0.0 : costs[index(a)];
    const double cost_b = costs.empty() ? 0.0 : costs[index(b)];
    return std::pair(cost_a, -energy[a]) < std::pair(cost_b, -energy[b]);
  });
  out.resize(kPairedCandidates);
  std::ranges::sort(out);
  return out;
}

struct DetectionPoint {
  double severity = 0.0;
  TestEstimate detected, right;
};

void insert(PlaceDetection& found, std::size_t position, const DetectionPoint& point) {
  const auto i = static_cast<std::ptrdiff_t>(position);
  found.severities.insert(found.severities.begin() + i, point.severity);
  found.detection.insert(found.detection.begin() + i, point.detected);
  found.right.insert(found.right.begin() + i, point.right);
}

void finish(PlaceDetection& found, int tests) {
  const auto n = static_cast<double>(tests);
  std::vector<double> mean, low, high;
  for (const TestEstimate& e : found.detection) {
    const auto [lower, upper] = wilson(e.value * n, n);
    mean.push_back(e.value);
    low.push_back(lower);
    high.push_back(upper);
  }
  found.smallest = crossing(found.severities, isotonic(mean));
  found.smallest_low = crossing(found.severities, isotonic(high));
  found.smallest_high = crossing(found.severities, isotonic(low));
}

}  // namespace

std::vector<PlaceDetection> detect_everywhere(const ScenarioSource& source,
                                              const PlacePredictions& predictions,
                                              const PreparedDesign& design,
                                              const DetectabilityOptions& options) {
  const PlannedStructure& structure = source.structure();
  const TestScorer scorer(design.test, source.spans(), options.tolerance);
  const Index data = design.test.data();
  MatrixXd noise(data, options.tests);
  for (int t = 0; t < options.tests; ++t) {
    base::Random random(options.seed, 3, static_cast<std::uint64_t>(t), base::Purpose::simulation);
    for (double& z : noise.col(t)) z = random.normal();
  }
  const MatrixXd noise_products = design.test.products(noise);
  std::vector<int> model_of_kind(structure.kinds().size(), -1);
  for (std::size_t m = 0; m < source.models().size(); ++m) {
    const auto& counts = source.models()[m].counts;
    if (std::reduce(counts.begin(), counts.end()) != 1) continue;
    model_of_kind[index(std::ranges::find(counts, 1) - counts.begin())] = static_cast<int>(m);
  }
  std::vector<PlaceDetection> out(structure.places().size());
  base::parallel_for(static_cast<int>(out.size()), options.threads, [&](int a) {
    PlaceDetection& found = out[index(a)];
    found.place = a;
    const TestPlace& place = structure.places()[index(a)];
    const int model = model_of_kind[index(place.kind)];
    const MatrixXd& nodes = design.test.places()[index(a)].nodes;
    const MatrixXd products = design.test.products(nodes);
    NormalTest::Answer answer;
    const std::vector<double>& severities = predictions.severities[index(a)];
    const auto estimate = [&](double hits) {
      const double n = options.tests, p = (hits + 0.5) / (n + 1.0);
      return TestEstimate{hits / n, std::sqrt(p * (1.0 - p) / n)};
    };
    // Simulates tests at node i, or between nodes i and i + 1, and inserts the results.
    const auto simulate = [&](std::size_t i, double share, std::size_t position) {
      const auto mix = [&](const MatrixXd& columns) -> VectorXd {
        const auto at = static_cast<Index>(i);
        if (share == 0.0) return columns.col(at);
        return (1.0 - share) * columns.col(at) + share * columns.col(at + 1);
      };
      const VectorXd mean = mix(nodes), product = mix(products);
      double detected = 0.0, right = 0.0;
      for (int t = 0; t < options.tests; ++t) {
        const VectorXd column = product + noise_products.col(t);
        const VectorXd measured = mean + noise.col(t);
        const NormalTest::Measured one{measured.data(), column.data()};
        design.test.answer(one, answer);
        if (!(answer.log_odds > options.threshold)) continue;
        detected += 1.0;
        if (model < 0) continue;
        const TestTruth truth{.model = model,
                              .defects = {{.place = a, .at = 0.5 * (place.start + place.end)}}};
        right += scorer.score(truth, one, answer).right;
      }
      insert(found, position,
             {share == 0.0 ? severities[i] : std::lerp(severities[i], severities[i + 1], share),
              estimate(detected), model < 0 ? TestEstimate{kNaN, kNaN} : estimate(right)});
      return detected / options.tests;
    };
    for (std::size_t i = 0; i < severities.size(); ++i) simulate(i, 0.0, i);
    // Bisection of the interval in which P(detected) reaches kWanted.
    for (std::size_t i = 1; i < severities.size(); ++i) {
      if (found.detection[i].value < kWanted) continue;
      double low = 0.0, high = 1.0;
      for (std::size_t step = 0, position = i; step < kBisections; ++step) {
        const double middle = 0.5 * (low + high);
        if (simulate(i - 1, middle, position) < kWanted) {
          low = middle;
          ++position;
        } else {
          high = middle;
        }
      }
      break;
    }
    finish(found, options.tests);
  });
  return out;
}

Confusion find_confusion(const PlannedStructure& structure, const NormalTest& test,
                         double tolerance) {
  const auto& places = structure.places();
  const int n = static_cast<int>(places.size());
  Confusion out;
  std::vector<char> visible(index(n));
  for (int a = 0; a < n; ++a) {
    const MatrixXd& nodes = test.places()[index(a)].nodes;
    visible[index(a)] = nodes.col(nodes.cols() - 1).norm() > kVisible;
    if (!visible[index(a)]) out.undetectable.push_back(a);
  }
  std::vector<std::vector<double>> distance(index(n), std::vector<double>(index(n), 0.0));
  for (int a = 0; a < n; ++a)
    for (int b = a + 1; b < n; ++b) {
      const double d =
          visible[index(a)] && visible[index(b)]
              ? distance_between(test.places()[index(a)].nodes, test.places()[index(b)].nodes)
              : kInfinity;
      distance[index(a)][index(b)] = distance[index(b)][index(a)] = d;
    }
  const auto same_line = [&](int a, int b) {
    return places[index(a)].kind == places[index(b)].kind &&
           places[index(a)].stretch == places[index(b)].stretch;
  };
  // Per place: the connected places of the same member that the test cannot distinguish from it.
  std::map<std::pair<int, int>, std::vector<double>> widths;
  std::vector<std::pair<int, int>> own(index(n));
  for (int a = 0; a < n; ++a) {
    int low = a, high = a;
    if (visible[index(a)]) {
      while (low > 0 && same_line(a, low - 1) && distance[index(a)][index(low - 1)] < kDistance)
        --low;
      while (high + 1 < n && same_line(a, high + 1) &&
             distance[index(a)][index(high + 1)] < kDistance)
        ++high;
      const TestPlace& p = places[index(a)];
      widths[{p.kind, p.stretch}].push_back(places[index(high)].end - places[index(low)].start);
    }
    own[index(a)] = {low, high};
  }
  for (auto& [line, list] : widths) {
    std::ranges::nth_element(list, list.begin() + static_cast<std::ptrdiff_t>(list.size() / 2));
    const double width = list[list.size() / 2];
    const SiteLine& kind_line = structure.kinds()[index(line.first)].line;
    if (width > 2.0 * tolerance && kind_line.stretches()[index(line.second)].size > 0.0)
      out.resolutions.push_back({kind_line.stretches()[index(line.second)].name, width});
  }
  struct Found {
    std::set<int> first, second;
    int pairs = 0;
    /// Smallest distance of a place to the places of the other region, per place.
    std::map<int, double> nearest_to_first, nearest_to_second;
    [[nodiscard]] bool exact() const {
      const auto image = [](const auto& place) { return place.second < kImage; };
      return std::ranges::all_of(nearest_to_first, image) &&
             std::ranges::all_of(nearest_to_second, image);
    }
  };
  const auto lower = [](std::map<int, double>& of, int place, double d) {
    const auto [at, added] = of.try_emplace(place, d);
    if (!added) at->second = std::min(at->second, d);
  };
  std::map<std::array<int, 4>, Found> found;
  for (int a = 0; a < n; ++a)
    for (int b = a + 1; b < n; ++b) {
      const TestPlace &p = places[index(a)], &q = places[index(b)];
      const double d = distance[index(a)][index(b)];
      if (!(d < kDistance)) continue;
      const bool inside = (b >= own[index(a)].first && b <= own[index(a)].second) ||
                          (a >= own[index(b)].first && a <= own[index(b)].second);
      const double apart = std::abs(0.5 * (p.start + p.end) - 0.5 * (q.start + q.end));
      if (same_line(a, b) && (inside || apart <= tolerance)) continue;
      Found& f = found[{p.kind, p.stretch, q.kind, q.stretch}];
      f.first.insert(a);
      f.second.insert(b);
      lower(f.nearest_to_first, a, d);
      lower(f.nearest_to_second, b, d);
      ++f.pairs;
      out.pairs.emplace_back(a, b);
    }
  for (const auto& [lines, f] : found) {
    const auto region = [&](const std::set<int>& list) {
      const TestPlace &low = places[index(*list.begin())], &high = places[index(*list.rbegin())];
      const SiteLine::Stretch& s =
          structure.kinds()[index(low.kind)].line.stretches()[index(low.stretch)];
      ConfusedRegions::Region r{.kind = low.kind,
                                .stretch = low.stretch,
                                .start = low.start,
                                .end = high.end,
                                .name = s.name};
      if (s.size > 0.0)
        r.name +=
            ", " + base::significant(r.start, 3) + " to " + base::significant(r.end, 3) + " m";
      return r;
    };
    out.regions.push_back({.first = region(f.first),
                           .second = region(f.second),
                           .pairs = f.pairs,
                           .exact = f.exact()});
  }
  std::ranges::sort(out.regions, [](const auto& a, const auto& b) { return a.pairs > b.pairs; });
  return out;
}

Separations find_separations(const PlannedStructure& structure, const PlacePredictions& predictions,
                             const TestNoise& noise, const TestDesign& design,
                             const std::vector<std::pair<int, int>>& pairs,
                             const std::vector<double>& costs, int threads) {
  Separations out;
  if (pairs.empty()) return out;
  std::vector<std::pair<int, int>> some;
  const std::size_t step = (pairs.size() + kComparedPairs - 1) / kComparedPairs;
  for (std::size_t i = 0; i < pairs.size(); i += step) some.push_back(pairs[i]);
  struct Option {
    TestDesign design;
    Separation separation;
    double cost = 0.0, typical = 0.0;
  };
  std::vector<Option> options;
  const int candidates = static_cast<int>(structure.candidates().size());
  const auto has = [&](int c) {
    return std::ranges::find(design.sensors, c) != design.sensors.end();
  };
  const auto add = [&](std::vector<int> more) {
    Option o{.design = design, .separation = {.sensors = more}};
    for (const int c : more) o.cost += costs.empty() ? 1.0 : costs[index(c)];
    o.design.sensors.insert(o.design.sensors.end(), more.begin(), more.end());
    std::ranges::sort(o.design.sensors);
    options.push_back(std::move(o));
  };
  if (design.sensors.empty()) {
    const std::vector<int> some_candidates = paired_candidates(structure, costs);
    for (std::size_t c = 0; c < some_candidates.size(); ++c)
      for (std::size_t d = c + 1; d < some_candidates.size(); ++d)
        add({some_candidates[c], some_candidates[d]});
  } else {
    for (int c = 0; c < candidates; ++c)
      if (!has(c)) add({c});
  }
  for (int m = 0; m < static_cast<int>(structure.masses().size()); ++m) {
    if (design.mass >= 0) break;
    Option o{.design = design, .separation = {.sensors = {}, .mass = m}};
    o.design.mass = m;
    options.push_back(std::move(o));
  }
  base::parallel_for(static_cast<int>(options.size()), threads, [&](int i) {
    Option& o = options[index(i)];
    const TestData data(structure, noise, o.design);
    std::map<int, MatrixXd> nodes;
    const auto nodes_of = [&](int a) -> const MatrixXd& {
      const auto [at, added] = nodes.try_emplace(a);
      if (added) {
        const auto& modes = predictions.modes[index(a)];
        at->second.resize(data.size(), static_cast<Index>(modes.size()));
        for (std::size_t k = 0; k < modes.size(); ++k)
          data.mean(modes[k], at->second.col(static_cast<Index>(k)));
      }
      return at->second;
    };
    std::vector<double> distances;
    for (const auto& [a, b] : some) {
      distances.push_back(distance_between(nodes_of(a), nodes_of(b)));
      o.separation.separated += distances.back() >= kDistance;
    }
    o.separation.of = static_cast<int>(some.size());
    std::ranges::nth_element(distances,
                             distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2));
    o.typical = distances[distances.size() / 2];
  });
  const auto best = [&](bool mass) -> std::optional<Separation> {
    int most = 0;
    for (const Option& o : options)
      if ((o.separation.mass >= 0) == mass) most = std::max(most, o.separation.separated);
    if (most == 0) return {};
    const Option* chosen = nullptr;
    for (const Option& o : options) {
      if ((o.separation.mass >= 0) != mass || o.separation.separated < 0.95 * most) continue;
      if (chosen == nullptr || o.cost < chosen->cost ||
          (o.cost == chosen->cost && o.typical > chosen->typical))
        chosen = &o;
    }
    return chosen->separation;
  };
  out.by_sensors = best(false);
  out.by_mass = best(true);
  return out;
}

}  // namespace wheeltap::identification::planning
