// Sentences on models that do not explain the data.
#include "apps/text/fit_words.hpp"

#include <gmock/gmock.h>

#include "apps/words.hpp"
#include "base/constants.hpp"

namespace wheeltap::apps {
namespace {

using namespace identification;
using testing::ElementsAre;
using testing::StartsWith;

// Fault: three floors gave three sentences of forty words that differed only in two numbers.
TEST(FitWords, ResponsesOfOneKindShareASentence) {
  const FitVerdict verdict{
      .why = {misfit::NotNoise{"a", 0.12, kNaN, 1, 0.99}, misfit::WorseBeyond{"a", 0.12, 0.28, 100},
              misfit::NotNoise{"b", 0.11, 0.03, 4, -0.5}, misfit::WorseBeyond{"b", 0.11, 0.25, 100},
              misfit::WorseBeyond{"c", 0.1, 0.3, 50}}};
  EXPECT_THAT(
      in_words(verdict),
      ElementsAre(
          "The residual of \"a\" is 12 % of the response (correlation 0.99 at lag 1) and of \"b\" "
          "11 % (correlation -0.50 at lag 4; a chain of masses with free cubic springs leaves a "
          "residual of 3 %), "
          "and not "
          "noise. The credible intervals do not include a model error of this size: add a model "
          "that explains more of the response.",
          "In the 100 samples after the window, the response of every draw differs from \"a\" by "
          "28 % "
          "of the response, against 12 % within the window and \"b\" by 25 % against 11 % within "
          "the "
          "window: the model is valid within the window only.",
          StartsWith("In the 50 samples after the window, the response of every draw differs from "
                     "\"c\"")));
}

TEST(FitWords, TheHeadlineNamesTheFirst) {
  const FitVerdict verdict{.why = {misfit::Unexplained{"a", -0.28}, misfit::Unexplained{"b", 0.2}}};
  EXPECT_EQ(in_brief(verdict), "R² -0.28 for \"a\"");
  EXPECT_THAT(
      in_words(verdict),
      ElementsAre(StartsWith("The model does not explain most of \"a\" (R² -0.28) and \"b\" (R² "
                             "0.20), and the residual is not noise.")));
}

// Fault: a quick run whose chains had missed the damages said that no number of damages explains
// the frequencies.
TEST(FitWords, ChainsThatDisagreeExcludeNoNumberOfDamages) {
  FitVerdict verdict{.why = {misfit::BeyondNoise{.p = 1e-9, .modes = {2}, .emulated = false}}};
  EXPECT_THAT(in_words(verdict), ElementsAre(StartsWith("No number of damages explains")));
  std::get<misfit::BeyondNoise>(verdict.why[0]).chains_agree = false;
  EXPECT_THAT(in_words(verdict),
              ElementsAre(StartsWith("The Markov chains disagree and may have missed damages")));
}

// Fault: "6.1e+02 s".
TEST(Words, DurationsAreReadAsOneWouldSayThem) {
  EXPECT_EQ(duration(0.031), "0.031 s");
  EXPECT_EQ(duration(9.94), "9.9 s");
  EXPECT_EQ(duration(9.96), "10 s");
  EXPECT_EQ(duration(610.0), "10 min");
  EXPECT_EQ(duration(6000.0), "1.7 h");
  EXPECT_EQ(duration(1e7), "116 days");
  EXPECT_EQ(duration(1e13), "1.2e8 days");
}

}  // namespace
}  // namespace wheeltap::apps
