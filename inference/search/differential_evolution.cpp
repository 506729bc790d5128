#include "inference/search/differential_evolution.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "base/random.hpp"

namespace wheeltap::inference {
namespace {

// Success of the strategies and of crossover rates in the last generations.
struct Learning {
  static constexpr int kPeriod = 25;  // generations

  std::array<double, 2> tried{}, succeeded{};
  double crossover_sum = 0.0, crossover_count = 0.0;

  double second_strategy = 0.5;  // probability of the second strategy
  double crossover_mean = 0.5;

  void learn() {
    const auto rate = [&](std::size_t s) { return (succeeded[s] + 1.0) / (tried[s] + 2.0); };
    // Each strategy keeps a probability of at least 0.05.
    second_strategy = std::clamp(rate(1) / (rate(0) + rate(1)), 0.05, 0.95);
    if (crossover_count > 0.0) crossover_mean = crossover_sum / crossover_count;
    tried = succeeded = {};
    crossover_sum = crossover_count = 0.0;
  }
};

}  // namespace

Optimum maximise_by_differential_evolution(const Objective& objective, int dimension,
                                           const SadeOptions& options) {
  const auto require = [](bool fine, const char* name, double value, const char* bound) {
    if (!fine)
      throw std::invalid_argument(std::string("differential evolution: ") + name + " = " +
                                  std::to_string(value) + ", must be " + bound);
  };
  require(dimension >= 1, "dimension", dimension, ">= 1");
  require(options.population == 0 || options.population >= 5, "population", options.population,
          "0 or >= 5");
  require(options.generations >= 1, "generations", options.generations, ">= 1");
  require(options.start_sd > 0.0, "start_sd", options.start_sd, "> 0");
  require(options.bound > 0.0, "bound", options.bound, "> 0");

  const auto d = static_cast<std::size_t>(dimension);
  const int size = options.population > 0 ? options.population : std::max(30, 10 * dimension);
  const auto n = static_cast<std::size_t>(size);
  base::Random random(options.seed, 0, 0, base::Purpose::start);
  Optimum result;
  const auto evaluate = [&](std::span<const double> z) {
    ++result.evaluations;
    const double value = objective(z);
    return std::isnan(value) ? -std::numeric_limits<double>::infinity() : value;
  };
  const auto inside = [&](double z) {
    const double b = options.bound;
    if (z > b) z = 2.0 * b - z;
    if (z < -b) z = -2.0 * b - z;
    return std::clamp(z, -b, b);
  };

  std::vector<std::vector<double>> members(n, std::vector<double>(d));
  std::vector<double> values(n);
  for (std::size_t i = 0; i < n; ++i) {
    for (double& z : members[i]) z = inside(options.start_sd * random.normal());
    if (i < options.start.size())
      std::ranges::transform(options.start[i], members[i].begin(), inside);
    values[i] = evaluate(members[i]);
  }
  Learning learning;
  std::vector<double> crossover(n, 0.5), trial(d);
  for (int generation = 0; generation < options.generations; ++generation) {
    if (generation > 0 && generation % Learning::kPeriod == 0) learning.learn();
    if (generation % 5 == 0)
      for (double& c : crossover)
        c = std::clamp(learning.crossover_mean + 0.1 * random.normal(), 0.0, 1.0);
    const auto best = static_cast<std::size_t>(std::ranges::max_element(values) - values.begin());
    for (std::size_t i = 0; i < n; ++i) {
      const auto other = [&] { return static_cast<std::size_t>(random.index(size)); };
      std::size_t a = other(), b = other(), c = other();
      while (a == i) a = other();
      while (b == i || b == a) b = other();
      while (c == i || c == a || c == b) c = other();
      const std::size_t strategy = random.uniform() < learning.second_strategy ? 1 : 0;
      const double f = std::clamp(0.5 + 0.3 * random.normal(), 0.01, 2.0);
      const auto kept = static_cast<std::size_t>(random.index(dimension));  // crossed in any case
      for (std::size_t j = 0; j < d; ++j) {
        if (j != kept && random.uniform() >= crossover[i]) {
          trial[j] = members[i][j];
        } else if (strategy == 0) {
          trial[j] = inside(members[a][j] + f * (members[b][j] - members[c][j]));
        } else {
          trial[j] = inside(members[i][j] + f * (members[best][j] - members[i][j]) +
                            f * (members[a][j] - members[b][j]));
        }
      }
      const double value = evaluate(trial);
      learning.tried[strategy] += 1.0;
      if (value < values[i]) continue;
      if (value > values[i]) {
        learning.succeeded[strategy] += 1.0;
        learning.crossover_sum += crossover[i];
        learning.crossover_count += 1.0;
      }
      members[i] = trial;
      values[i] = value;
    }
    const auto [low, high] = std::ranges::minmax(values);
    if (high - low < options.tolerance) {
      result.converged = true;
      break;
    }
  }
  const auto best = static_cast<std::size_t>(std::ranges::max_element(values) - values.begin());
  result.z = members[best];
  result.value = values[best];
  return result;
}

}  // namespace wheeltap::inference
