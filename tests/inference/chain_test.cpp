#include "inference/chains/chain.hpp"
#include "base/constants.hpp"

#include <gmock/gmock.h>

namespace wheeltap::inference {
namespace {

using testing::ElementsAre;

TEST(Chain, DrawIsAViewOfItsModelsParameters) {
  const auto space = ModelSpace::of_components(
      {{"sd", Normal{0.0, 1.0}}},
      {{"damage", "damages", {{"location", Uniform{0.0, 1.0}}, {"reduction", Uniform{0.0, 1.0}}}},
       {"support", "supports", {{"at", Uniform{0.0, 1.0}}}}},
      {{{0, 0}, 1.0}, {{2, 1}, 1.0}});
  Chain chain;
  chain.model = {0, 1};
  chain.theta = {5.0, kNaN, kNaN, kNaN, kNaN, kNaN, 5.5, 0.1, 0.2, 0.3, 0.4, 0.9};
  chain.log_prior = {-1.0, -2.0};
  chain.log_likelihood = {-10.0, -20.0};
  const Draw none = chain.draw(0, space), some = chain.draw(1, space);
  EXPECT_THAT(none.theta, ElementsAre(5.0));
  EXPECT_EQ(none.count(0), 0);
  EXPECT_EQ(none.log_posterior(), -11.0);
  EXPECT_EQ(some.model, 1);
  EXPECT_EQ(some.count(0), 2);
  EXPECT_EQ(some.count(1), 1);
  EXPECT_THAT(some.theta, ElementsAre(5.5, 0.1, 0.2, 0.3, 0.4, 0.9));
  EXPECT_THAT(some.component(0, 0), ElementsAre(0.1, 0.2));
  EXPECT_THAT(some.component(0, 1), ElementsAre(0.3, 0.4));
  EXPECT_THAT(some.component(1, 0), ElementsAre(0.9));
  EXPECT_EQ(some.log_likelihood, -20.0);
}

TEST(Chain, TruncatesToItsFirstDraws) {
  Chain chain;
  chain.model = {0, 1, 1};
  chain.theta = {1.0, kNaN, 2.0, 3.0, 4.0, 5.0};
  chain.log_prior = {-1.0, -2.0, -3.0};
  chain.log_likelihood = chain.log_prior;
  chain.move = {0, 1, 2};
  chain.accepted = {1, 0, 1};
  chain.prediction = {1.F, 2.F, 3.F, 4.F, 5.F, 6.F, 7.F, 8.F, 9.F};
  chain.truncate(2);
  EXPECT_EQ(chain.size(), 2U);
  EXPECT_THAT(chain.model, ElementsAre(0, 1));
  EXPECT_EQ(chain.theta.size(), 4U);
  EXPECT_THAT(chain.log_likelihood, ElementsAre(-1.0, -2.0));
  EXPECT_THAT(chain.move, ElementsAre(0, 1));
  EXPECT_THAT(chain.accepted, ElementsAre(1, 0));
  EXPECT_EQ(chain.prediction.size(), 6U);
  chain.truncate(0);
  EXPECT_EQ(chain.theta.size(), 0U);
  Chain empty;
  empty.truncate(0);
  EXPECT_EQ(empty.size(), 0U);
}

}  // namespace
}  // namespace wheeltap::inference
