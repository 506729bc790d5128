// Evidences known exactly, by methods that share nothing but the likelihood.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "inference/evidence/bridge_sampling.hpp"
#include "inference/evidence/comparison.hpp"
#include "inference/evidence/tmcmc.hpp"
#include "tests/inference/published_problems.hpp"

namespace wheeltap::inference {
namespace {

TEST(PublishedEvidences, CoalMiningDisasters) {
  SKIP_WITHOUT_SHARED("coal");
  const auto exact =
      nlohmann::json::parse(std::ifstream(kShared / "validation" / "coal" / "exact.json"));
  const Problem problem = coal_problem(coal_days(), exact["length_days"], 0, 6);
  const int last = std::getenv("WHEELTAP_LONG_TESTS") != nullptr ? 6 : 3;
  for (int k = 0; k <= last; ++k) {
    const double known = exact["log_evidence_given_k_0_to_8"][static_cast<std::size_t>(k)];
    const Evidence t = tmcmc(problem, k, {.seed = 1}).evidence;
    const Evidence b = bridge_sampling(problem, k, {.seed = 1});
    std::printf(
        "    k = %d: exact %.3f, TMCMC %+.3f ± %.3f (%ld calls), bridge %+.3f ± %.3f (%ld)\n", k,
        known, t.log_evidence - known, t.standard_error, t.likelihood_evaluations,
        b.log_evidence - known, b.standard_error, b.likelihood_evaluations);
    for (const std::string& w : b.warnings) std::printf("      %s\n", w.c_str());
    // Student's t with 7 degrees of freedom; normal.
    EXPECT_NEAR(t.log_evidence, known, 6.0 * t.standard_error + 1e-6) << k;
    EXPECT_NEAR(b.log_evidence, known, 4.5 * b.standard_error + 1e-6) << k;
  }
}

TEST(PublishedEvidences, HaldRegressions) {
  SKIP_WITHOUT_SHARED("hald");
  const auto exact =
      nlohmann::json::parse(std::ifstream(kShared / "validation" / "hald" / "exact.json"));
  const Problem problem = hald_problem();
  std::vector<Evidence> all;
  for (int m = 0; m < problem.space.size(); ++m)
    all.push_back(tmcmc(problem, m, {.seed = 1, .samples = 200}).evidence);
  const ImpliedProbabilities p = implied_probabilities(problem.space, all);
  for (int m = 0; m < problem.space.size(); ++m) {
    const std::string& name = problem.space[m].name;
    const auto i = static_cast<std::size_t>(m);
    EXPECT_NEAR(p.mean[i], exact["probability"][name].get<double>(),
                6.0 * p.standard_error[i] + 1e-8)
        << name;
    EXPECT_LT(p.standard_error[i], 0.03);
  }
}

}  // namespace
}  // namespace wheeltap::inference
