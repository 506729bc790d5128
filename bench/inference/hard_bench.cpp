// Problems with many models of known probability: the galaxies with an unknown number of
// components, 1024 subsets of regressors, and counts on which the data have no information.
//
// galaxies/draws/moves: with moves:1, the problem adds the move MixtureGibbs.
//
// Counters: ess/Mcall is the effective sample size of the count per million likelihood evaluations
// after warm-up (for subsets, the smallest of all inclusions). The largest error of a probability
// is worst_dP, or worst_errors in Monte Carlo standard errors (4 are rare).
#include <benchmark/benchmark.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "inference/engine/reversible_jump.hpp"
#include "inference/statistics/diagnostics.hpp"
#include "inference/statistics/standard_normal.hpp"
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

double calls_after_warmup(const Posterior& posterior) {
  return static_cast<double>(posterior.likelihood_evaluations - posterior.warmup_evaluations);
}

// `known_error` is the standard error of `exact` if `exact` comes from a simulation.
struct Worst {
  double difference = 0.0, errors = 0.0;
  void add(const ChainsOf& draws, double exact, double known_error = 0.0) {
    const double off = std::fabs(mean(draws) - exact);
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

constexpr double kRange = 25.107, kMiddle = 21.7255;

// Richardson & Green (1997, JRSS B 59:731), section 4.1. A component has the parameters (μ, g, v).
// Its precision is g / β with g ~ Gamma(2, rate 1), so that 1/σ² ~ Gamma(2, rate β). Its weight is
// v / Σ v with v ~ Gamma(1), so that the weights are Dirichlet(1, …, 1).
class Galaxies : public Likelihood {
 public:
  explicit Galaxies(std::vector<double> y) : y_(std::move(y)) {}
  double log_likelihood(int, std::span<const double> x) override {
    const std::size_t k = (x.size() - 1) / 3;
    double total = 0.0;
    for (std::size_t j = 0; j < k; ++j) total += x[3 + 3 * j];
    // ln p(y) = ln Σ_j exp(a_j - ½ (y - μ_j)² g_j/β),   a_j = ln w_j + ½ ln(g_j/β) - ½ ln 2π
    a_.resize(k);
    for (std::size_t j = 0; j < k; ++j)
      a_[j] = std::log(x[3 + 3 * j] / total) + 0.5 * std::log(x[2 + 3 * j] / x[0]) - kLogSqrt2Pi;
    term_.resize(k);
    double sum = 0.0;
    for (const double y : y_) {
      double top = -HUGE_VAL, scaled = 0.0;
      for (std::size_t j = 0; j < k; ++j) {
        const double r = y - x[1 + 3 * j];
        term_[j] = a_[j] - 0.5 * x[2 + 3 * j] / x[0] * r * r;
        top = std::max(top, term_[j]);
      }
      if (!(top > -HUGE_VAL)) return -HUGE_VAL;
      for (const double term : term_)
        if (term > top - 40.0) scaled += std::exp(term - top);
      sum += top + std::log(scaled);
    }
    return sum;
  }

 private:
  std::vector<double> y_, a_, term_;
};

// A move that a user could add for mixtures: the telescoping sampler (Frühwirth-Schnatter,
// Malsiner-Walli & Grün 2021, Bayesian Analysis 16:1279) for the parameters of the state. Each
// datum is allocated to a component with its posterior probability. Given the allocation a, with
// n_j data in component j and K of the k components not empty, the conditional distributions are
// exact:
//
//   μ_j | ·  normal,   τ_j = g_j/β ~ Gamma(2 + n_j/2, rate β + ½ Σ (y - μ_j)²),
//   β | ·    ~ Gamma(0.2 + 2k, rate 10/R² + Σ τ_j),
//   k | a    ∝ P(k) k!/(k - K)! Γ(k)/Γ(k + n), empty components from their priors, with
//   v/Σv     ~ Dirichlet(1 + n_j) and Σv ~ Gamma(k).
//
// A sweep draws from the four in this order or, with probability ½, in the reverse order. Before
// the allocation (in the reverse order, after all draws), components with parameters from their
// priors are born, and any of the k components die. Both have the ratio L(s') P(k') / (L(s) P(k))
// of likelihoods without allocations, which are sums of the densities for the allocation (Stephens
// 2000, Annals of Statistics 28:40, in discrete time). k thus also changes by components with a few
// data. Given a, each part is reversible with respect to the posterior π, so
//
//   ln ratio = ln q(s' → s; a, reverse order) - ln q(s → s'; a, order)
//            + ln p(a | s') - ln p(a | s)     = ln π(s) - ln π(s'),
//
// which cancels the ratio of the target, except for a bias between models that tuning may have
// added. A step of several sweeps has the same ratio. The engine evaluates the likelihood after the
// last sweep only.
class MixtureGibbs : public Move {
 public:
  /// Work of the move in likelihood evaluations: the number of density evaluations of the move
  /// divided by the number of density evaluations in one likelihood evaluation.
  struct Work {
    std::atomic<long> steps = 0;
    std::atomic<double> calls = 0.0;
    [[nodiscard]] double of_a_step() const { return calls / static_cast<double>(steps); }
  };

  MixtureGibbs(std::vector<double> y, std::shared_ptr<Work> work)
      : y_(std::move(y)), work_(std::move(work)) {}
  std::optional<double> propose(const State& from, const Step& step, State& to) override {
    if (step.beta != 1.0)
      return std::nullopt;  // the conditional distributions are those of the posterior
    const ModelSpace& space = step.target.space();
    random_ = &step.random;
    beta_ = from.x[0];
    components_.clear();
    for (std::size_t i = 1; i < from.x.size(); i += 3)
      components_.push_back({from.x[i], from.x[i + 1] / beta_, from.x[i + 2], {}, {}});
    calls_ = 0.0;
    stale_ = true;
    bool possible = true;
    for (int sweep = 0; sweep < kSweeps && possible; ++sweep) {
      const bool reverse = step.random.uniform() < 0.5;
      if (!reverse) possible = give_birth_and_bury(space);
      possible = possible && allocate();
      for (int i = 0; i < 4 && possible; ++i) update(reverse ? 3 - i : i, space);
      stale_ = true;
      if (reverse && possible) possible = give_birth_and_bury(space);
    }
    ++work_->steps;
    work_->calls += calls_;
    if (!possible) return std::nullopt;
    to.model = static_cast<int>(components_.size()) - 1;
    to.z = {space.prior(to.model, 0).to_standard_normal(beta_)};
    for (const Component& c : components_) {
      to.z.push_back(space.prior(to.model, 1).to_standard_normal(c.mean));
      to.z.push_back(space.prior(to.model, 2).to_standard_normal(c.precision * beta_));
      to.z.push_back(space.prior(to.model, 3).to_standard_normal(c.weight));
    }
    for (const double z : to.z)
      if (!std::isfinite(z)) return std::nullopt;
    step.target.sort_components(to);
    step.target.screen(to);
    return log_posterior(space, from) - log_posterior(space, to);
  }

 private:
  static constexpr int kSweeps = 4, kBirths = 3;

  struct Component {
    double mean, precision, weight;
    std::vector<double> data;
    std::vector<double> density;  ///< v √τ exp(-½ τ (y - μ)²) of every y
  };

  static double log_posterior(const ModelSpace& space, const State& state) {
    double sum = state.log_likelihood + space[state.model].log_prior +
                 std::lgamma(space[state.model].counts[0] + 1.0);
    for (const double z : state.z) sum -= 0.5 * z * z + kLogSqrt2Pi;
    return sum;
  }

  void compute_density(Component& c) const {
    c.density.resize(y_.size());
    for (std::size_t i = 0; i < y_.size(); ++i) {
      const double r = y_[i] - c.mean;
      c.density[i] = c.weight * std::sqrt(c.precision) * std::exp(-0.5 * c.precision * r * r);
    }
  }

  // Computes all densities and their sums. Returns false if a sum is 0 or not finite: the reverse
  // move could not start from such a state either.
  bool refresh() {
    if (!stale_) return true;
    for (Component& c : components_) compute_density(c);
    calls_ += 1.0;
    stale_ = false;
    sum_all_but(components_.size(), sums_);
    return std::ranges::all_of(sums_, [](double s) { return s > 0.0 && std::isfinite(s); });
  }
  void sum_all_but(std::size_t left_out, std::vector<double>& sums) const {
    sums.assign(y_.size(), 0.0);
    for (std::size_t j = 0; j < components_.size(); ++j) {
      if (j == left_out) continue;
      for (std::size_t i = 0; i < y_.size(); ++i) sums[i] += components_[j].density[i];
    }
  }

  bool give_birth_and_bury(const ModelSpace& space) {
    if (!refresh()) return false;
    double weight = 0.0;
    for (const Component& c : components_) weight += c.weight;
    for (int n = 0; n < kBirths; ++n) {
      const std::size_t k = components_.size();
      const bool birth = random_->uniform() < 0.5;
      if (k == (birth ? static_cast<std::size_t>(space.size()) : 1)) continue;
      Component born{};
      std::size_t at = 0;
      double change = 0.0;
      if (birth) {
        born = {kMiddle + kRange * random_->normal(),
                random_->gamma(2.0) / beta_,
                random_->gamma(1.0),
                {},
                {}};
        compute_density(born);
        changed_ = sums_;
        for (std::size_t i = 0; i < y_.size(); ++i) changed_[i] += born.density[i];
        change = born.weight;
      } else {
        at = std::min(k - 1, static_cast<std::size_t>(random_->uniform() * static_cast<double>(k)));
        sum_all_but(at, changed_);
        change = -components_[at].weight;
      }
      calls_ += 1.0 / static_cast<double>(k);
      const auto model = static_cast<int>(k) - 1;
      double log_ratio = space[birth ? model + 1 : model - 1].log_prior - space[model].log_prior -
                         static_cast<double>(y_.size()) * std::log1p(change / weight);
      for (std::size_t i = 0; i < y_.size(); ++i) log_ratio += std::log(changed_[i] / sums_[i]);
      if (!(std::log(random_->uniform()) < log_ratio)) continue;
      sums_ = changed_;
      weight += change;
      if (birth) {
        components_.push_back(std::move(born));
      } else {
        components_.erase(components_.begin() + static_cast<std::ptrdiff_t>(at));
      }
    }
    return true;
  }

  bool allocate() {
    if (!refresh()) return false;
    for (Component& c : components_) c.data.clear();
    for (std::size_t i = 0; i < y_.size(); ++i) {
      double u = random_->uniform() * sums_[i];
      std::size_t j = 0;
      for (; j + 1 < components_.size(); ++j) {
        u -= components_[j].density[i];
        if (u < 0.0) break;
      }
      components_[j].data.push_back(y_[i]);
    }
    return true;
  }

  void update(int which, const ModelSpace& space) {
    if (which == 0) {
      for (Component& c : components_) {
        constexpr double kPrior = 1.0 / (kRange * kRange);
        double sum = kMiddle * kPrior;
        for (const double y : c.data) sum += c.precision * y;
        const double precision = kPrior + c.precision * static_cast<double>(c.data.size());
        c.mean = sum / precision + random_->normal() / std::sqrt(precision);
      }
    } else if (which == 1) {
      for (Component& c : components_) {
        double square = 0.0;
        for (const double y : c.data) square += (y - c.mean) * (y - c.mean);
        c.precision =
            random_->gamma(2.0 + 0.5 * static_cast<double>(c.data.size())) / (beta_ + 0.5 * square);
      }
    } else if (which == 2) {
      double rate = 10.0 / (kRange * kRange);
      for (const Component& c : components_) rate += c.precision;
      beta_ = random_->gamma(0.2 + 2.0 * static_cast<double>(components_.size())) / rate;
    } else {
      std::erase_if(components_, [](const Component& c) { return c.data.empty(); });
      const auto filled = static_cast<int>(components_.size());
      std::vector<double> p;
      double top = -HUGE_VAL;
      for (int k = filled; k <= space.size(); ++k) {
        p.push_back(space[k - 1].log_prior + std::lgamma(k + 1.0) - std::lgamma(k - filled + 1.0) +
                    std::lgamma(k) - std::lgamma(k + static_cast<double>(y_.size())));
        top = std::max(top, p.back());
      }
      double sum = 0.0;
      for (double& value : p) sum += value = std::exp(value - top);
      double u = random_->uniform() * sum;
      std::size_t empty = 0;
      for (; empty + 1 < p.size(); ++empty) {
        u -= p[empty];
        if (u < 0.0) break;
      }
      for (; empty > 0; --empty)
        components_.push_back(
            {kMiddle + kRange * random_->normal(), random_->gamma(2.0) / beta_, 0.0, {}, {}});
      double total = 0.0;
      for (Component& c : components_)
        total += c.weight = random_->gamma(1.0 + static_cast<double>(c.data.size()));
      const double scale = random_->gamma(static_cast<double>(components_.size())) / total;
      for (Component& c : components_) c.weight *= scale;
    }
  }

  std::vector<double> y_;
  base::Random* random_ = nullptr;
  double beta_ = 0.0;
  std::vector<Component> components_;
  bool stale_ = true;                   // true: densities and sums_ belong to earlier components
  std::vector<double> sums_, changed_;  // sums of all densities at each y
  double calls_ = 0.0;
  std::shared_ptr<Work> work_;
};

void galaxies(benchmark::State& state) {
  const bool with_moves = state.range(1) != 0;
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
  std::vector<ModelSpace::Counts> counts;
  for (int k = 1; k <= 30; ++k) counts.push_back({{k}, 1.0});
  Problem problem{.space = ModelSpace::of_components({{"beta", Gamma{0.2, kRange * kRange / 10.0}}},
                                                     {{"component",
                                                       "components",
                                                       {{"mean", Normal{kMiddle, kRange}},
                                                        {"scaled precision", Gamma{2.0, 1.0}},
                                                        {"weight", Gamma{1.0, 1.0}}}}},
                                                     counts),
                  .likelihood = [=] { return std::make_unique<Galaxies>(y); }};
  const auto work = std::make_shared<MixtureGibbs::Work>();
  if (with_moves) {
    problem.moves.push_back(
        {"telescoping Gibbs", [=] { return std::make_unique<MixtureGibbs>(y, work); }, 5.0});
  }
  for (auto _ : state) {
    const Posterior posterior =
        reversible_jump(problem, {.draws = static_cast<int>(state.range(0))});
    Worst worst;
    for (int k = 3; k <= 14; ++k) {
      const auto i = static_cast<std::size_t>(k - 3);
      const ChainsOf is_k = of_models(posterior, [k](int m) { return m + 1 == k ? 1.0 : 0.0; });
      worst.add(is_k, exact["p_k_3_to_14"][i], exact["p_k_standard_error"][i]);
      state.counters["P(" + std::to_string(k) + ")"] = mean(is_k);
    }
    worst.report(state);
    const ChainsOf k = of_models(posterior, [](int m) { return static_cast<double>(m); });
    // The density evaluations of the move itself also count as likelihood evaluations.
    double calls = calls_after_warmup(posterior);
    for (const MoveStatistics& move : posterior.moves) {
      if (move.name == "telescoping Gibbs")
        calls += work->of_a_step() * static_cast<double>(move.proposed);
    }
    state.counters["move_calls"] = calls - calls_after_warmup(posterior);
    state.counters["ess/Mcall"] = ess_mean(k) / calls * 1e6;
    report_run(state, posterior);
  }
}
BENCHMARK(galaxies)
    ->ArgNames({"draws", "moves"})
    ->Args({200000, 0})
    ->Args({200000, 1})
    ->Iterations(1)
    ->Unit(benchmark::kSecond)
    ->UseRealTime();

// Like hald_problem, with ten simulated correlated regressors. For a subset of p regressors with
// the coefficient of determination R², and g = n,
//   Z ∝ (1 + g)^((n-1-p)/2) / (1 + g (1 - R²))^((n-1)/2)          (Liang et al. 2008, equation 6).
void subsets_of_ten(benchmark::State& state) {
  constexpr int kRegressors = 10, kRows = 60, kSubsets = 1 << kRegressors;
  base::Random random(7, 0, 0, base::Purpose::simulation);
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
      state.counters["P(x" + std::to_string(j + 1) + ")"] = mean(in);
    }
    worst.report(state);
    state.counters["ess/Mcall"] = least / calls_after_warmup(posterior) * 1e6;
    report_run(state, posterior);
  }
}
BENCHMARK(subsets_of_ten)->Arg(100000)->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();

// The data have no information: the posterior of the counts must be uniform.
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
