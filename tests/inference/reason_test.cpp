#include "inference/diagnosis/reason.hpp"

#include <gmock/gmock.h>

#include <set>
#include <string>
#include <vector>

#include "inference/model/model_space.hpp"

namespace wheeltap::inference {
namespace {

// Each reason about a model is a sentence that names the model. The caller adds the advice; its
// test checks the words (tests/apps/verdict_words_test.cpp).
TEST(Reason, IsDescribedInASentence) {
  const auto space =
      ModelSpace::of_models({{"a", Normal{0.0, 1.0}}}, {{"one", 1.0, {}}, {"two", 1.0, {"a"}}});
  const std::vector<Reason> of_a_model{
      ModelNotEntered{.model = 1, .by_evidence = {.value = 0.25}},
      ModelNotInEveryChain{.model = 1, .visited = 3, .chains = 4},
      ModelUnknown{.model = 1},
      ModeNotInEveryChain{.model = 1, .share = 0.3, .visited = 3, .chains = 4},
      ModeSharesDisagree{.model = 1, .rhat = 1.2, .limit = 1.05},
      AnnealingFindsMore{.model = 1, .annealed = {.value = -3.0}, .drawn = {.value = -5.0}},
      EvidenceDisagrees{.model = 1, .by_draws = {.value = 0.1}, .by_evidence = {.value = 0.2}},
      EvidenceUnreliable{.model = 1, .pareto = 0.9, .limit = 0.7, .factor = 3.0},
      ModesLeftOut{.model = 1, .modes = 12, .share = 0.1},
      ParameterMovesSlowly{.model = 1, .parameter = "a", .ess = 12.0, .limit = 200.0, .tail = true},
      ParameterDisagrees{.model = 1, .parameter = "a", .rhat = 1.2, .limit = 1.01},
      ParameterMovesSlowly{.model = 1, .parameter = "a", .ess = 12.0, .limit = 400.0}};
  std::set<std::string> phrases;
  for (const Reason& reason : of_a_model) {
    const std::string phrase = describe(reason, space);
    EXPECT_THAT(phrase, testing::HasSubstr("odel 'two'"));
    EXPECT_THAT(phrase, testing::EndsWith("."));
    phrases.insert(phrase);
  }
  EXPECT_EQ(phrases.size(), of_a_model.size());
  EXPECT_EQ(
      describe(ChainsDisagree{.quantity = "log posterior", .rhat = 1.02, .limit = 1.01}, space),
      "R-hat of log posterior is 1.02 (must be below 1.01)");
  EXPECT_EQ(describe(TooFewEffectiveDraws{.quantity = "count", .ess = 12.5, .limit = 400.0}, space),
            "the effective sample size of the count is 12.5 (must exceed 400)");
  EXPECT_EQ(describe(StoppedEarly{}, space), "The run stopped early.");
}

}  // namespace
}  // namespace wheeltap::inference
