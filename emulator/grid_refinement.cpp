#include "emulator/grid_refinement.hpp"

#include <cmath>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <stdexcept>
#include <string>

namespace wheeltap::emulator {
namespace {

void check_options(const std::vector<Factor>& factors, Eigen::Index responses,
                   const RefinementOptions& options) {
  check_factors(factors);
  const auto require = [](bool holds, const std::string& message) {
    if (!holds) throw std::invalid_argument("grid refinement: " + message);
  };
  require(options.tolerance.size() == static_cast<std::size_t>(responses),
          std::to_string(options.tolerance.size()) + " tolerances for " +
              std::to_string(responses) + " responses");
  for (double t : options.tolerance)
    require(t > 0.0, "the tolerance " + std::to_string(t) + " must be > 0");
  require(
      options.interpolant != nullptr && options.interpolant->runs == InterpolantType::Runs::grid,
      "the interpolant must support grids");
  require(options.waves.empty() || options.waves.size() == factors.size(),
          "waves must have one entry per factor");
  require(options.candidates.empty() || options.candidates.size() == factors.size(),
          "candidates for " + std::to_string(options.candidates.size()) + " of " +
              std::to_string(factors.size()) + " factors");
  for (const auto& list : options.candidates)
    for (std::size_t i = 1; i < list.size(); ++i)
      require(list[i - 1] < list[i], "candidates must increase");
  require(options.probes > 0, "probes must be > 0");
  require(options.check_runs > 1, "check_runs must be > 1");
}

/// The model with a cache of all results.
class Memory {
 public:
  Memory(const std::vector<Factor>& factors, Eigen::Index responses, const ModelFactory& factory,
         const ExperimentOptions& options)
      : factors_(factors), responses_(responses), factory_(factory), options_(options) {}

  RowMatrix operator()(const RowMatrix& points) {
    std::set<std::vector<double>> fresh;
    for (Eigen::Index i = 0; i < points.rows(); ++i)
      if (const auto key = row(points, i); !known_.contains(key)) fresh.insert(key);
    if (!fresh.empty()) {
      Design design{.factors = factors_,
                    .points = RowMatrix(static_cast<Eigen::Index>(fresh.size()), points.cols())};
      Eigen::Index i = 0;
      for (const auto& key : fresh)
        std::copy(key.begin(), key.end(), design.points.row(i++).begin());
      const RowMatrix answers = run_experiment(design, responses_, factory_, options_);
      i = 0;
      for (const auto& key : fresh) known_[key] = row(answers, i++);
    }
    RowMatrix out(points.rows(), responses_);
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
      const auto& answer = known_.at(row(points, i));
      std::copy(answer.begin(), answer.end(), out.row(i).begin());
    }
    return out;
  }
  [[nodiscard]] Eigen::Index runs() const { return static_cast<Eigen::Index>(known_.size()); }

 private:
  static std::vector<double> row(const RowMatrix& m, Eigen::Index i) {
    return {m.row(i).begin(), m.row(i).end()};
  }
  const std::vector<Factor>& factors_;
  Eigen::Index responses_;
  const ModelFactory& factory_;
  const ExperimentOptions& options_;
  std::map<std::vector<double>, std::vector<double>> known_;
};

/// The level that halves the interval between levels i and i + 1; std::nullopt without candidates.
std::optional<double> middle(const Factor& factor, std::size_t i,
                             const std::vector<double>& candidates) {
  const double low = factor.levels[i], high = factor.levels[i + 1];
  const double wanted =
      from_scale(factor.scale, 0.5 * (to_scale(factor.scale, low) + to_scale(factor.scale, high)));
  if (candidates.empty()) {
    if (wanted > low && wanted < high) return wanted;
    return std::nullopt;  // no number lies between the levels
  }
  std::optional<double> best;
  for (double candidate : candidates)
    if (candidate > low && candidate < high &&
        (!best || std::abs(candidate - wanted) < std::abs(*best - wanted)))
      best = candidate;
  return best;
}

double nearest(const std::vector<double>& candidates, double low, double high, double x) {
  double best = low;
  for (double candidate : candidates)
    if (candidate >= low && candidate <= high && std::abs(candidate - x) < std::abs(best - x))
      best = candidate;
  return best;
}

Table grid_table(const std::vector<Factor>& factors, const RowMatrix& values) {
  Table table;
  table.factors = factors;
  table.values = values;
  return table;
}

}  // namespace

RefinedGrid refine_grid(const std::vector<Factor>& initial, Eigen::Index responses,
                        const ModelFactory& factory, const RefinementOptions& options) {
  check_options(initial, responses, options);
  const std::size_t d = initial.size();
  const auto candidates =
      options.candidates.empty() ? std::vector<std::vector<double>>(d) : options.candidates;
  const Eigen::Map<const Eigen::RowVectorXd> tolerance(options.tolerance.data(), responses);
  std::vector<Factor> factors = initial;
  Memory model(initial, responses, factory, options.experiment);
  std::mt19937_64 generator(options.seed);
  const auto pick = [&](std::size_t n) { return static_cast<std::size_t>(generator() % n); };

  RowMatrix checks = random_design(initial, options.check_runs, options.seed).points;
  for (std::size_t j = 0; j < d; ++j)
    if (!candidates[j].empty())
      for (Eigen::Index i = 0; i < checks.rows(); ++i) {
        double& x = checks(i, static_cast<Eigen::Index>(j));
        x = nearest(candidates[j], initial[j].low(), initial[j].high(), x);
      }

  double share = 1.0 / static_cast<double>(d);
  for (;;) {
    const Design grid = full_factorial(factors);
    const RowMatrix values = model(grid.points);
    Table table = grid_table(factors, values);
    const auto f = options.interpolant->train(
        table, {.threads = options.experiment.threads, .waves = options.waves});
    const auto answer = [&f](std::span<const double> x, std::span<double> y) { f->evaluate(x, y); };

    // One test of an interval: a point at its middle, with the other factors at random levels.
    struct Trial {
      std::size_t factor;
      double level;
    };
    std::vector<Trial> trials;
    for (std::size_t j = 0; j < d; ++j)
      for (std::size_t i = 0; i + 1 < factors[j].levels.size(); ++i)
        if (const auto level = middle(factors[j], i, candidates[j])) trials.push_back({j, *level});
    std::vector<std::vector<double>> wanted(d);
    if (!trials.empty()) {
      Design probes{.factors = factors,
                    .points = RowMatrix(static_cast<Eigen::Index>(trials.size()) * options.probes,
                                        static_cast<Eigen::Index>(d))};
      Eigen::Index row = 0;
      for (const Trial& trial : trials)
        for (int p = 0; p < options.probes; ++p, ++row)
          for (std::size_t j = 0; j < d; ++j)
            probes.points(row, static_cast<Eigen::Index>(j)) =
                j == trial.factor ? trial.level : factors[j].levels[pick(factors[j].levels.size())];
      const RowMatrix error = model(probes.points) - predict(answer, probes, responses);
      for (std::size_t t = 0; t < trials.size(); ++t) {
        const auto part =
            error.middleRows(static_cast<Eigen::Index>(t) * options.probes, options.probes);
        if ((part.cwiseAbs().array().rowwise() / tolerance.array()).maxCoeff() > share)
          wanted[trials[t].factor].push_back(trials[t].level);
      }
    }

    Eigen::Index next_runs = 1;
    bool grows = false;
    for (std::size_t j = 0; j < d; ++j) {
      next_runs *= static_cast<Eigen::Index>(factors[j].levels.size() + wanted[j].size());
      grows = grows || !wanted[j].empty();
    }
    if (grows && next_runs <= options.most_runs) {
      for (std::size_t j = 0; j < d; ++j) {
        auto& levels = factors[j].levels;
        levels.insert(levels.end(), wanted[j].begin(), wanted[j].end());
        std::sort(levels.begin(), levels.end());
      }
      continue;
    }
    const RowMatrix truth = model(checks);
    const RowMatrix predicted = predict(answer, {.factors = factors, .points = checks}, responses);
    const double worst =
        ((truth - predicted).cwiseAbs().array().rowwise() / tolerance.array()).maxCoeff();
    const bool exhausted = grows || trials.empty() || share < 1e-6;
    if (worst <= 1.0 || exhausted)
      return {.factors = factors,
              .values = values,
              .holdout = holdout_error(truth, predicted),
              .model_runs = model.runs(),
              .reached = worst <= 1.0};
    share *= 0.5;
  }
}

}  // namespace wheeltap::emulator
