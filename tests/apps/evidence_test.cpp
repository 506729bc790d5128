#include "apps/evidence.hpp"

#include <gtest/gtest.h>
#include <spdlog/sinks/null_sink.h>

#include <cmath>

#include "tests/inference/evidence/problems.hpp"

namespace wheeltap::apps {
namespace {

TEST(Evidence, AMethodThatFailsLeavesTheRunAndSaysWhy) {
  const inference::Problem problem = inference::never();
  spdlog::logger log("test", std::make_shared<spdlog::sinks::null_sink_st>());
  const auto list = compute_evidence(problem, "tmcmc+bridge", 1, 1, log);
  ASSERT_EQ(list.size(), 2U);
  std::vector<std::string> warnings;
  const Report report = evidence_report(
      problem.space, Report::array({{{"probability", 1.0}, {"mcse", 0.0}}}), list, warnings);
  ASSERT_EQ(warnings.size(), 2U) << "one of each method, and no comparison with nothing";
  EXPECT_NE(warnings[0].find("by tmcmc failed: model 'only'"), std::string::npos) << warnings[0];
  for (const std::string method : {"tmcmc", "bridge"}) {
    EXPECT_TRUE(report[method][0]["log_evidence"].is_null());
    EXPECT_EQ(report[method][0]["warnings"].size(), 1U);
  }
}

}  // namespace
}  // namespace wheeltap::apps
