// Evidences known exactly, by methods that share only the likelihood.
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
    for (const EvidenceWarning& w : b.warnings) std::printf("      %s\n", describe(w).c_str());
    // Student's t with 7 degrees of freedom; normal.
    EXPECT_NEAR(t.log_evidence, known, 6.0 * t.standard_error + 1e-6) << k;
    EXPECT_NEAR(b.log_evidence, known, 4.5 * b.standard_error + 1e-6) << k;
  }
}

// Coverage of ± 1, 2, 3 reported standard errors, and the ratio of the actual scatter of ln Z over
// seeds to the reported error. The error is that of Student's t with 7 degrees of freedom scaled by
// √(7/5), with coverages of 0.731, 0.951, 0.991 instead of a normal's 0.683, 0.954, 0.997.
TEST(PublishedEvidences, StandardErrorsAreCalibrated) {
  SKIP_WITHOUT_SHARED("coal");
  const auto exact =
      nlohmann::json::parse(std::ifstream(kShared / "validation" / "coal" / "exact.json"));
  const Problem problem = coal_problem(coal_days(), exact["length_days"], 0, 6);
  const bool full = std::getenv("WHEELTAP_LONG_TESTS") != nullptr;
  const int seeds = full ? 50 : 5;
  for (int k = 1; k <= (full ? 6 : 1); ++k) {
    const double known = exact["log_evidence_given_k_0_to_8"][static_cast<std::size_t>(k)];
    int within[3] = {0, 0, 0};
    double sum = 0.0, squares = 0.0, stated = 0.0;
    for (int seed = 1; seed <= seeds; ++seed) {
      const Evidence e =
          tmcmc(problem, k, {.seed = static_cast<std::uint64_t>(100 + seed)}).evidence;
      const double miss = e.log_evidence - known;
      for (int n = 0; n < 3; ++n) within[n] += std::fabs(miss) < (n + 1) * e.standard_error;
      sum += miss / seeds;
      squares += miss * miss / seeds;
      stated += e.standard_error / seeds;
    }
    std::printf(
        "    k = %d: within 1, 2, 3 standard errors: %d, %d, %d of %d; bias %+.3f, real error / "
        "stated %.2f\n",
        k, within[0], within[1], within[2], seeds, sum, std::sqrt(squares) / stated);
    // Lower counts have a probability below 1e-4 each: binomials of 0.73, 0.95 and 0.99.
    EXPECT_GE(within[0], full ? 24 : 0);
    EXPECT_GE(within[1], full ? 40 : 2);
    EXPECT_GE(within[2], full ? 45 : 3);
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
