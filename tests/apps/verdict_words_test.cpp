#include "apps/text/verdict_words.hpp"

#include <gmock/gmock.h>

#include <string>
#include <vector>

namespace wheeltap::apps {
namespace {

using namespace inference;
using testing::ElementsAre;

const ModelSpace& space() {
  static const auto made =
      ModelSpace::of_models({{"a", Normal{0.0, 1.0}}}, {{"one", 1.0, {"a"}}, {"two", 1.0, {"a"}}});
  return made;
}

std::string sentence(const Reason& reason) {
  const std::vector<std::string> said = in_words({reason}, space());
  EXPECT_EQ(said.size(), 1U);
  return said.empty() ? std::string() : said[0];
}

// The sentence of each reason, with the remedy.
TEST(VerdictWords, OfEachReason) {
  EXPECT_EQ(sentence(ModelNotEntered{
                .model = 1, .proposed = 2469134, .by_evidence = {.value = 0.25, .mcse = 0.019}}),
            "Model 'two' has no draws after 2 469 134 proposals; its evidence implies "
            "P ≈ 0.25 ± 0.02. Use more searches for posterior modes (--search) or longer chains "
            "(--warmup, --draws).");
  EXPECT_EQ(sentence(ModelNotEntered{.model = 1, .proposed = 0, .by_evidence = {.value = 0.25}}),
            "Model 'two' has no draws; its evidence implies P ≈ 0.25. Use more searches for "
            "posterior modes "
            "(--search) or longer chains (--warmup, --draws).");
  EXPECT_EQ(sentence(ModelNotInEveryChain{.model = 0, .visited = 3, .chains = 4}),
            "Only 3 of 4 chains have draws of model 'one'. Run longer (--warmup, --draws).");
  EXPECT_EQ(
      sentence(ModelNotInEveryChain{
          .model = 0, .visited = 3, .chains = 4, .by_evidence = {.value = 0.1, .mcse = 0.01}}),
      "Only 3 of 4 chains have draws of model 'one'; its evidence implies P ≈ 0.1 ± 0.01. "
      "Run longer (--warmup, --draws).");
  EXPECT_EQ(sentence(ModelUnknown{.model = 1, .proposed = 12}),
            "Model 'two' has no draws after 12 proposals; its evidence is not known. Run "
            "longer (--warmup, --draws).");
  EXPECT_EQ(
      sentence(ModeNotInEveryChain{.model = 0, .share = 0.3, .visited = 3, .chains = 4}),
      "Only 3 of 4 chains have draws near a posterior mode of model 'one' that the searches found "
      "(about 30 % of that model's probability). Run longer (--warmup, --draws).");
  EXPECT_EQ(
      sentence(ModeNotInEveryChain{.model = 0, .share = 0.3, .visited = 0, .chains = 4}),
      "No chain has draws near a posterior mode of model 'one' that the searches found (about 30 % "
      "of that model's probability). Run longer (--warmup, --draws).");
  EXPECT_EQ(sentence(ModeSharesDisagree{
                .model = 0, .lowest = 0.1, .highest = 0.7, .rhat = 1.3456, .limit = 1.05}),
            "The chains disagree about a posterior mode of model 'one': the fraction of the "
            "model's draws near this mode is 10 % to 70 % (R-hat 1.35). Run longer (--warmup, "
            "--draws).");
  EXPECT_EQ(sentence(EvidenceUnreliable{.model = 1,
                                        .pareto = 0.93,
                                        .limit = 0.7,
                                        .by_evidence = {.value = 0.001, .mcse = 0.0001},
                                        .factor = 21.2}),
            "The evidence of model 'two' is uncertain: the tail of its importance weights is too "
            "heavy (Pareto k 0.93, must be at most 0.7), so that the estimate may be too small "
            "by a factor of 21; its evidence implies P ≈ 0.001 ± 0.0001. Use more searches for "
            "posterior modes "
            "(--search) "
            "or longer chains (--warmup, --draws).");
  EXPECT_EQ(sentence(ModesLeftOut{.model = 0, .modes = 12, .share = 0.05}),
            "The search for posterior modes of model 'one' found 12 modes more than it can keep "
            "(about 5 % of that model's probability). Run longer (--warmup, --draws).");
  EXPECT_EQ(
      sentence(AnnealingFindsMore{.model = 0,
                                  .annealed = {.value = -47.5, .mcse = 0.1},
                                  .drawn = {.value = -50.51, .mcse = 0.01}}),
      "SMC finds more evidence for model 'one' (ln Z = -47.50 ± 0.10) than its draws "
      "(-50.51 ± 0.01): the draws may lack a posterior mode. Use more searches for posterior modes "
      "(--search) or longer chains (--warmup, --draws).");
  EXPECT_EQ(sentence(EvidenceDisagrees{.model = 1,
                                       .by_draws = {.value = 0.3, .mcse = 0.004},
                                       .by_evidence = {.value = 0.42, .mcse = 0.003}}),
            "Model 'two' has P = 0.3 ± 0.004 by its draws, but its evidence implies 0.42 ± 0.003. "
            "Run longer (--warmup, --draws).");
  EXPECT_EQ(sentence(DrawsBeyondMixture{.model = 0, .share = 0.07, .visits = 27.3, .limit = 100.0}),
            "7 % of the draws of model 'one' lie outside the support of the global proposals, in "
            "only 27 effectively independent visits (must exceed 100): the chains may have missed "
            "a part of this region. "
            "Run longer (--warmup, --draws).");
  EXPECT_EQ(sentence(AnnealingDrawsBeyond{.model = 0, .annealed = 0.061, .drawn = 0.003}),
            "6.1 % of the SMC draws of model 'one' lie in a region with only 0.3 % of the chain "
            "draws, and chains that start there do not leave it: the draws lack a part of the "
            "posterior. Run "
            "longer (--warmup, --draws).");
  EXPECT_EQ(
      sentence(ParameterDisagrees{.model = 1, .parameter = "a", .rhat = 1.23456, .limit = 1.01}),
      "Within model 'two' the chains disagree about a (R-hat 1.235). Run longer (--warmup, "
      "--draws).");
  EXPECT_EQ(
      sentence(ParameterMovesSlowly{.model = 1, .parameter = "a", .ess = 123.4, .limit = 400.0}),
      "Within model 'two' the effective sample size of a is 123 (must exceed 400). Run longer "
      "(--warmup, --draws).");
  EXPECT_EQ(sentence(TooFewRoundTrips{.completed = 3, .limit = 10}),
            "The tempered replicas completed only 3 round trips between prior and posterior (10 "
            "are needed). Run longer (--warmup, --draws).");
  EXPECT_EQ(sentence(StoppedEarly{}), "The run stopped early. Let the run continue to its end.");
  EXPECT_EQ(sentence(QuickLook{}),
            "This is a quick run: posterior modes, their Laplace evidence and short chains, not a "
            "posterior. Run without --quick.");
}

TEST(VerdictWords, ChainsThatHaveNotConvergedAreOneSentence) {
  EXPECT_THAT(
      in_words({ChainsDisagree{.quantity = "log posterior", .rhat = 1.02345, .limit = 1.01},
                TooFewEffectiveDraws{.quantity = "log posterior", .ess = 211.6, .limit = 400.0},
                TooFewEffectiveDraws{.quantity = "count", .ess = 12.34, .limit = 400.0}},
               space()),
      ElementsAre("The chains have not converged: R-hat of log posterior is 1.023 (must be below "
                  "1.01), the effective sample size of the log posterior is 212 (must exceed 400), "
                  "the effective sample size of the count is 12.3 (must exceed 400). Do not trust "
                  "these numbers yet. Run longer (--warmup, --draws)."));
}

TEST(VerdictWords, OfManyModelsAlikeFourAreNamedAndTheRestCounted) {
  std::vector<Reason> reasons(19, ModelUnknown{.model = 0, .proposed = 0});
  auto said = in_words(reasons, space());
  ASSERT_EQ(said.size(), 5U);
  EXPECT_EQ(said[4], "The same holds for 15 more models.");
  reasons.assign(6, ParameterMovesSlowly{.model = 1, .parameter = "a", .ess = 1.0, .limit = 2.0});
  said = in_words(reasons, space());
  ASSERT_EQ(said.size(), 5U);
  EXPECT_EQ(said[4], "The same holds for parameters of 2 more models.");
}

}  // namespace
}  // namespace wheeltap::apps
