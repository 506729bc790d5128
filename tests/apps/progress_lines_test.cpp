#include <gtest/gtest.h>

#include "apps/results/terminal.hpp"

namespace wheeltap::apps {
namespace {

constexpr double kUnknown = -1.0;

TEST(ProgressLines, TellEachStageAtOnce) {
  ProgressLines lines;
  EXPECT_EQ(lines.next("searching", 0.0, 0.0, kUnknown, ""), "searching: 0 %, 0 s so far");
  EXPECT_EQ(lines.next("sampling", 0.02, 1.0, 73.0, "P(b) = 0.75"),
            "sampling: 2 %, 1 s so far, about 73 s left, P(b) = 0.75");
}

TEST(ProgressLines, KeepATenthAndFiveSecondsApart) {
  ProgressLines lines;
  ASSERT_TRUE(lines.next("sampling", 0.0, 10.0, kUnknown, ""));
  EXPECT_FALSE(lines.next("sampling", 0.5, 12.0, 2.0, ""));   // too soon
  EXPECT_FALSE(lines.next("sampling", 0.05, 20.0, 9.0, ""));  // too little
  EXPECT_TRUE(lines.next("sampling", 0.11, 20.0, 8.0, ""));
  EXPECT_FALSE(lines.next("sampling", 0.2, 30.0, 8.0, ""));
  EXPECT_TRUE(lines.next("sampling", 0.22, 30.0, 8.0, ""));
}

TEST(ProgressLines, SpeakAfterHalfAMinuteAnyway) {
  ProgressLines lines;
  ASSERT_TRUE(lines.next("sampling", 0.0, 0.0, kUnknown, ""));
  EXPECT_FALSE(lines.next("sampling", 0.01, 29.0, 3000.0, ""));
  EXPECT_TRUE(lines.next("sampling", 0.01, 31.0, 3000.0, ""));
}

TEST(ProgressLines, NameTheLikeliestOfManyModels) {
  const auto so_far = [](const std::vector<double>& p, const std::vector<std::string>& names) {
    return probabilities_so_far(models_so_far(p, names));
  };
  EXPECT_EQ(so_far({}, {}), "");
  EXPECT_EQ(so_far({0.25, 0.75}, {"a", "b"}), "P(b) = 0.75, P(a) = 0.25");
  const std::vector<std::string> names = {"a", "b", "c", "d", "e", "f", "g"};
  EXPECT_EQ(so_far({0, 0, 0, 0.02, 0, 0.975, 0.005}, names), "P(f) = 0.97, P(d) = 0.02");
  EXPECT_EQ(so_far({0, 0, 0, 0, 0, 0.998, 0.002}, names), "P(f) = 1.00");
}

TEST(ProgressLines, ListTheMostProbableModelsOfMany) {
  std::vector<double> probabilities(20, 0.01);
  std::vector<std::string> names;
  for (int i = 0; i < 20; ++i) names.push_back("model " + std::to_string(i));
  probabilities[17] = 0.81;
  const auto models = models_so_far(probabilities, names);
  ASSERT_EQ(models.size(), kMostSoFar);
  EXPECT_EQ(models[0].name, "model 17");
  EXPECT_EQ(models[0].probability, 0.81);
  EXPECT_EQ(models[1].name, "model 0");
}

}  // namespace
}  // namespace wheeltap::apps
