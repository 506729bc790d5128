// Evidence by additional methods (--evidence).
#include <gtest/gtest.h>

#include <cmath>

#include "apps/failure.hpp"
#include "apps/runs/running.hpp"
#include "apps/words.hpp"
#include "tests/inference/evidence/problems.hpp"

namespace wheeltap::apps {

using namespace identification;

namespace {

TEST(Evidence, AMethodThatFailsLeavesTheRunAndSaysWhy) {
  const inference::Problem problem = inference::never();
  const auto list =
      identification::compute_evidence(problem, evidence_methods("tmcmc+bridge"), 1, 1);
  ASSERT_EQ(list.size(), 2U);
  Findings findings;
  findings.models.push_back({.name = "only", .standing = {.probability = 1.0, .mcse = 0.0}});
  conclude(findings, problem.space, list);
  ASSERT_EQ(findings.remarks.size(), 2U) << "one per method, and no comparison without draws";
  const std::string said = sentence(findings.remarks[0], {});
  EXPECT_NE(said.find("by tmcmc failed: model 'only'"), std::string::npos) << said;
  for (const EvidenceFinding& by : findings.evidence) {
    EXPECT_TRUE(std::isnan(by.evidences[0].log_evidence));
    EXPECT_EQ(by.evidences[0].warnings.size(), 1U);
  }
}

TEST(Evidence, MethodsAreNamedOrRefused) {
  EXPECT_TRUE(evidence_methods("").empty());
  EXPECT_EQ(evidence_methods("laplace").at(0), EvidenceMethod::laplace);
  EXPECT_THROW((void)evidence_methods("tmcmc+guess"), Failure);
}

}  // namespace
}  // namespace wheeltap::apps
