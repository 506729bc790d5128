// Simulation-based calibration (Talts et al. 2018, algorithm 1): truths from the prior, data from
// the truths, and the rank of each truth among its posterior draws must be uniform. Ranked are
// count, parameters and log likelihood, with ties broken at random.
//
// A correct engine fails one of the histograms below with probability 1e-4 (Bonferroni over
// functionals). WHEELTAP_LONG_TESTS=1 runs 1000 replicates per problem, in 20 bins, instead of 50
// in 10.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <functional>

#include "base/index.hpp"
#include "inference/engine/reversible_jump.hpp"
#include "tests/inference/statistics.hpp"
#include "tests/inference/toy_problems.hpp"

namespace wheeltap::inference {
namespace {

constexpr double kFalseAlarm = 1e-4;
constexpr int kRanks = 99;  // ranks 0 … 99

bool all() {
  return std::getenv("WHEELTAP_LONG_TESTS") != nullptr;
}

/// At least five expected per bin, for the chi-squared p-value.
int replicates() {
  return all() ? 1000 : 50;
}

int bins_of_ranks() {
  return all() ? 20 : 10;
}

struct Replicate {
  std::vector<double> truth;               // functionals of the truth
  std::vector<std::vector<double>> draws;  // of kRanks draws
};

// The smallest p-value of the rank histograms, times their number.
double uniformity(const std::vector<Replicate>& replicates, bool print) {
  const std::size_t functionals = replicates.front().truth.size();
  const int count = bins_of_ranks();
  double smallest = 1.0;
  for (std::size_t f = 0; f < functionals; ++f) {
    std::vector<double> bins(index(count), 0.0);
    for (std::size_t n = 0; n < replicates.size(); ++n) {
      base::Random random(11, f, n, base::Purpose::test);
      int below = 0, ties = 0;
      for (const auto& draw : replicates[n].draws) {
        below += draw[f] < replicates[n].truth[f];
        ties += draw[f] == replicates[n].truth[f];
      }
      const int rank = below + random.index(ties + 1);
      bins[index(rank * count / (kRanks + 1))] += 1.0;
    }
    const std::vector<double> expected(bins.size(), static_cast<double>(replicates.size()) / count);
    const double p = counts_p_value(bins, expected);
    if (print) {
      std::printf("functional %zu: p = %.4f, counts", f, p);
      for (const double b : bins) std::printf(" %.0f", b);
      std::printf("\n");
    }
    smallest = std::min(smallest, p);
  }
  return std::min(1.0, smallest * static_cast<double>(functionals));
}

Options short_run(std::uint64_t seed) {
  return {.seed = seed, .chains = 1, .threads = 1, .warmup = 1500, .draws = kRanks, .thin = 25};
}

using Functionals =
    std::function<std::vector<double>(const Problem&, int model, std::span<const double> x)>;
using MakeProblem = std::function<Problem(std::vector<double> data)>;

std::vector<Replicate> run(const MakeProblem& make, std::size_t data_size,
                           const std::function<void(int, std::span<const double>, base::Random&,
                                                    std::span<double>)>& simulate,
                           const Functionals& functionals) {
  std::vector<Replicate> made;
  for (int n = 0; n < replicates(); ++n) {
    base::Random random(9, 0, static_cast<std::uint64_t>(n), base::Purpose::simulation);
    const Problem blank = make(std::vector<double>(data_size, 0.0));
    Target prior(blank, true);
    State truth;
    prior.draw_prior(random, truth);
    prior.evaluate(truth);
    std::vector<double> data(data_size);
    simulate(truth.model, truth.x, random, data);
    const Problem problem = make(data);
    const Posterior posterior =
        reversible_jump(problem, short_run(static_cast<std::uint64_t>(n) + 1));
    Replicate& replicate = made.emplace_back();
    replicate.truth = functionals(problem, truth.model, truth.x);
    const Chain& chain = posterior.chains.front();
    for (std::size_t i = 0; i < chain.size(); ++i) {
      const Draw draw = chain.draw(i, problem.space);
      replicate.draws.push_back(functionals(problem, draw.model, draw.theta));
    }
  }
  return made;
}

// 0 to 3 bumps: count, total height, first location, log likelihood.
MakeProblem bumps() {
  return [](std::vector<double> data) { return toy::bump_problem(std::move(data), {2, 2, 1, 1}); };
}
void simulate_bumps(int, std::span<const double> x, base::Random& random, std::span<double> y) {
  toy::predict(x, y);
  for (double& value : y) value += toy::kNoise * random.normal();
}
std::vector<double> bump_functionals(const Problem& problem, int model, std::span<const double> x) {
  double height = 0.0;
  for (std::size_t i = 1; i < x.size(); i += 2) height += x[i];
  return {static_cast<double>(model), height, x.empty() ? -1.0 : x[0],
          problem.likelihood()->log_likelihood(model, x)};
}

TEST(SimulationBasedCalibration, DamageLikeProblem) {
  EXPECT_GT(uniformity(run(bumps(), toy::kSensors, simulate_bumps, bump_functionals), true),
            kFalseAlarm);
}

TEST(SimulationBasedCalibration, NoticesAWrongPrior) {
  // The control: truths with heights three times as large as in the prior.
  const auto tampered = run(
      bumps(), toy::kSensors,
      [](int model, std::span<const double> x, base::Random& random, std::span<double> y) {
        std::vector<double> larger(x.begin(), x.end());
        for (std::size_t i = 1; i < larger.size(); i += 2) larger[i] *= 3.0;
        simulate_bumps(model, larger, random, y);
      },
      bump_functionals);
  EXPECT_LT(uniformity(tampered, false), kFalseAlarm);
}

// Straight line against parabola, noise unknown.
class Polynomial : public Likelihood {
 public:
  explicit Polynomial(std::vector<double> data) : data_(std::move(data)) {}
  static double value(std::span<const double> x, std::size_t i, std::size_t n) {
    const double t = 2.0 * static_cast<double>(i) / static_cast<double>(n - 1) - 1.0;
    return x[0] + x[1] * t + (x.size() > 3 ? x[3] * t * t : 0.0);
  }
  double log_likelihood(int, std::span<const double> x) override {
    double sum = 0.0;
    for (std::size_t i = 0; i < data_.size(); ++i) {
      const double r = (data_[i] - value(x, i, data_.size())) / x[2];
      sum -= 0.5 * r * r + std::log(x[2]) + 0.91893853320467274178;
    }
    return sum;
  }

 private:
  std::vector<double> data_;
};

TEST(SimulationBasedCalibration, TwoModels) {
  const MakeProblem make = [](std::vector<double> data) {
    return Problem{.space = ModelSpace::of_models({{"a", Normal{0.0, 1.0}},
                                                   {"b", Uniform{-2.0, 2.0}},
                                                   {"noise", LogUniform{0.1, 2.0}},
                                                   {"c", Normal{0.0, 1.0}}},
                                                  {{"line", 1, {"a", "b", "noise"}},
                                                   {"parabola", 1, {"a", "b", "noise", "c"}}}),
                   .likelihood = [data] { return std::make_unique<Polynomial>(data); }};
  };
  const auto simulate = [](int, std::span<const double> x, base::Random& random,
                           std::span<double> y) {
    for (std::size_t i = 0; i < y.size(); ++i)
      y[i] = Polynomial::value(x, i, y.size()) + x[2] * random.normal();
  };
  const Functionals functionals = [](const Problem& problem, int model, std::span<const double> x) {
    return std::vector<double>{static_cast<double>(model),
                               x[0],
                               x[1],
                               x[2],
                               x.size() > 3 ? x[3] : 0.0,
                               problem.likelihood()->log_likelihood(model, x)};
  };
  EXPECT_GT(uniformity(run(make, 12, simulate, functionals), true), kFalseAlarm);
}

}  // namespace
}  // namespace wheeltap::inference
