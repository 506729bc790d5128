#include "emulator/experiment.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <set>
#include <thread>

namespace wheeltap::emulator {
namespace {

Design grid() {
  Factor a{"a", "", {}}, b{"b", "", {}};
  for (int i = 0; i < 20; ++i) {
    a.levels.push_back(i);
    b.levels.push_back(0.1 * i);
  }
  return full_factorial({a, b});
}

ModelFactory smooth() {
  return [] {
    return [](std::span<const double> x, std::span<double> y) {
      y[0] = std::sin(x[0]) + x[1];
      y[1] = x[0] * x[1];
    };
  };
}

TEST(Experiment, ResultsDoNotDependOnThreads) {
  const Design design = grid();
  const RowMatrix one = run_experiment(design, 2, smooth(), {.threads = 1});
  EXPECT_EQ(one(43, 1), design.points(43, 0) * design.points(43, 1));
  for (int threads : {2, 3, 8})
    EXPECT_EQ(one, run_experiment(design, 2, smooth(), {.threads = threads}));
}

TEST(Experiment, NoModelServesTwoThreadsAtOnce) {
  // A model that detects simultaneous calls from two threads.
  std::atomic<int> made{0};
  std::atomic<bool> shared{false};
  const ModelFactory factory = [&] {
    ++made;
    return [&shared, busy = std::make_shared<std::atomic<int>>(0)](std::span<const double> x,
                                                                   std::span<double> y) {
      if ((*busy)++ > 0) shared = true;
      std::this_thread::yield();
      y[0] = x[0];
      --*busy;
    };
  };
  (void)run_experiment(grid(), 1, factory, {.threads = 4});
  EXPECT_LE(made, 4);
  EXPECT_FALSE(shared);
}

TEST(Experiment, ProgressCountsEveryRunOnce) {
  std::set<Eigen::Index> seen;
  (void)run_experiment(grid(), 2, smooth(),
                       {.threads = 3, .progress = [&](Eigen::Index done, Eigen::Index total) {
                          EXPECT_EQ(total, 400);
                          EXPECT_TRUE(seen.insert(done).second);
                        }});
  EXPECT_EQ(seen.size(), 400u);
  EXPECT_EQ(*seen.rbegin(), 400);
}

TEST(Experiment, NamesTheFirstFailedRunForAnyNumberOfThreads) {
  const ModelFactory factory = [] {
    return [](std::span<const double> x, std::span<double> y) {
      if (x[0] >= 7) throw std::domain_error("the beam broke");
      y[0] = 0;
    };
  };
  for (int threads : {1, 2, 5}) try {
      (void)run_experiment(grid(), 1, factory, {.threads = threads});
      FAIL();
    } catch (const RunError& error) {
      EXPECT_EQ(error.run(), 140);
      EXPECT_STREQ(error.what(), "run 140 (a = 7, b = 0) failed: the beam broke");
      EXPECT_THROW(std::rethrow_if_nested(error), std::domain_error);
    }
}

TEST(Experiment, FailsIfAResponseIsNotFinite) {
  const ModelFactory factory = [] {
    return [](std::span<const double> x, std::span<double> y) {
      y[0] = 1;
      y[1] = x[0] > 3 ? std::nan("") : 0;
    };
  };
  try {
    (void)run_experiment(grid(), 2, factory);
    FAIL();
  } catch (const RunError& error) {
    EXPECT_EQ(error.run(), 80);
    EXPECT_NE(std::string(error.what()).find("response 1 is not finite"), std::string::npos);
  }
}

TEST(Experiment, ReportsAFactoryThatThrows) {
  const ModelFactory factory = []() -> Model { throw std::logic_error("no beam"); };
  EXPECT_THROW((void)run_experiment(grid(), 1, factory, {.threads = 2}), std::logic_error);
}

TEST(Experiment, RejectsInvalidInput) {
  EXPECT_THROW((void)run_experiment(grid(), 0, smooth()), std::invalid_argument);
  EXPECT_THROW((void)run_experiment(grid(), 2, smooth(), {.threads = 0}), std::invalid_argument);
  EXPECT_THROW((void)run_experiment({}, 2, smooth()), std::invalid_argument);
}

}  // namespace
}  // namespace wheeltap::emulator
