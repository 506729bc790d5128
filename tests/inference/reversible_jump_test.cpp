// The whole engine: it reproduces exact posteriors, and neutral settings do not change them.
#include "inference/engine/reversible_jump.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "base/eigen_solvers.hpp"
#include "inference/diagnosis/verdict.hpp"
#include "inference/engine/explore.hpp"
#include "inference/engine/sample.hpp"
#include "inference/engine/tune.hpp"
#include "inference/moves/between_models/model_switch.hpp"
#include "inference/statistics/diagnostics.hpp"
#include "tests/inference/run_checks.hpp"
#include "tests/inference/statistics.hpp"
#include "tests/inference/toy_problems.hpp"

namespace wheeltap::inference {
namespace {

// n = 20, ȳ = 0.5, σ = τ = 1: BF10 = (1 + n)^(-1/2) exp(½ n² ȳ² / (n + 1)) = 2.360070.
class NormalMean : public Likelihood {
 public:
  double log_likelihood(int model, std::span<const double> x) override {
    const double mu = model == 0 ? 0.0 : x[0];
    return -0.5 * 20.0 * (0.5 - mu) * (0.5 - mu);
  }
};

Problem nested_means(double unit) {
  class InUnit : public NormalMean {
   public:
    explicit InUnit(double u) : unit_(u) {}
    double log_likelihood(int model, std::span<const double> x) override {
      const double mu = x.empty() ? 0.0 : x[0] / unit_;
      return NormalMean::log_likelihood(model, {&mu, 1});
    }

   private:
    double unit_;
  };
  return {.space = ModelSpace::of_models({{"mu", Normal{0.0, unit}}},
                                         {{"zero", 1, {}}, {"free", 1, {"mu"}}}),
          .likelihood = [unit] { return std::make_unique<InUnit>(unit); }};
}

TEST(ReversibleJump, NestedNormalMeans) {
  const Problem problem = nested_means(1.0);
  const Posterior posterior = reversible_jump(problem, {.warmup = 2000, .draws = 20000});
  expect_probability(posterior, 1, 2.360070 / 3.360070);
}

TEST(ReversibleJump, DoesNotDependOnUnits) {
  const Problem metres = nested_means(1.0);
  const Problem millimetres = nested_means(1000.0);
  const Posterior a = reversible_jump(metres, small());
  const Posterior b = reversible_jump(millimetres, small());
  EXPECT_EQ(a.chains[0].model, b.chains[0].model);
  EXPECT_NEAR(b.chains[0].theta[0] / 1000.0, a.chains[0].theta[0], 1e-12);
}

TEST(ReversibleJump, DoesNotDependOnTheOrderOfModels) {
  Problem problem = nested_means(1.0);
  const Posterior forward = reversible_jump(problem, small());
  class Swapped : public NormalMean {
   public:
    double log_likelihood(int model, std::span<const double> x) override {
      return NormalMean::log_likelihood(1 - model, x);
    }
  };
  problem.space =
      ModelSpace::of_models({{"mu", Normal{0.0, 1.0}}}, {{"free", 1, {"mu"}}, {"zero", 1, {}}});
  problem.likelihood = [] { return std::make_unique<Swapped>(); };
  const Posterior backward = reversible_jump(problem, small());
  const double error =
      std::hypot(mcse_mean(indicator(forward, 1)), mcse_mean(indicator(backward, 0)));
  EXPECT_NEAR(probability(forward, 1), probability(backward, 0), kSigmas * error);
}

// Parameters exchange names and places, the likelihood reads them where they are.
TEST(ReversibleJump, DoesNotDependOnTheOrderOfParameters) {
  class Plane : public Likelihood {
   public:
    explicit Plane(bool swapped) : swapped_(swapped) {}
    double log_likelihood(int model, std::span<const double> x) override {
      const double a = x[swapped_ && model == 1 ? 1 : 0];
      const double b = model == 0 ? 0.0 : x[swapped_ ? 0 : 1];
      return -0.5 * 20.0 * (0.5 - a - b) * (0.5 - a - b) - 2.0 * (b - 0.4) * (b - 0.4);
    }

   private:
    bool swapped_;
  };
  const auto run = [](bool swapped) {
    const Parameter a{"a", Normal{0.0, 1.0}}, b{"b", Uniform{-1.0, 3.0}};
    const std::vector<std::string> both =
        swapped ? std::vector<std::string>{"b", "a"} : std::vector<std::string>{"a", "b"};
    static std::vector<std::unique_ptr<Problem>> kept;
    kept.push_back(std::make_unique<Problem>(
        Problem{.space = ModelSpace::of_models(
                    swapped ? std::vector<Parameter>{b, a} : std::vector<Parameter>{a, b},
                    {{"one", 1, {"a"}}, {"two", 1, both}}),
                .likelihood = [swapped] { return std::make_unique<Plane>(swapped); }}));
    return reversible_jump(*kept.back(), {.warmup = 3000, .draws = 10000});
  };
  const Posterior plain = run(false), swapped = run(true);
  const double error = std::hypot(mcse_mean(indicator(plain, 1)), mcse_mean(indicator(swapped, 1)));
  EXPECT_NEAR(probability(plain, 1), probability(swapped, 1), kSigmas * error);
  EXPECT_GT(probability(plain, 1), 0.01);
  EXPECT_LT(probability(plain, 1), 0.99);
}

// Quantities judged over all chains do not depend on their order.
TEST(ReversibleJump, DoesNotDependOnTheOrderOfChains) {
  const Problem problem = nested_means(1.0);
  ChainsOf chains = indicator(reversible_jump(problem, small()), 1);
  const double before[] = {rhat(chains), ess_mean(chains), mcse_mean(chains), mean(chains)};
  std::swap(chains[0], chains[3]);
  std::swap(chains[1], chains[3]);
  const double after[] = {rhat(chains), ess_mean(chains), mcse_mean(chains), mean(chains)};
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(before[i], after[i], 1e-9 * std::abs(before[i]));
}

TEST(ReversibleJump, DependsOnTheSeedAndNotOnThreads) {
  const Problem problem = toy::bumps();
  Options options = small(5);
  options.threads = 1;
  const Posterior one = reversible_jump(problem, options);
  options.threads = 3;
  const Posterior three = reversible_jump(problem, options);
  for (std::size_t c = 0; c < one.chains.size(); ++c) {
    EXPECT_EQ(one.chains[c].model, three.chains[c].model);
    EXPECT_EQ(one.chains[c].log_likelihood, three.chains[c].log_likelihood);
  }
  EXPECT_EQ(one.likelihood_evaluations, three.likelihood_evaluations);
  options.seed = 6;
  EXPECT_NE(reversible_jump(problem, options).chains[0].log_likelihood,
            one.chains[0].log_likelihood);
}

/// Returns -∞ for values below the floor.
class EarlyRejecting final : public Likelihood {
 public:
  EarlyRejecting(std::unique_ptr<Likelihood> exact, long& early)
      : exact_(std::move(exact)), early_(early) {}
  double log_likelihood(int model, std::span<const double> x) override {
    return exact_->log_likelihood(model, x);
  }
  double log_likelihood_above(double floor, int model, std::span<const double> x) override {
    const double value = exact_->log_likelihood(model, x);
    if (value >= floor) return value;
    ++early_;
    return -std::numeric_limits<double>::infinity();
  }
  void evaluate(double floor, int model, std::span<const double> x, Evaluation& out) override {
    out = exact_->evaluation(model, x);
    if (!(out.log_likelihood >= floor)) out.log_likelihood = log_likelihood_above(floor, model, x);
  }

 private:
  std::unique_ptr<Likelihood> exact_;
  long& early_;
};

TEST(ReversibleJump, EarlyRejectionChangesNoDraw) {
  const Problem exact = toy::bumps();
  long early = 0;
  Problem rejecting = exact;
  rejecting.likelihood = [&] {
    return std::make_unique<EarlyRejecting>(exact.likelihood(), early);
  };
  Options options = small(5);
  options.threads = 1;
  // Adaptation treats small acceptance probabilities as zero, so that warm-up differs: compare
  // draws of a kernel that does not adapt.
  options.moves.random_walk = false;
  const Posterior one = reversible_jump(exact, options);
  const Posterior two = reversible_jump(rejecting, options);
  EXPECT_GT(early, one.likelihood_evaluations / 10);
  for (std::size_t c = 0; c < one.chains.size(); ++c) {
    EXPECT_EQ(one.chains[c].model, two.chains[c].model);
    EXPECT_EQ(one.chains[c].log_likelihood, two.chains[c].log_likelihood);
  }
}

TEST(ReversibleJump, MoveSetsAgree) {
  const Problem problem = toy::bumps();
  Options options{.seed = 2, .warmup = 3000, .draws = 20000};
  const Posterior all = reversible_jump(problem, options);
  options.moves = {.informed_birth = false,
                   .relocation = false,
                   .reflection = false,
                   .independence = false,
                   .tempering = false};
  const Posterior plain = reversible_jump(problem, options);
  for (int k = 0; k < 4; ++k) {
    const double error = std::hypot(mcse_mean(indicator(all, k)), mcse_mean(indicator(plain, k)));
    EXPECT_NEAR(probability(all, k), probability(plain, k), kSigmas * error) << k;
  }
}

// Tempering does not change P(k) or the parameters, whether it stops after warm-up or continues.
TEST(ReversibleJump, TemperingChangesNoProbability) {
  const Problem problem = toy::bumps();
  Options options{.seed = 4, .warmup = 3000, .draws = 20000};
  const Posterior without = reversible_jump(problem, options);
  options.tempered_draws = true;
  options.draws = 6000;
  const Posterior with = reversible_jump(problem, options);
  EXPECT_GT(with.ladder_round_trips, 100);
  for (int k = 0; k < 4; ++k) {
    const double error =
        std::hypot(mcse_mean(indicator(without, k)), mcse_mean(indicator(with, k)));
    EXPECT_NEAR(probability(without, k), probability(with, k), kSigmas * error) << k;
  }
  options.prior_only = true;
  const Posterior prior = reversible_jump(problem, options);
  for (int k = 0; k < 4; ++k) expect_probability(prior, k, 0.25);
}

TEST(ReversibleJump, RecordedDensitiesEqualRecomputedOnes) {
  const Problem problem = toy::bumps();
  const Posterior posterior = reversible_jump(problem, small());
  const auto likelihood = problem.likelihood();
  for (std::size_t i = 0; i < posterior.chains[1].size(); i += 97) {
    const Draw draw = posterior.draw(1, i);
    const int m = draw.model;
    const std::span<const double> x = draw.theta;
    EXPECT_EQ(draw.log_likelihood, likelihood->log_likelihood(m, x));
    double log_prior = problem.space[m].log_prior + std::lgamma(problem.space[m].counts[0] + 1.0);
    for (std::size_t j = 0; j < x.size(); ++j) {
      log_prior += problem.space.prior(m, static_cast<int>(j)).log_density(x[j]);
    }
    EXPECT_NEAR(draw.log_prior, log_prior, 1e-12 * std::abs(log_prior));
  }
}

TEST(ReversibleJump, ReportsALikelihoodOfNaN) {
  class Bad : public Likelihood {
   public:
    double log_likelihood(int model, std::span<const double> x) override {
      return model == 1 && x[0] > 0.5 ? std::nan("") : 0.0;
    }
  };
  Problem problem = nested_means(1.0);
  problem.likelihood = [] { return std::make_unique<Bad>(); };
  try {
    (void)reversible_jump(problem, small());
    FAIL() << "no error";
  } catch (const LikelihoodError& error) {
    EXPECT_NE(std::string(error.what()).find("'free' at mu = "), std::string::npos) << error.what();
  }
}

TEST(ReversibleJump, ReportsALikelihoodThatIsNeverFinite) {
  class Impossible : public Likelihood {
   public:
    double log_likelihood(int, std::span<const double>) override {
      return -std::numeric_limits<double>::infinity();
    }
  };
  Problem problem = nested_means(1.0);
  problem.likelihood = [] { return std::make_unique<Impossible>(); };
  EXPECT_THROW((void)reversible_jump(problem, small()), LikelihoodError);
}

// A number of components that does not fit into its space, for example.
TEST(ReversibleJump, AnImpossibleModelHasProbabilityZero) {
  class Half : public Likelihood {
   public:
    double log_likelihood(int model, std::span<const double>) override {
      return model == 0 ? 0.0 : -std::numeric_limits<double>::infinity();
    }
  };
  Problem problem = nested_means(1.0);
  problem.likelihood = [] { return std::make_unique<Half>(); };
  const Posterior posterior = reversible_jump(problem, small());
  EXPECT_EQ(posterior.impossible_models, std::vector<int>{1});
  const Verdict verdict = judge(posterior);
  EXPECT_EQ(verdict.models[1].probability, 0.0);
  EXPECT_EQ(verdict.models[1].mcse, 0.0);
  EXPECT_EQ(verdict.models[1].basis, Basis::evidence);
  EXPECT_EQ(verdict.models[0].probability, 1.0);
  for (const Reason& reason : verdict.not_established)
    EXPECT_FALSE(std::holds_alternative<ModelUnknown>(reason));
}

// Rods of length 0.4 on a line of places in [0, 1]: n of them fit with probability (1 - 0.4 (n -
// 1))ⁿ, and four never do.
TEST(ReversibleJump, AnImpossibleCountHasProbabilityZero) {
  class Rods : public Likelihood {
   public:
    double log_likelihood(int, std::span<const double> x) override {
      for (std::size_t i = 1; i < x.size(); ++i)
        if (x[i] - x[i - 1] < 0.4) return -std::numeric_limits<double>::infinity();
      return 0.0;
    }
  };
  std::vector<ModelSpace::Counts> counts;
  for (int n = 0; n <= 4; ++n) counts.push_back({{n}, 1.0});
  const Problem problem{.space = ModelSpace::of_components(
                            {}, {{"rod", "rods", {{"location", Uniform{0.0, 1.0}}}}}, counts),
                        .likelihood = [] { return std::make_unique<Rods>(); }};
  const Posterior posterior = reversible_jump(problem, small());
  EXPECT_EQ(posterior.impossible_models, std::vector<int>{4});
  const Verdict verdict = judge(posterior);
  EXPECT_EQ(verdict.models[4].probability, 0.0);
  EXPECT_EQ(verdict.models[4].mcse, 0.0);
  const double evidence[] = {1.0, 1.0, 0.36, 0.008};
  for (std::size_t n = 0; n < 4; ++n)
    EXPECT_NEAR(verdict.models[n].probability, evidence[n] / 2.368,
                5.0 * verdict.models[n].mcse + 0.005)
        << n;
}

TEST(ReversibleJump, NamesAnImpossibleModelAndItsPriors) {
  Problem problem = nested_means(1.0);
  problem.space = ModelSpace::of_models({{"mu", Normal{0.0, 1.0}}}, {{"free", 1, {"mu"}}});
  class Never : public Likelihood {
   public:
    double log_likelihood(int, std::span<const double>) override {
      return -std::numeric_limits<double>::infinity();
    }
  };
  problem.likelihood = [] { return std::make_unique<Never>(); };
  try {
    (void)reversible_jump(problem, small());
    FAIL() << "no error";
  } catch (const LikelihoodError& error) {
    EXPECT_NE(std::string(error.what()).find("'free'"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("mu ~ normal"), std::string::npos) << error.what();
  }
}

TEST(ReversibleJump, RejectsInvalidOptions) {
  const Problem problem = nested_means(1.0);
  EXPECT_THROW((void)reversible_jump(problem, {.chains = 0}), std::invalid_argument);
  EXPECT_THROW((void)reversible_jump(problem, {.threads = -1}), std::invalid_argument);
  EXPECT_THROW((void)reversible_jump(problem, {.warmup = -1}), std::invalid_argument);
  EXPECT_THROW((void)reversible_jump(problem, {.draws = -1}), std::invalid_argument);
  EXPECT_THROW((void)reversible_jump(problem, {.thin = -1}), std::invalid_argument);
  for (const double most : {0.05, std::nan(""), std::numeric_limits<double>::infinity()}) {
    Problem greedy = problem;
    greedy.moves.push_back(
        {.name = "greedy", .make = [] { return std::make_unique<ModelSwitch>(); }, .most = most});
    EXPECT_THROW((void)reversible_jump(greedy, small()), std::invalid_argument) << most;
  }
  Problem unmade = problem;
  unmade.moves.push_back({.name = "unmade", .make = nullptr});
  EXPECT_THROW((void)reversible_jump(unmade, small()), std::invalid_argument);
}

TEST(ReversibleJump, RunsWithMinimalWarmupAndDraws) {
  const Problem problem = nested_means(1.0);
  const Posterior posterior = reversible_jump(problem, {.warmup = 1, .draws = 1});
  EXPECT_EQ(posterior.draws, 1);
}

TEST(ReversibleJump, StopsOnRequestAndKeepsItsDraws) {
  const Problem problem = toy::bumps();
  for (const char* stage : {"exploring", "tuning", "sampling"}) {
    Options options{.seed = 1, .warmup = 20000, .draws = 400000};
    options.progress = [&](const Options::Progress& p) { return std::string(p.stage) != stage; };
    const Posterior posterior = reversible_jump(problem, options);
    EXPECT_TRUE(posterior.stopped_early);
    for (const Chain& chain : posterior.chains) {
      EXPECT_EQ(chain.model.size(), static_cast<std::size_t>(posterior.draws));
      EXPECT_EQ(chain.theta.size(),
                chain.model.size() * static_cast<std::size_t>(posterior.dimension));
    }
  }
}

// y = A x + e with noise 1e-4 of the parameters' and columns nearly in a plane: a ridge about 10^4
// times narrower than the prior, on which chains tempered from the prior stop in different places.
// ln p(y) = ln N(y | 0, A Aᵀ + s² I) gives the exact odds. There is also a model without
// parameters, and one about 2000 times less probable.
Problem lopsided() {
  class Mean : public Likelihood {
   public:
    double log_likelihood(int, std::span<const double> x) override {
      return x.empty() ? 0.0 : -0.5 * (x[0] - 1.0) * (x[0] - 1.0) / 0.01;
    }
  };
  return {.space = ModelSpace::of_models({{"a", Normal{0.0, 1.0}}},
                                         {{"zero", 100, {}}, {"free", 1, {"a"}}}),
          .likelihood = [] { return std::make_unique<Mean>(); }};
}

TEST(ReversibleJump, CountsLikelihoodCallsWhileTuning) {
  std::vector<long> calls;
  Options options{.seed = 3, .chains = 2, .threads = 1, .warmup = 200000, .draws = 200};
  options.progress = [&](const Options::Progress& p) {
    if (std::string(p.stage) == "tuning") calls.push_back(p.likelihood_evaluations);
    return true;
  };
  static_cast<void>(reversible_jump(lopsided(), options));
  ASSERT_GE(calls.size(), 2U);
  EXPECT_GT(calls.back(), calls.front());
}

// The first draws of many chains.
Options one_draw_each() {
  return {.seed = 5, .chains = 400, .warmup = 1000, .draws = 1, .thin = 1};
}

int rare_draws(const Posterior& posterior) {
  int rare = 0;
  for (const Chain& chain : posterior.chains) rare += chain.model[0];
  return rare;
}

double most_rare_draws() {
  // Z = ∫ N(a; 0, 1) exp(-½ (a - 1)²/s²) da, s = 0.1
  const double z = std::sqrt(0.01 / 1.01) * std::exp(-0.5 / 1.01);
  const double expected = one_draw_each().chains * z / (z + 100.0);
  return expected + 4.9 * std::sqrt(expected) + 1.0;
}

// Tuning visits the models evenly; the first draws must not be affected.
TEST(ReversibleJump, BurnInRemovesTheBiasOfTuning) {
  const Problem problem = lopsided();
  const Posterior posterior = reversible_jump(problem, one_draw_each());
  EXPECT_LE(rare_draws(posterior), most_rare_draws());
}

// The control: the same run without burn-in before the draws.
TEST(ReversibleJumpControl, DetectsMissingBurnIn) {
  const Problem problem = lopsided();
  const Options options = one_draw_each();
  RunContext run(problem, options);
  RunState state = begin(run);
  explore(run, state);
  tune(run, state);
  prepare_draws(run, state);
  draw(run, state, 1);
  EXPECT_GT(rare_draws(state.posterior), 10.0 * most_rare_draws());
}

// With equal prior odds, the relative error of the rare model's probability is a tenth; with
// balanced draws, a hundredth.
TEST(ReversibleJump, BalancedDrawsReduceTheErrorOfARareModel) {
  const Problem problem = lopsided();
  const Posterior posterior = reversible_jump(problem, {.seed = 7, .balance = true});
  ASSERT_EQ(posterior.log_weight.size(), 2U);
  const double z = std::sqrt(0.01 / 1.01) * std::exp(-0.5 / 1.01);
  const double exact = z / (z + 100.0);
  const Verdict verdict = judge(posterior);
  EXPECT_TRUE(verdict.converged);
  EXPECT_NEAR(verdict.models[1].probability, exact, kSigmas * verdict.models[1].mcse);
  EXPECT_LT(verdict.models[1].mcse, 0.01 * exact);
}

// Every run reports its searches and the evidence of each model.
TEST(ReversibleJump, ReportsTheFindingsOfItsSearches) {
  const Posterior posterior = reversible_jump(lopsided(), {.seed = 9, .searches = 77});
  ASSERT_EQ(posterior.found.size(), 2U);
  const ModelFindings& found = posterior.found[1];
  EXPECT_EQ(found.climbs, 77);
  ASSERT_EQ(found.modes.size(), 1U);
  EXPECT_NEAR(found.modes[0].x[0], 1.0 / 1.01, 0.01);
  const double exact = 0.5 * std::log(0.01 / 1.01) - 0.5 / 1.01;
  // Too few draws for bridge sampling.
  for (const Evidence& evidence : {found.annealed, found.sampled})
    EXPECT_NEAR(evidence.log_evidence, exact, 4.9 * evidence.standard_error + 1e-6);
  EXPECT_EQ(posterior.found[0].sampled.log_evidence, 0.0);
}

TEST(ReversibleJump, FindsAPosteriorMuchNarrowerThanItsPrior) {
  constexpr Eigen::Index kData = 12, kParameters = 7;
  static constexpr double kNoiseSd = 1e-4;
  Eigen::MatrixXd design(kData, kParameters);
  Eigen::VectorXd y = Eigen::VectorXd::Zero(kData);
  base::Random random(1, 0, 0, base::Purpose::test);
  for (Eigen::Index i = 0; i < kData; ++i) {
    for (Eigen::Index j = 0; j < kParameters; ++j) {
      design(i, j) = j < 3 ? random.normal() : design(i, j - 3) + 0.03 * random.normal();
      y[i] += j + 1 < kParameters ? 0.5 * design(i, j) : 0.0;
    }
    y[i] += kNoiseSd * random.normal();
  }
  const auto log_evidence = [&](Eigen::Index columns) {
    const Eigen::MatrixXd a = design.leftCols(columns);
    const Eigen::MatrixXd c =
        a * a.transpose() + kNoiseSd * kNoiseSd * Eigen::MatrixXd::Identity(kData, kData);
    const Eigen::LLT<Eigen::MatrixXd> llt(c);
    const Eigen::VectorXd white = llt.matrixL().solve(y);
    const Eigen::MatrixXd l = llt.matrixL();
    return -0.5 * white.squaredNorm() - l.diagonal().array().log().sum();
  };
  class Line : public Likelihood {
   public:
    Line(Eigen::MatrixXd a, Eigen::VectorXd y) : a_(std::move(a)), y_(std::move(y)) {}
    double log_likelihood(int, std::span<const double> x) override {
      const auto n = static_cast<Eigen::Index>(x.size());
      const Eigen::VectorXd r =
          y_ - a_.leftCols(n) * Eigen::Map<const Eigen::VectorXd>(x.data(), n);
      return -0.5 * r.squaredNorm() / (kNoiseSd * kNoiseSd);
    }

   private:
    Eigen::MatrixXd a_;
    Eigen::VectorXd y_;
  };
  std::vector<Parameter> parameters;
  std::vector<std::string> names;
  for (Eigen::Index j = 0; j < kParameters; ++j) {
    names.push_back("x" + std::to_string(j));
    parameters.push_back({names.back(), Normal{0.0, 1.0}});
  }
  const std::vector<std::string> fewer(names.begin(), names.end() - 1);
  // Prior weights such that the posterior is 30 : 70.
  const double odds = std::exp(log_evidence(kParameters) - log_evidence(kParameters - 1));
  const Problem problem{.space = ModelSpace::of_models(
                            parameters, {{"without", 0.3, fewer}, {"with", 0.7 / odds, names}}),
                        .likelihood = [&] { return std::make_unique<Line>(design, y); }};
  const Posterior posterior = reversible_jump(problem, {.warmup = 6000, .draws = 4000});
  EXPECT_LT(rhat(indicator(posterior, 1)), 1.05);
  expect_probability(posterior, 1, 0.7);
  const double p = ks_of_draws(posterior, 1, 0, [&](double x) {
    const Eigen::MatrixXd precision = design.transpose() * design / (kNoiseSd * kNoiseSd) +
                                      Eigen::MatrixXd::Identity(kParameters, kParameters);
    const Eigen::VectorXd at = design.transpose() * y / (kNoiseSd * kNoiseSd);
    const double mean = precision.llt().solve(at)[0];
    const double sd = std::sqrt(precision.inverse()(0, 0));
    return 0.5 * std::erfc(-(x - mean) / (sd * std::numbers::sqrt2));
  });
  EXPECT_GT(p, 1e-6);
}

}  // namespace
}  // namespace wheeltap::inference
