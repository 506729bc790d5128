#include "identification/planning/sensor_choice.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <set>
#include <span>
#include <stdexcept>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/random.hpp"

namespace wheeltap::identification::planning {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Largest number of pairs of sensors at the start of the search.
constexpr int kMostPairs = 120;
/// Largest number of rounds of exchanges.
constexpr int kMostPasses = 10;
/// Scenarios of a comparison on the way to a design: a wrong choice between nearly equal designs is
/// repaired by later exchanges.
constexpr int kMostOnTheWay = 512;
/// Largest number of designs whose normal tests are kept between two rounds of a comparison.
constexpr std::size_t kKeptTests = 64;

/// Compares designs by the same simulated tests.
class Race {
 public:
  Race(const ScenarioSource& source, const PlacePredictions& predictions, const TestNoise& noise,
       const ChoiceOptions& options)
      : source_(source), predictions_(predictions), noise_(noise), options_(options) {
    for (const NormalModel& m : source.models())
      damaged_ += std::ranges::all_of(m.counts, [](int c) { return c == 0; }) ? 0.0 : m.prior;
  }

  [[nodiscard]] long compared() const { return compared_; }
  [[nodiscard]] int scenarios() const { return scenarios_; }

  /// The `keep` best designs, best first, by at most `most` scenarios.
  std::vector<RankedDesign> run(const std::vector<TestDesign>& designs, int keep, int most) {
    std::vector<Runner> field;
    std::set<Key> seen;  // two runners of one design would write to the same values
    for (const TestDesign& design : designs)
      if (seen.insert(key(design)).second) field.push_back({design, &known_[key(design)]});
    compared_ += static_cast<long>(field.size());
    int count = 0;
    for (int to = options_.first_scenarios;; to *= 2) {
      extend(field, to);
      count = to;
      sort(field, count);
      const auto places = static_cast<std::size_t>(keep);
      if (field.size() > places) {
        const Runner& last = field[places - 1];
        const std::size_t half = std::max(places, (field.size() + 1) / 2);
        std::erase_if(field,
                      [&](const Runner& r) { return &r > &last && is_worse(r, last, count); });
        if (field.size() > half)
          field.erase(field.begin() + static_cast<std::ptrdiff_t>(half), field.end());
      }
      if (field.size() <= places || to >= most) break;
    }
    scenarios_ = std::max(scenarios_, count);
    std::vector<RankedDesign> out;
    for (const Runner& r : field)
      if (out.size() < static_cast<std::size_t>(keep))
        out.push_back({r.design, estimate(r.first(count))});
    return out;
  }

 private:
  struct Runner {
    TestDesign design;
    std::vector<double>* scores;  // one value per scenario that the design was scored with
    std::shared_ptr<const PreparedDesign> test = {};

    [[nodiscard]] std::span<const double> first(int count) const {
      return std::span(*scores).first(index(count));
    }
  };
  using Key = std::pair<std::vector<int>, int>;
  static Key key(const TestDesign& design) { return {design.sensors, design.mass}; }

  /// Scores every design of the field with the first `to` scenarios. Values of earlier comparisons
  /// are used again.
  void extend(std::vector<Runner>& field, int to) {
    while (static_cast<int>(truths_.size()) < to) {
      const int more = to - static_cast<int>(truths_.size());
      for (Scenario& s : source_.draw(drawn_, more, options_.threads))
        if (!s.truth.defects.empty()) truths_.push_back(std::move(s));
      drawn_ += static_cast<std::uint64_t>(more);
    }
    base::parallel_for(static_cast<int>(field.size()), options_.threads, [&](int i) {
      Runner& runner = field[index(i)];
      if (runner.scores->size() >= index(to)) return;
      const std::size_t from = runner.scores->size();
      const auto part = std::span(truths_).subspan(from, index(to) - from);
      if (!runner.test)
        runner.test = std::make_shared<const PreparedDesign>(
            prepare(source_.structure(), predictions_, noise_, runner.design));
      for (const TestOutcome& o : simulate_tests(source_, *runner.test, part, options_.tolerance))
        runner.scores->push_back(location_score(o));
      if (field.size() > kKeptTests) runner.test.reset();
    });
  }

  /// Mean and variance of the mean, under the prior of models with damage.
  [[nodiscard]] TestEstimate estimate(std::span<const double> values) const {
    struct Sums {
      double n = 0.0, sum = 0.0, squares = 0.0;
    };
    std::vector<Sums> sums(source_.models().size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      Sums& s = sums[index(truths_[i].truth.model)];
      s.n += 1.0;
      s.sum += values[i];
      s.squares += values[i] * values[i];
    }
    TestEstimate out;
    double variance = 0.0;
    for (std::size_t m = 0; m < sums.size(); ++m) {
      const Sums& s = sums[m];
      if (s.n == 0.0) continue;
      const double share = source_.models()[m].prior / damaged_, mean = s.sum / s.n;
      out.value += share * mean;
      variance += share * share * std::max(0.0, s.squares / s.n - mean * mean) / s.n;
    }
    out.mcse = std::sqrt(variance);
    return out;
  }
  [[nodiscard]] bool is_worse(const Runner& r, const Runner& than, int count) const {
    std::vector<double> difference(index(count));
    for (std::size_t i = 0; i < difference.size(); ++i)
      difference[i] = (*than.scores)[i] - (*r.scores)[i];
    const TestEstimate d = estimate(difference);
    return d.value > 3.0 * d.mcse;
  }
  void sort(std::vector<Runner>& field, int count) const {
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t i = 0; i < field.size(); ++i)
      order.emplace_back(-estimate(field[i].first(count)).value, i);
    std::ranges::sort(order);
    std::vector<Runner> sorted;
    for (const auto& [value, i] : order) sorted.push_back(std::move(field[i]));
    field = std::move(sorted);
  }

  const ScenarioSource& source_;
  const PlacePredictions& predictions_;
  const TestNoise& noise_;
  const ChoiceOptions& options_;
  double damaged_ = 0.0;                      // prior probability of damage
  std::vector<Scenario> truths_;              // with damage
  std::uint64_t drawn_ = 0;                   // scenarios that were drawn
  std::map<Key, std::vector<double>> known_;  // values of every design that was scored
  long compared_ = 0;
  int scenarios_ = 0;
};

TestDesign with(std::vector<int> sensors) {
  std::ranges::sort(sensors);
  return {.sensors = std::move(sensors)};
}

std::vector<TestDesign> all_layouts(int candidates, int choose) {
  std::vector<TestDesign> out;
  std::vector<int> at(index(choose));
  std::iota(at.begin(), at.end(), 0);
  for (;;) {
    out.push_back({.sensors = at});
    int i = choose - 1;
    while (i >= 0 && at[index(i)] == candidates - choose + i) --i;
    if (i < 0) return out;
    ++at[index(i)];
    for (int j = i + 1; j < choose; ++j) at[index(j)] = at[index(j - 1)] + 1;
  }
}

/// All pairs of sensors or, if there are too many, pairs by classical criteria and random pairs.
std::vector<TestDesign> pairs_of(const MatrixXd& shapes, std::uint64_t seed) {
  const int candidates = static_cast<int>(shapes.rows());
  if (layout_count(candidates, 2) <= kMostPairs) return all_layouts(candidates, 2);
  std::vector<TestDesign> out = {with(effective_independence(shapes, 2)),
                                 with(kinetic_energy(shapes, 2))};
  for (auto& layout : random_layouts(candidates, 2, kMostPairs - 2, seed))
    out.push_back({.sensors = std::move(layout)});
  return out;
}

/// All designs with one more sensor.
std::vector<TestDesign> longer(const TestDesign& design, int candidates) {
  std::vector<TestDesign> out;
  for (int c = 0; c < candidates; ++c) {
    if (std::ranges::find(design.sensors, c) != design.sensors.end()) continue;
    std::vector<int> sensors = design.sensors;
    sensors.push_back(c);
    out.push_back(with(std::move(sensors)));
  }
  return out;
}

/// The designs with one sensor fewer.
std::vector<TestDesign> shorter(const TestDesign& design) {
  std::vector<TestDesign> out;
  for (std::size_t i = 0; i < design.sensors.size(); ++i) {
    std::vector<int> sensors = design.sensors;
    sensors.erase(sensors.begin() + static_cast<std::ptrdiff_t>(i));
    out.push_back({.sensors = std::move(sensors)});
  }
  return out;
}

/// The design and those with one sensor exchanged.
std::vector<TestDesign> exchanged(const TestDesign& design, int candidates) {
  std::vector<TestDesign> out = {design};
  for (std::size_t i = 0; i < design.sensors.size(); ++i)
    for (int c = 0; c < candidates; ++c) {
      if (std::ranges::find(design.sensors, c) != design.sensors.end()) continue;
      std::vector<int> sensors = design.sensors;
      sensors[i] = c;
      out.push_back(with(std::move(sensors)));
    }
  return out;
}

/// Removes the least useful sensor and adds the best other one, until the design does not change.
TestDesign with_exchanges(Race& race, TestDesign design, int candidates, int most) {
  for (int pass = 0; pass < kMostPasses && design.sensors.size() > 2; ++pass) {
    std::vector<TestDesign> next = longer(race.run(shorter(design), 1, most)[0].design, candidates);
    next.push_back(design);
    TestDesign best = race.run(next, 1, most)[0].design;
    if (best == design) break;
    design = std::move(best);
  }
  return design;
}

}  // namespace

double location_score(const TestOutcome& outcome) {
  const double s = outcome.located, rest = 1.0 - s;
  return s * s / (s * s + rest * rest);
}

double layout_count(int candidates, int choose) {
  double out = 1.0;
  for (int i = 0; i < choose; ++i) out = std::min(1e18, out * (candidates - i) / (i + 1.0));
  return std::round(out);
}

SensorChoice choose_sensors(const ScenarioSource& source, const PlacePredictions& predictions,
                            const TestNoise& noise, const ChoiceOptions& options) {
  const int candidates = static_cast<int>(source.structure().candidates().size());
  if (options.choose > candidates || options.choose < 0)
    throw std::invalid_argument("choose must be at most the number of candidate sensors, " +
                                std::to_string(candidates));
  const auto report = [&](double fraction) {
    if (options.progress) options.progress(fraction);
  };
  SensorChoice out;
  Race race(source, predictions, noise, options);
  if (options.choose < 2) {
    out.best = race.run({TestDesign{}}, 1, options.most_scenarios);
    out.exhaustive = true;
  } else {
    const MatrixXd shapes = source.structure().intact_shapes();
    const int on_the_way = std::min(options.most_scenarios, kMostOnTheWay);
    std::vector<RankedDesign> best = race.run(pairs_of(shapes, source.seed()), 1, on_the_way);
    out.path = best;
    for (int n = 3; n <= options.choose; ++n) {
      report(0.5 * (n - 2) / options.choose);
      best = race.run(longer(best[0].design, candidates), 1, on_the_way);
      out.path.push_back(best[0]);
    }
    if (layout_count(candidates, options.choose) <= options.exhaustive) {
      out.exhaustive = true;
      best =
          race.run(all_layouts(candidates, options.choose), options.keep, options.most_scenarios);
    } else {
      std::vector<TestDesign> starts = {best[0].design,
                                        with(effective_independence(shapes, options.choose)),
                                        with(kinetic_energy(shapes, options.choose))};
      for (TestDesign& start : starts) {
        report(0.5 + 0.1 * static_cast<double>(&start - starts.data()));
        start = with_exchanges(race, start, candidates, on_the_way);
      }
      best = race.run(starts, 1, options.most_scenarios);
      for (int pass = 0; pass < kMostPasses; ++pass) {
        report(0.8 + 0.2 * pass / kMostPasses);
        const TestDesign before = best[0].design;
        best = race.run(exchanged(before, candidates), options.keep, options.most_scenarios);
        if (best[0].design == before) break;
      }
    }
    out.best = std::move(best);
  }
  out.compared = race.compared();
  out.scenarios = race.scenarios();
  report(1.0);
  return out;
}

std::vector<int> effective_independence(const MatrixXd& shapes, int count) {
  std::vector<int> left(index(shapes.rows()));
  std::iota(left.begin(), left.end(), 0);
  while (static_cast<int>(left.size()) > count) {
    const MatrixXd phi = shapes(left, Eigen::all);
    VectorXd worth(phi.rows());
    if (phi.rows() > phi.cols()) {
      const MatrixXd information = phi.transpose() * phi;
      const Eigen::CompleteOrthogonalDecomposition<MatrixXd> inverse(information);
      worth = (phi * inverse.solve(phi.transpose())).diagonal();
    } else {
      // 1 / (G⁻¹)_ii is the factor that sensor i contributes to det G, G = Φ Φᵀ.
      const MatrixXd gram = phi * phi.transpose();
      const MatrixXd inverse = gram.completeOrthogonalDecomposition().pseudoInverse();
      for (Index i = 0; i < worth.size(); ++i)
        worth[i] = inverse(i, i) > 0.0 ? 1.0 / inverse(i, i) : 0.0;
    }
    Index least = 0;
    worth.minCoeff(&least);
    left.erase(left.begin() + least);
  }
  return left;
}

std::vector<int> kinetic_energy(const MatrixXd& shapes, int count) {
  VectorXd energy = VectorXd::Zero(shapes.rows());
  for (Index j = 0; j < shapes.cols(); ++j)
    energy += shapes.col(j).cwiseAbs2() / std::max(shapes.col(j).squaredNorm(), 1e-300);
  std::vector<int> order(index(shapes.rows()));
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, [&](int a, int b) { return energy[a] > energy[b]; });
  order.resize(index(std::min<Index>(count, shapes.rows())));
  std::ranges::sort(order);
  return order;
}

std::vector<std::vector<int>> random_layouts(int candidates, int count, int layouts,
                                             std::uint64_t seed) {
  std::vector<std::vector<int>> out;
  for (int l = 0; l < layouts; ++l) {
    base::Random random(seed, 2, static_cast<std::uint64_t>(l), base::Purpose::simulation);
    std::vector<int> all(index(candidates));
    std::iota(all.begin(), all.end(), 0);
    std::vector<int>& layout = out.emplace_back();
    for (int i = 0; i < std::min(count, candidates); ++i) {
      const int pick = i + random.index(candidates - i);
      std::swap(all[index(i)], all[index(pick)]);
      layout.push_back(all[index(i)]);
    }
    std::ranges::sort(layout);
  }
  return out;
}

}  // namespace wheeltap::identification::planning
