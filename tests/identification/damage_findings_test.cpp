#include "identification/structural/damage/findings/damage_findings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "identification/structural/defects/support.hpp"
#include "tests/identification/cases.hpp"

namespace wheeltap::identification {
namespace {

// Chains of two draws each with exactly known expected numbers.
inference::Posterior posterior_of(const DamageProblem& problem,
                                  const std::vector<std::vector<double>>& draws,
                                  const std::vector<int>& models) {
  inference::Posterior out;
  out.space = std::make_shared<const inference::ModelSpace>(problem.problem.space);
  out.dimension = problem.problem.space.max_dimension();
  out.draws = static_cast<int>(draws.size());
  for (int c = 0; c < 2; ++c) {
    inference::Chain chain;
    for (std::size_t i = 0; i < draws.size(); ++i) {
      chain.model.push_back(models[i]);
      chain.theta.append(draws[i].begin(), draws[i].end());
      chain.theta.resize((i + 1) * static_cast<std::size_t>(out.dimension), std::nan(""));
      chain.log_prior.push_back(0.0);
      chain.log_likelihood.push_back(0.0);
    }
    out.chains.push_back(std::move(chain));
  }
  return out;
}

TEST(DamageFindings, ExpectedNumbersAreThoseOfTheDraws) {
  const auto problem = make_damage_problem(small_beam(2), {});
  const auto posterior =
      posterior_of(*problem, {{}, {0.31, 0.2}, {0.32, 0.4}, {0.31, 0.3, 0.72, 0.5}}, {0, 1, 1, 2});
  const DamageFindings found = damage_findings(*problem, posterior, {}, 1);
  const KindFinding& kind = found.kinds[0];
  EXPECT_DOUBLE_EQ(std::accumulate(kind.expected.begin(), kind.expected.end(), 0.0), 1.0);
  EXPECT_DOUBLE_EQ(kind.expected[6], 0.75);
  EXPECT_DOUBLE_EQ(kind.expected[14], 0.25);
  EXPECT_DOUBLE_EQ(kind.given_count.at(1)[6], 1.0);
  EXPECT_DOUBLE_EQ(kind.given_count.at(2)[14], 1.0);
  ASSERT_EQ(kind.places.size(), 2U);
  EXPECT_DOUBLE_EQ(kind.places[0].from, 0.3);
  EXPECT_DOUBLE_EQ(kind.places[0].expected, 0.75);
  EXPECT_NEAR(kind.places[0].severity->mean, 0.3, 1e-12);
  EXPECT_TRUE(found.folded.empty()) << "a cantilever is not symmetric";
}

TEST(DamageFindings, FoldsPlacesOfASymmetricBeam) {
  DamageCase damage_case = small_beam(1);
  damage_case.beam.supports = fem::named_supports("simply-supported", 1.0);
  damage_case.data.frequencies_hz = elastic_frequencies(damage_case.beam, {}, 4);
  const auto problem = make_damage_problem(damage_case, {});
  ASSERT_TRUE(problem->symmetric);
  const auto posterior =
      posterior_of(*problem, {{0.3, 0.2}, {0.7, 0.2}, {0.32, 0.3}, {0.68, 0.3}}, {1, 1, 1, 1});
  const DamageFindings found = damage_findings(*problem, posterior, {}, 1);
  ASSERT_EQ(found.folded.size(), 2U);
  EXPECT_TRUE(found.folded[0].empty());
  EXPECT_NEAR(found.shown(1)[0].estimate.mean, 0.31, 1e-12);
  EXPECT_NEAR(found.shown(1)[0].estimate.q97_5, 0.32, 1e-3);
  ASSERT_TRUE(found.symmetry);
  EXPECT_DOUBLE_EQ(found.symmetry->chains[0].left, 0.5);
  EXPECT_TRUE(std::ranges::any_of(found.remarks, [](const Remark& r) {
    return std::holds_alternative<remark::MirrorImages>(r);
  }));
}

bool blames_one_factor(const std::vector<double>& frequencies_hz) {
  DamageCase damage_case = small_beam(2);
  damage_case.data.frequencies_hz = frequencies_hz;
  damage_case.data.sd_hz.clear();
  for (const double f : frequencies_hz) damage_case.data.sd_hz.push_back(0.001 * f);
  const auto problem = make_damage_problem(damage_case, {});
  const auto posterior = posterior_of(*problem, {{0.3, 0.5}, {0.31, 0.2, 0.7, 0.5}}, {1, 2});
  const DamageFindings found = damage_findings(*problem, posterior, {}, 1);
  return std::ranges::any_of(found.remarks, [](const Remark& r) {
    const auto* factor = std::get_if<remark::CommonFactor>(&r);
    if (factor != nullptr) {
      EXPECT_NEAR(factor->factor, 0.96, 1e-3);
    }
    return factor != nullptr;
  });
}

TEST(DamageFindings, ReportsThatOneFactorExplainsAllFrequencies) {
  const fem::Beam beam = small_beam(1).beam;
  std::vector<double> scaled = elastic_frequencies(beam, {}, 4);
  EXPECT_FALSE(blames_one_factor(scaled)) << "the intact structure fits without a factor";
  for (double& f : scaled) f *= 0.96;
  EXPECT_TRUE(blames_one_factor(scaled));
  const fem::Defects damage{.damages = {{0.305, 0.5}}, .supports = {}};
  EXPECT_FALSE(blames_one_factor(elastic_frequencies(beam, damage, 4)));
}

TEST(Unknowns, AreIdentifiedByPositionAndNotByLabel) {
  DamageCase damage_case = small_beam(2);
  damage_case.kinds.push_back({.type = &defects::kSupport,
                               .name = "bearing",
                               .plural = "bearings",
                               .max_count = 1,
                               .weights = {},
                               .location = inference::Uniform{0.0, 1.0},
                               .severity = inference::Prior(inference::LogUniform{1e2, 1e6}),
                               .truth = {}});
  const auto problem = make_damage_problem(damage_case, {});
  const auto& space = problem->problem.space;
  const std::vector<int> both = {2, 1};
  const auto list = unknowns(space, space.find(both));
  ASSERT_EQ(list.size(), 6U);
  EXPECT_EQ(list[2].label, "damage location[2]");
  EXPECT_EQ(list[2].component, 1);
  EXPECT_EQ(list[3].label, "reduction[2]");
  EXPECT_EQ(list[4].label, "bearing location[1]");
  EXPECT_EQ(list[4].kind, 1);
  EXPECT_EQ(list[5].name, "stiffness");
  EXPECT_EQ(list[5].parameter, 1);
}

}  // namespace
}  // namespace wheeltap::identification
