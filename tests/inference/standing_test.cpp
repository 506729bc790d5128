#include "inference/diagnosis/standing.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/inference/made_up_posterior.hpp"

namespace wheeltap::inference {
namespace {

using testing::Each;
using testing::ElementsAre;

Standings stand(const Posterior& posterior) {
  const ModelShares shares = model_shares(posterior);
  return standings(posterior, shares, mixing(posterior, shares, {}));
}

double sum(const Standings& all) {
  double out = 0.0;
  for (const ModelStanding& m : all.models) out += m.probability;
  return out;
}

TEST(Standing, UsesDrawsForModelsThatEveryChainVisited) {
  const Posterior posterior = made_up::run({{0.6, 0.3, 0.1}});
  const ModelShares shares = model_shares(posterior);
  const Standings all = stand(posterior);
  for (std::size_t m = 0; m < 3; ++m) {
    EXPECT_EQ(all.models[m].basis, Basis::draws);
    EXPECT_NEAR(all.models[m].probability, shares.share[m], 1e-12);
    EXPECT_EQ(all.models[m].visited, 4);
    EXPECT_TRUE(all.evidence_of_draws[m]);
  }
  EXPECT_THAT(all.missed, Each(false));
  EXPECT_NEAR(sum(all), 1.0, 1e-12);
}

// Two models drawn 2 : 1, and a third without draws with P = 0.25 by evidence: the others share the
// rest.
TEST(Standing, UsesEvidenceForAModelWithoutDraws) {
  Posterior posterior = made_up::run({{2.0 / 3.0, 1.0 / 3.0, 0.0}});
  posterior.found[2].bridged = made_up::kUnknown;
  posterior.found[2].sampled = {.log_evidence = -50.0 + std::log(1.0 / 3.0), .standard_error = 0.1};
  const Standings all = stand(posterior);
  EXPECT_THAT(all.missed, ElementsAre(false, false, true));
  const ModelStanding& third = all.models[2];
  EXPECT_EQ(third.basis, Basis::evidence);
  EXPECT_EQ(third.visited, 0);
  EXPECT_NEAR(third.probability, 0.25, 1e-12);
  // ∂P/∂ln Z = P (1 - P) for its own evidence, and less for the others', which are known to 0.01.
  EXPECT_NEAR(third.mcse, 0.25 * 0.75 * 0.1, 2e-4);
  const ModelShares shares = model_shares(posterior);
  EXPECT_NEAR(all.models[0].probability, 0.75 * shares.share[0], 1e-12);
  EXPECT_GT(all.models[0].mcse, shares.share[0] * third.mcse)
      << "the leaver's error is theirs, too";
  EXPECT_NEAR(sum(all), 1.0, 1e-12);
}

TEST(Standing, RareModelsNeedNotBeVisited) {
  // P of about 1e-8 by evidence: no draw is expected in 4000 per chain.
  Posterior posterior = made_up::run({{0.7, 0.3, 0.0}});
  posterior.found[2].bridged = {.log_evidence = -68.0, .standard_error = 0.1};
  const Standings all = stand(posterior);
  EXPECT_THAT(all.missed, Each(false));
  EXPECT_EQ(all.models[2].basis, Basis::evidence) << "it has no draws";
  EXPECT_NEAR(all.models[2].probability / std::exp(-18.0), 1.0, 0.01);
}

// P = .6, .3 and .1: 3 % more of the first would give 1.03 · .6 / (1 + .03 · .6).
TEST(Standing, ErrorIncludesTheExcessOfSmcDraws) {
  Posterior posterior = made_up::run({{0.6, 0.3, 0.1}});
  const Standings before = stand(posterior);
  ModelFindings& found = posterior.found[0];
  found.annealed_beyond = 0.035;
  found.annealed_draws = 1200;
  found.beyond_mixture = 0.005;
  found.beyond_mixture_ess = 200.0;
  const Standings after = stand(posterior);
  const auto more = [&](std::size_t m) {
    return std::sqrt(std::pow(after.models[m].mcse, 2) - std::pow(before.models[m].mcse, 2));
  };
  EXPECT_EQ(after.models[0].probability, before.models[0].probability);
  EXPECT_NEAR(more(0), 0.6 * 0.4 * 0.03, 1e-4);
  EXPECT_NEAR(more(1), 0.3 * 0.6 * 0.03, 1e-4);
  EXPECT_NEAR(after.models[0].log_evidence_se, std::hypot(before.models[0].log_evidence_se, 0.03),
              1e-12);
  found.beyond_mixture_ess = 40000.0;  // 200 visits: the chains are reliable
  EXPECT_EQ(stand(posterior).models[0].mcse, before.models[0].mcse);
}

TEST(Standing, UsesTheBestAvailableEvidence) {
  Posterior posterior = made_up::run({{0.6, 0.3, 0.1}});
  // There is also bridge sampling.
  posterior.found[0].sampled = {.log_evidence = -1.0, .standard_error = 0.1};
  posterior.found[1].bridged = made_up::kUnknown;
  posterior.found[1].sampled = {.log_evidence = -51.5, .standard_error = 2.0};  // too uncertain
  posterior.found[1].annealed = {.log_evidence = -51.0, .standard_error = 0.3};
  posterior.found[2].bridged = made_up::kUnknown;
  const Standings all = stand(posterior);
  EXPECT_NEAR(all.models[0].log_evidence, -50.0 + std::log(0.6), 1e-12);
  EXPECT_EQ(all.models[1].log_evidence, -51.0);
  EXPECT_TRUE(std::isnan(all.models[2].log_evidence));
  EXPECT_THAT(all.evidence_of_draws, ElementsAre(true, false, false));
  EXPECT_EQ(all.models[2].basis, Basis::draws);
  EXPECT_NEAR(sum(all), 1.0, 1e-12);
}

TEST(Standing, ErrorIsNaNIfNothingIsKnown) {
  Posterior posterior = made_up::run({{0.7, 0.3, 0.0}});
  for (ModelFindings& found : posterior.found) found.bridged = made_up::kUnknown;
  const Standings all = stand(posterior);
  EXPECT_EQ(all.models[2].probability, 0.0);
  EXPECT_TRUE(std::isnan(all.models[2].mcse));
}

// Independent draws, shares 0.6 and 0.3: ln B is ln (s_a / s_b) - ln (prior odds), and its standard
// error √((1/s_a + 1/s_b) / n).
TEST(Standing, BayesFactorsOfVisitedModelsComeFromDraws) {
  Posterior posterior = made_up::run({{0.6, 0.3, 0.1}});
  const ModelShares shares = model_shares(posterior);
  const Estimate found = log_bayes_factor(posterior, 0, 1);
  EXPECT_NEAR(found.value, std::log(shares.share[0] / shares.share[1]), 1e-12)
      << "models of equal prior probability";
  const double error = std::sqrt((1.0 / 0.6 + 1.0 / 0.3) / (4.0 * made_up::kDraws));
  EXPECT_NEAR(found.mcse / error, 1.0, 0.15);
  EXPECT_NEAR(log_bayes_factor(posterior, 1, 0).value, -found.value, 1e-12);
  const Estimate itself = log_bayes_factor(posterior, 1, 1);
  EXPECT_EQ(itself.value, 0.0);
  EXPECT_EQ(itself.mcse, 0.0);
}

// exp(-800) underflows; the evidences keep the ratio.
TEST(Standing, BayesFactorsThatUnderflowComeFromEvidences) {
  Posterior posterior = made_up::run({{0.7, 0.3, 0.0}});
  posterior.found[2].bridged = {.log_evidence = -850.0, .standard_error = 0.4};
  const Estimate found = log_bayes_factor(posterior, 0, 2);
  EXPECT_NEAR(found.value, 800.0 + std::log(0.7), 1e-9);
  EXPECT_NEAR(found.mcse, std::hypot(0.4, 0.01), 1e-12);
}

}  // namespace
}  // namespace wheeltap::inference
