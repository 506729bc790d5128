#include "inference/progress_monitor.hpp"

#include <gtest/gtest.h>

#include <string>

namespace wheeltap::inference {
namespace {

TEST(ProgressMonitor, ReportsStageShareCallsAndProbabilities) {
  Options::Progress last{};
  int calls = 0;
  Options options;
  options.progress = [&](const Options::Progress& p) {
    last = p;
    ++calls;
    return true;
  };
  ProgressMonitor monitor(options, 2);
  monitor.begin("tuning", 200.0, 5000.0);
  monitor.evaluated(31);
  EXPECT_TRUE(monitor.advance(50.0));  // the monitor reports the start of a stage at once
  ASSERT_EQ(calls, 1);
  EXPECT_EQ(std::string(last.stage), "tuning");
  EXPECT_EQ(last.fraction, 0.25);
  EXPECT_EQ(last.likelihood_evaluations, 31);
  EXPECT_EQ(last.evaluations_to_come, 5000.0);
  EXPECT_TRUE(last.model_probabilities.empty());
  monitor.begin("sampling", 10.0);
  monitor.visited({3, 1});
  EXPECT_TRUE(monitor.advance(20.0));
  EXPECT_EQ(last.fraction, 1.0);
  EXPECT_EQ(last.model_probabilities, (std::vector<double>{0.75, 0.25}));
}

TEST(ProgressMonitor, PassesOnTheRequestToStop) {
  Options options;
  options.progress = [](const Options::Progress&) { return false; };
  ProgressMonitor monitor(options, 1);
  monitor.begin("exploring", 1.0);
  EXPECT_FALSE(monitor.stopped());
  EXPECT_FALSE(monitor.advance(0.1));
  EXPECT_TRUE(monitor.stopped());
  EXPECT_FALSE(monitor.advance(0.1));
}

TEST(ProgressMonitor, ContinuesWithoutACallback) {
  const Options options;
  ProgressMonitor monitor(options, 1);
  monitor.begin("exploring", 1.0);
  EXPECT_TRUE(monitor.advance(1.0));
}

}  // namespace
}  // namespace wheeltap::inference
