#include "identification/structural/damage/findings/merged_damages.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "identification/structural/damage/findings/damage_findings.hpp"
#include "identification/structural/defects/reduction.hpp"
#include "tests/identification/cases.hpp"

namespace wheeltap::identification {
namespace {

// A cantilever of 100 elements of 10 mm, with four modes known to 0.1 %.
DamageCase fine_beam(const fem::Defects& truth) {
  DamageCase out = small_beam(3);
  out.beam.elements = 100;
  out.data.frequencies_hz = elastic_frequencies(out.beam, truth, 4);
  for (std::size_t i = 0; i < 4; ++i) out.data.sd_hz[i] = 0.001 * out.data.frequencies_hz[i];
  return out;
}

// Chains of equal draws of one model, which is by far the most probable.
DamageFindings found_in(const DamageProblem& problem, int model,
                        const std::vector<std::vector<double>>& draws) {
  inference::Posterior posterior;
  posterior.space = std::make_shared<const inference::ModelSpace>(problem.problem.space);
  posterior.dimension = problem.problem.space.max_dimension();
  posterior.draws = static_cast<int>(draws.size());
  posterior.likelihood_evaluations = 1;
  for (int c = 0; c < 2; ++c) {
    inference::Chain chain;
    for (std::size_t i = 0; i < draws.size(); ++i) {
      chain.model.push_back(model);
      chain.theta.append(draws[i].begin(), draws[i].end());
      chain.theta.resize((i + 1) * static_cast<std::size_t>(posterior.dimension), std::nan(""));
      chain.log_prior.push_back(0.0);
      chain.log_likelihood.push_back(-1.0);  // not 0: a run with data
    }
    posterior.chains.push_back(std::move(chain));
  }
  return damage_findings(problem, posterior, {}, 1);
}

bool says_neighbours(const DamageFindings& found) {
  return std::ranges::any_of(found.remarks, [](const Remark& r) {
    return std::holds_alternative<remark::NeighbouringDamages>(r);
  });
}

// Regression: one damage of 30 mm on elements of 8 mm gave "two damages (> 99.9 %)" silently.
TEST(MergedDamages, MergesNeighboursThatOneLongerDamageExplains) {
  const fem::Defects truth{.damages = {{0.305, 0.3}, {0.315, 0.3}, {0.325, 0.3}}, .supports = {}};
  const auto problem = make_damage_problem(fine_beam(truth), {});
  // The same flexibility in two elements: 10 mm with r / (1 - r) = 0.643 each.
  const DamageFindings found = found_in(*problem, 2,
                                        {{0.305, 0.39, 0.325, 0.39},
                                         {0.303, 0.4, 0.327, 0.39},
                                         {0.315, 0.39, 0.316, 0.39},
                                         {0.305, 0.39, 0.325, 0.39}});
  const MergedFinding* merged = found.merged_of(0);
  ASSERT_NE(merged, nullptr);
  EXPECT_NEAR(merged->merged, 1.0, 1e-12);
  EXPECT_NEAR(merged->count[1], 1.0, 1e-12);
  EXPECT_NEAR(std::accumulate(merged->count.begin(), merged->count.end(), 0.0), 1.0, 1e-12);
  const MergedModel* model = merged->of(2);
  ASSERT_NE(model, nullptr);
  EXPECT_EQ(model->count, 1);
  EXPECT_NEAR(model->location.q50, 0.315, 0.002);
  EXPECT_NEAR(model->fixed, 0.01, 1e-12);
  // L²/12 = 10² + 10²/12 mm² for damages 20 mm apart.
  EXPECT_NEAR(model->length.q50, std::sqrt(12.0) * 0.01 * std::sqrt(1.0 + 1.0 / 12.0), 2e-3);
  EXPECT_LT(std::abs(model->gain), 0.5);
  EXPECT_TRUE(says_neighbours(found));
}

TEST(MergedDamages, DistantDamagesAreNotMerged) {
  const fem::Defects truth{.damages = {{0.205, 0.4}, {0.405, 0.4}}, .supports = {}};
  const auto problem = make_damage_problem(fine_beam(truth), {});
  const DamageFindings found = found_in(*problem, 2,
                                        {{0.205, 0.4, 0.405, 0.4},
                                         {0.205, 0.41, 0.405, 0.39},
                                         {0.205, 0.4, 0.405, 0.4},
                                         {0.205, 0.4, 0.405, 0.4}});
  const MergedFinding* merged = found.merged_of(0);
  ASSERT_NE(merged, nullptr);
  EXPECT_NEAR(merged->count[2], 1.0, 1e-12);
  EXPECT_EQ(merged->of(2), nullptr);
  EXPECT_FALSE(says_neighbours(found));
}

TEST(MergedDamages, MergesTwoNeighboursOfThree) {
  const fem::Defects truth{.damages = {{0.205, 0.3}, {0.215, 0.3}, {0.605, 0.4}}, .supports = {}};
  const auto problem = make_damage_problem(fine_beam(truth), {});
  const std::vector<double> draw = {0.205, 0.3, 0.215, 0.3, 0.605, 0.4};
  const DamageFindings found = found_in(*problem, 3, {draw, draw, draw, draw});
  const MergedFinding* merged = found.merged_of(0);
  ASSERT_NE(merged, nullptr);
  EXPECT_NEAR(merged->count[2], 1.0, 1e-12);
  ASSERT_NE(merged->of(3), nullptr);
  EXPECT_NEAR(merged->of(3)->location.q50, 0.21, 1e-6);
}

TEST(MergedDamages, AnInferredExtentNeedsNoMerging) {
  DamageCase damage_case = fine_beam({});
  damage_case.kinds[0].extent_prior = inference::Uniform{0.0, 0.2};
  EXPECT_FALSE(has_fixed_extent(damage_case.kinds[0]));
  const auto problem = make_damage_problem(damage_case, {});
  const std::vector<double> draw = {0.205, 0.1, 0.01, 0.215, 0.1, 0.01};
  const DamageFindings found = found_in(*problem, 2, {draw, draw, draw, draw});
  EXPECT_EQ(found.merged_of(0), nullptr);
}

}  // namespace
}  // namespace wheeltap::identification
