// Queries on made-up runs of independent draws, for which every result and its error are known.
#include "inference/diagnosis/posterior.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <memory>

#include "base/constants.hpp"
#include "base/random.hpp"
#include "inference/engine/reversible_jump.hpp"

namespace wheeltap::inference::posterior_test {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kPosteriorSigmas = 4.9;  // false-alarm rate 10⁻⁶ per comparison
constexpr int kPosteriorDraws = 4000;

// Two models of different dimension: 70 : 30, prior weights 1 : 2.
Posterior made_up(double p = 0.3) {
  Posterior posterior;
  posterior.space = std::make_shared<const ModelSpace>(
      ModelSpace::of_models({{"k", Normal{0.0, 1.0}}, {"c", Normal{0.0, 1.0}}},
                            {{"linear", 1.0, {"c"}}, {"cubic", 2.0, {"k", "c"}}}));
  posterior.dimension = 2;
  posterior.draws = kPosteriorDraws;
  posterior.likelihood_evaluations = 1;
  for (std::uint64_t c = 0; c < 4; ++c) {
    base::Random random(15, c, 0, base::Purpose::test);
    Chain chain;
    for (int i = 0; i < kPosteriorDraws; ++i) {
      const bool cubic = random.uniform() < p;
      chain.model.push_back(cubic ? 1 : 0);
      chain.theta.push_back(cubic ? 3.0 + random.normal() : random.normal());
      chain.theta.push_back(cubic ? random.normal() : kNaN);
      chain.log_prior.push_back(-1.0);
      chain.log_likelihood.push_back(random.normal());
    }
    posterior.chains.push_back(std::move(chain));
  }
  for (const double share : {1.0 - p, p}) {
    const double prior = share == p ? 2.0 : 1.0;
    posterior.found.push_back(
        {.climbs = 100,
         .modes = {},
         .bridged = {.log_evidence = -20.0 + std::log(share / prior), .standard_error = 0.01}});
  }
  return posterior;
}

TEST(Posterior, ProbabilityHasItsError) {
  const Posterior posterior = made_up();
  const double error = std::sqrt(0.3 * 0.7 / (4.0 * kPosteriorDraws));
  const Estimate p = posterior.probability("cubic");
  EXPECT_NEAR(p.value, 0.3, kPosteriorSigmas * error);
  EXPECT_NEAR(p.mcse / error, 1.0, 0.2);
  EXPECT_EQ(posterior.probability(1).value, p.value);
  EXPECT_NEAR(posterior.probability("linear").value + p.value, 1.0, 1e-12);
}

// ln odds have the error 1/√(n p (1 - p)): shares that sum to one have correlated errors; adding
// them in quadrature would be wrong by √2.
TEST(Posterior, BayesFactorHasItsError) {
  const Posterior posterior = made_up();
  const double exact = std::log(0.3 / 0.7) - std::log(2.0);
  const double error = 1.0 / std::sqrt(4.0 * kPosteriorDraws * 0.3 * 0.7);
  const Estimate b = posterior.log_bayes_factor("cubic", "linear");
  EXPECT_NEAR(b.value, exact, kPosteriorSigmas * error);
  EXPECT_NEAR(b.mcse / error, 1.0, 0.2);
  const Estimate reverse = posterior.log_bayes_factor(0, 1);
  EXPECT_NEAR(reverse.value, -b.value, 1e-12);
  EXPECT_NEAR(reverse.mcse, b.mcse, 1e-12);
  EXPECT_EQ(posterior.log_bayes_factor(1, 1).value, 0.0);
}

TEST(Posterior, BayesFactorOfAModelWithoutDrawsComesFromItsEvidence) {
  Posterior posterior = made_up(0.0);
  posterior.found[0].bridged = {.log_evidence = -20.0, .standard_error = 0.03};
  posterior.found[1].bridged = {.log_evidence = -900.0, .standard_error = 0.04};
  const Estimate b = posterior.log_bayes_factor("cubic", "linear");
  EXPECT_NEAR(b.value, -880.0, 1e-9);  // a probability would have underflowed
  EXPECT_NEAR(b.mcse, 0.05, 1e-12);
  posterior.found.clear();
  EXPECT_TRUE(std::isnan(posterior.log_bayes_factor("cubic", "linear").value));
}

TEST(Posterior, ParameterDrawsBelongToTheirModel) {
  const Posterior posterior = made_up();
  const ChainsOf k = posterior.draws_of("k", "cubic");
  const ChainsOf c = posterior.draws_of("c", 0);
  ASSERT_EQ(k.size(), 4U);
  std::size_t n = 0;
  for (std::size_t chain = 0; chain < 4; ++chain) {
    EXPECT_EQ(k[chain].size() + c[chain].size(), static_cast<std::size_t>(kPosteriorDraws));
    n += k[chain].size();
  }
  EXPECT_NEAR(mean(k), 3.0, kPosteriorSigmas / std::sqrt(static_cast<double>(n)));
  EXPECT_NEAR(mean(c), 0.0,
              kPosteriorSigmas / std::sqrt(4.0 * kPosteriorDraws - static_cast<double>(n)));
}

TEST(Posterior, ReportsConvergenceWithReasons) {
  Posterior posterior = made_up();
  EXPECT_TRUE(posterior.converged());
  EXPECT_TRUE(posterior.why_not().empty());
  posterior.stopped_early = true;
  EXPECT_FALSE(posterior.converged());
  const std::vector<Reason> why = posterior.why_not();
  ASSERT_EQ(why.size(), 1U);
  EXPECT_TRUE(std::holds_alternative<StoppedEarly>(why[0]));
  EXPECT_EQ(describe(why[0], *posterior.space), "The run stopped early.");
}

TEST(Posterior, RejectsUnknownModelsAndParameters) {
  const Posterior posterior = made_up();
  EXPECT_THAT([&] { (void)posterior.probability("quintic"); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("'quintic' among 'linear', 'cubic'")));
  EXPECT_THAT([&] { (void)posterior.draws_of("k", "linear"); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("'k' among 'c'")));
  EXPECT_THROW((void)posterior.probability(2), std::invalid_argument);
  EXPECT_THROW((void)posterior.log_bayes_factor(-1, 0), std::invalid_argument);
}

Problem made_problem() {
  class Flat : public Likelihood {
   public:
    double log_likelihood(int, std::span<const double>) override { return 0.0; }
  };
  return {.space = ModelSpace::of_models({{"a", Normal{0.0, 1.0}}},
                                         {{"none", 1.0, {}}, {"one", 1.0, {"a"}}}),
          .likelihood = [] { return std::make_unique<Flat>(); }};
}

// Regression: the posterior referred to a problem that was a temporary.
TEST(Posterior, OutlivesItsProblem) {
  const Options options{.chains = 2, .warmup = 200, .draws = 200};
  const Posterior of_temporary = reversible_jump(made_problem(), options);
  EXPECT_EQ((*of_temporary.space)[1].name, "one");
  EXPECT_EQ(of_temporary.draws_of("a", "one").size(), 2U);

  Problem changed = made_problem();
  const Posterior of_changed = reversible_jump(changed, options);
  changed.space = ModelSpace::of_models({{"b", Normal{0.0, 1.0}}}, {{"other", 1.0, {"b"}}});
  EXPECT_EQ(of_changed.space->size(), 2);
  EXPECT_EQ((*of_changed.space)[1].name, "one");

  const Posterior copied = of_changed;
  EXPECT_EQ((*copied.space)[0].name, "none");
}

}  // namespace
}  // namespace wheeltap::inference::posterior_test
