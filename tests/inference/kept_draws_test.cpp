#include "inference/chains/kept_draws.hpp"

#include <gtest/gtest.h>

namespace wheeltap::inference {
namespace {

TEST(KeptDraws, AreEquallySpacedAndBounded) {
  const ModelSpace space =
      ModelSpace::of_models({{"a", Normal{0.0, 1.0}}}, {{"none", 1.0, {}}, {"one", 1.0, {"a"}}});
  KeptDraws kept(space);
  State state;
  state.model = 1;
  constexpr int kDraws = 50000;
  for (int i = 0; i < kDraws; ++i) {
    state.z = {static_cast<double>(i)};
    kept.add(state, -i);
  }
  const KeptDraws::OfModel& of = kept.of(1);
  EXPECT_EQ(of.visits, kDraws);
  EXPECT_GE(of.size(), 2000U);
  EXPECT_LT(of.size(), 4000U);
  for (std::size_t i = 0; i < of.size(); ++i) {
    EXPECT_EQ(of.row(i)[0], static_cast<double>(of.stride) * static_cast<double>(i));
    EXPECT_EQ(of.log_posterior[i], -of.row(i)[0]);
  }
  EXPECT_EQ(kept.of(0).visits, 0);
}

}  // namespace
}  // namespace wheeltap::inference
