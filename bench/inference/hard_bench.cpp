// Spaces of many models whose probabilities are known: the galaxies with an unknown number of
// components, 1024 subsets of regressors, and counts that the data say nothing of.
//
// Counters: ess/Mcall is effective draws of the count (of the inclusion that has fewest, for
// subsets) per million likelihood calls after warm-up; worst_dP is the largest error of a
// probability and worst_errors the same in Monte Carlo standard errors (4 are rare).
#include <benchmark/benchmark.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "inference/diagnostics.hpp"
#include "inference/reversible_jump.hpp"
#include "inference/standard_normal.hpp"
#include "tests/inference/published_problems.hpp"

namespace wheeltap::inference {
namespace {

ChainsOf of_models(const Posterior& posterior, const std::function<double(int)>& f) {
  ChainsOf out;
  for (const Chain& chain : posterior.chains) {
    auto& values = out.emplace_back();
    for (const int m : chain.model) values.push_back(f(m));
  }
  return out;
}

double mean_of(const ChainsOf& chains) {
  double sum = 0.0, n = 0.0;
  for (const auto& chain : chains) {
    for (const double v : chain) sum += v;
    n += static_cast<double>(chain.size());
  }
  return sum / n;
}

double calls_after_warmup(const Posterior& posterior) {
  return static_cast<double>(posterior.likelihood_evaluations - posterior.warmup_evaluations);
}

// `known_error`: of the exact value, where that is by simulation.
struct Worst {
  double difference = 0.0, errors = 0.0;
  void add(const ChainsOf& draws, double exact, double known_error = 0.0) {
    const double off = std::fabs(mean_of(draws) - exact);
    const double error = std::hypot(mcse_mean(draws), known_error);
    difference = std::max(difference, off);
    if (off > 1e-12) errors = std::max(errors, off / error);
  }
  void report(benchmark::State& state) const {
    state.counters["worst_dP"] = difference;
    state.counters["worst_errors"] = errors;
  }
};

void report_run(benchmark::State& state, const Posterior& posterior) {
  state.counters["calls"] = calls_after_warmup(posterior);
  state.counters["warmup_calls"] = static_cast<double>(posterior.warmup_evaluations);
  state.counters["us/call"] =
      posterior.wall_seconds / static_cast<double>(posterior.likelihood_evaluations) * 1e6;
}

// Richardson & Green (1997, JRSS B 59:731), section 4.1. A component is (μ, g, v): its precision is
// g / β with g ~ Gamma(2, rate 1), so that 1/σ² ~ Gamma(2, rate β); its weight is v / Σ v with v ~
// Gamma(1), so that the weights are Dirichlet(1, …, 1).
class Galaxies : public Likelihood {
 public:
  explicit Galaxies(std::vector<double> y) : y_(std::move(y)) {}
  double log_likelihood(int, std::span<const double> x) override {
    const std::size_t k = (x.size() - 1) / 3;
    double total = 0.0, sum = 0.0;
    for (std::size_t j = 0; j < k; ++j) total += x[3 + 3 * j];
    for (const double y : y_) {
      double log_p = -HUGE_VAL;
      for (std::size_t j = 0; j < k; ++j) {
        const double precision = x[2 + 3 * j] / x[0], r = y - x[1 + 3 * j];
        log_p = log_sum_exp(log_p, std::log(x[3 + 3 * j] / total) + 0.5 * std::log(precision) -
                                       0.5 * precision * r * r - kLogSqrt2Pi);
      }
      sum += log_p;
    }
    return sum;
  }

 private:
  std::vector<double> y_;
};

void galaxies(benchmark::State& state) {
  const auto folder = kShared / "validation" / "galaxies";
  if (!std::filesystem::exists(folder)) {
    state.SkipWithError("the validation set 'galaxies' is not beside this checkout");
    return;
  }
  const auto exact = nlohmann::json::parse(std::ifstream(folder / "exact.json"));
  std::ifstream file(folder / "velocities.csv");
  std::string line;
  std::getline(file, line);
  std::vector<double> y;
  for (double v = 0.0; file >> v;) y.push_back(v);
  constexpr double kRange = 25.107, kMiddle = 21.7255;
  std::vector<ModelSpace::Counts> counts;
  for (int k = 1; k <= 30; ++k) counts.push_back({{k}, 1.0});
  const Problem problem{
      .space = ModelSpace::of_components({{"beta", Gamma{0.2, kRange * kRange / 10.0}}},
                                         {{"component",
                                           "components",
                                           {{"mean", Normal{kMiddle, kRange}},
                                            {"scaled precision", Gamma{2.0, 1.0}},
                                            {"weight", Gamma{1.0, 1.0}}}}},
                                         counts),
      .likelihood = [=] { return std::make_unique<Galaxies>(y); }};
  for (auto _ : state) {
    const Posterior posterior =
        reversible_jump(problem, {.draws = static_cast<int>(state.range(0))});
    Worst worst;
    for (int k = 3; k <= 14; ++k) {
      const auto i = static_cast<std::size_t>(k - 3);
      const ChainsOf is_k = of_models(posterior, [k](int m) { return m + 1 == k ? 1.0 : 0.0; });
      worst.add(is_k, exact["p_k_3_to_14"][i], exact["p_k_standard_error"][i]);
      state.counters["P(" + std::to_string(k) + ")"] = mean_of(is_k);
    }
    worst.report(state);
    const ChainsOf k = of_models(posterior, [](int m) { return static_cast<double>(m); });
    state.counters["ess/Mcall"] = ess_mean(k) / calls_after_warmup(posterior) * 1e6;
    report_run(state, posterior);
  }
}
BENCHMARK(galaxies)->Arg(200000)->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();

// As hald_problem, with ten correlated regressors, simulated. Of a subset of p with coefficient of
// determination R² and g = n,
//   Z ∝ (1 + g)^((n-1-p)/2) / (1 + g (1 - R²))^((n-1)/2)          (Liang et al. 2008, equation 6).
void subsets_of_ten(benchmark::State& state) {
  constexpr int kRegressors = 10, kRows = 60, kSubsets = 1 << kRegressors;
  Random random(7, 0, 0, Purpose::simulation);
  Eigen::MatrixXd x(kRows, kRegressors);
  Eigen::VectorXd y(kRows);
  for (Eigen::Index i = 0; i < kRows; ++i) {
    const double common = random.normal();
    for (Eigen::Index j = 0; j < kRegressors; ++j) x(i, j) = 0.8 * common + 0.6 * random.normal();
    y[i] = 0.9 * x(i, 0) - 0.6 * x(i, 3) + 0.35 * x(i, 7) + random.normal();
  }
  std::vector<std::vector<int>> subsets;
  std::vector<ModelSpace::ListedModel> models;
  std::vector<Parameter> parameters;
  for (int j = 1; j <= kRegressors; ++j)
    parameters.push_back({"b" + std::to_string(j), Normal{0.0, 1.0}});
  std::vector<double> log_z;
  const Eigen::VectorXd centred = y.array() - y.mean();
  for (int bits = 0; bits < kSubsets; ++bits) {
    std::vector<int>& subset = subsets.emplace_back();
    ModelSpace::ListedModel model{.name = "{", .weight = 1.0, .parameters = {}};
    for (int j = 0; j < kRegressors; ++j) {
      if ((bits >> j & 1) == 0) continue;
      subset.push_back(j);
      model.name += (subset.size() > 1 ? "," : "") + std::to_string(j + 1);
      model.parameters.push_back("b" + std::to_string(subset.size()));
    }
    model.name += "}";
    models.push_back(std::move(model));
    const auto p = static_cast<Eigen::Index>(subset.size());
    double rest = 1.0;  // 1 - R²
    if (p > 0) {
      Eigen::MatrixXd part(kRows, p);
      for (Eigen::Index j = 0; j < p; ++j) {
        const int column = subset[static_cast<std::size_t>(j)];
        part.col(j) = x.col(column).array() - x.col(column).mean();
      }
      const Eigen::VectorXd fit = part * part.householderQr().solve(centred);
      rest = (centred - fit).squaredNorm() / centred.squaredNorm();
    }
    log_z.push_back(0.5 * static_cast<double>(kRows - 1 - p) * std::log1p(kRows) -
                    0.5 * (kRows - 1) * std::log1p(kRows * rest));
  }
  const double top = *std::max_element(log_z.begin(), log_z.end());
  double total = 0.0;
  for (const double z : log_z) total += std::exp(z - top);
  const Problem problem{.space = ModelSpace::of_models(parameters, models),
                        .likelihood = [=] { return std::make_unique<Regression>(x, y, subsets); }};
  for (auto _ : state) {
    const Posterior posterior =
        reversible_jump(problem, {.draws = static_cast<int>(state.range(0))});
    Worst worst;
    double least = HUGE_VAL;
    for (int j = 0; j < kRegressors; ++j) {
      double exact = 0.0;
      for (int bits = 0; bits < kSubsets; ++bits) {
        if ((bits >> j & 1) != 0)
          exact += std::exp(log_z[static_cast<std::size_t>(bits)] - top) / total;
      }
      const ChainsOf in =
          of_models(posterior, [j](int m) { return (m >> j & 1) != 0 ? 1.0 : 0.0; });
      worst.add(in, exact);
      least = std::min(least, ess_mean(in));
      state.counters["P(x" + std::to_string(j + 1) + ")"] = mean_of(in);
    }
    worst.report(state);
    state.counters["ess/Mcall"] = least / calls_after_warmup(posterior) * 1e6;
    report_run(state, posterior);
  }
}
BENCHMARK(subsets_of_ten)->Arg(100000)->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();

// The data say nothing: the counts must come back flat.
void flat_counts(benchmark::State& state) {
  class Nothing : public Likelihood {
   public:
    double log_likelihood(int, std::span<const double>) override { return 0.0; }
  };
  std::vector<ModelSpace::Counts> counts;
  for (int k = 0; k <= 10; ++k) counts.push_back({{k}, 1.0});
  const Problem problem{
      .space = ModelSpace::of_components(
          {}, {{"spot", "spots", {{"x", Uniform{0.0, 1.0}}, {"y", Uniform{0.0, 1.0}}}}}, counts),
      .likelihood = [] { return std::make_unique<Nothing>(); }};
  for (auto _ : state) {
    const Posterior posterior =
        reversible_jump(problem, {.draws = static_cast<int>(state.range(0))});
    Worst worst;
    for (int k = 0; k <= 10; ++k)
      worst.add(of_models(posterior, [k](int m) { return m == k ? 1.0 : 0.0; }), 1.0 / 11.0);
    worst.report(state);
    const ChainsOf k = of_models(posterior, [](int m) { return static_cast<double>(m); });
    state.counters["ess/Mcall"] = ess_mean(k) / calls_after_warmup(posterior) * 1e6;
    report_run(state, posterior);
  }
}
BENCHMARK(flat_counts)->Arg(100000)->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();

}  // namespace
}  // namespace wheeltap::inference

BENCHMARK_MAIN();
