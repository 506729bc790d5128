#include "apps/runs/time_left.hpp"

#include <gtest/gtest.h>

namespace wheeltap::apps {
namespace {

inference::Options::Progress progress(const char* stage, double fraction, long calls,
                                      double to_come) {
  return {.stage = stage,
          .fraction = fraction,
          .likelihood_evaluations = calls,
          .evaluations_to_come = to_come,
          .model_probabilities = {}};
}

TEST(TimeLeft, IsTheRestOfTheStageAndTheCallsToCome) {
  TimeLeft left;
  EXPECT_FALSE(left.estimate(progress("tuning", 0.0, 0, 4000.0), 0.0));
  EXPECT_FALSE(left.estimate(progress("tuning", 0.1, 50, 4000.0), 0.5));
  const auto seconds = left.estimate(progress("tuning", 0.25, 500, 4000.0), 5.0);
  ASSERT_TRUE(seconds);
  EXPECT_DOUBLE_EQ(*seconds, 15.0 + 40.0);
}

// A search counts the calls of a model after finishing it.
TEST(TimeLeft, AStageThatHasCountedFewCallsGoesByTheRunsPace) {
  TimeLeft left;
  static_cast<void>(left.estimate(progress("exploring", 0.5, 10000, 0.0), 1.0));
  static_cast<void>(left.estimate(progress("searching", 0.0, 20000, 600000.0), 2.0));
  const auto seconds = left.estimate(progress("searching", 0.25, 20001, 600000.0), 10.0);
  ASSERT_TRUE(seconds);
  EXPECT_NEAR(*seconds, 24.0 + 300.0, 0.1);
}

TEST(TimeLeft, WhatWasDoneBeforeAResumeCountsForNothing) {
  TimeLeft left;
  static_cast<void>(left.estimate(progress("sampling", 0.5, 0, 0.0), 0.0));
  const auto seconds = left.estimate(progress("sampling", 0.75, 100, 0.0), 2.0);
  ASSERT_TRUE(seconds);
  EXPECT_DOUBLE_EQ(*seconds, 2.0);
}

// Searches on the first samples of a record are cheap; later stages are not.
TEST(TimeLeft, CallsToComeTakeNoLessThanALikelihoodWasMeasuredToTake) {
  TimeLeft left(0.01);
  static_cast<void>(left.estimate(progress("searching", 0.0, 0, 6000.0), 0.0));
  const auto seconds = left.estimate(progress("searching", 0.5, 10000, 6000.0), 2.0);
  ASSERT_TRUE(seconds);
  EXPECT_DOUBLE_EQ(*seconds, 2.0 + 60.0);
}

// Fault: the bar showed 60 % while the time left grew from 74 s to 20 min.
TEST(TimeLeft, ShareAndTimeLeftBelongTogether) {
  TimeLeft left;
  EXPECT_FALSE(left.of_run(progress("exploring", 0.6, 0, 4000.0), 0.5).left);
  EXPECT_EQ(left.of_run(progress("exploring", 0.6, 0, 4000.0), 0.5).fraction, 0.0);
  const auto first = left.of_run(progress("exploring", 0.75, 500, 4000.0), 5.5);
  ASSERT_TRUE(first.left);
  EXPECT_NEAR(first.fraction, 5.5 / (5.5 + *first.left), 1e-12);
  // The pace of a new stage is not known yet: the time left decreases.
  const auto next = left.of_run(progress("tuning", 0.0, 500, 4000.0), 6.5);
  ASSERT_TRUE(next.left);
  EXPECT_NEAR(*next.left, *first.left - 1.0, 1e-9);
  EXPECT_GT(next.fraction, first.fraction);
}

}  // namespace
}  // namespace wheeltap::apps
