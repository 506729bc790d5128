#include "identification/sid/sid_residuals.hpp"

#include <gmock/gmock.h>

#include "sid_cases.hpp"

namespace wheeltap::identification {
namespace {

// What the linear model cannot explain is smooth; what the true one leaves is the noise.
TEST(SidResiduals, OrdersAreChosenModelByModel) {
  SidCase c = simulated(small_sid_case());
  for (SidModel& model : c.models) model.chooses_order = true;
  choose_orders(c, 1, 2);
  const int order = c.models[0].order();
  EXPECT_GE(order, 1);
  EXPECT_LE(order, kMostAutoregressive);
  EXPECT_EQ(c.models[1].order(), 0);
  EXPECT_EQ(c.models[1].parameters, (std::vector<int>{0, 1}));
  EXPECT_EQ(c.models[0].parameters.size(), 1U + static_cast<std::size_t>(order));
  EXPECT_EQ(c.parameters[2].name, "ar[1]");
}

TEST(SidResiduals, AnOrderThatWasGivenStays) {
  SidCase c = simulated(small_sid_case());
  add_autoregression(c, c.models[0], 2);
  c.unite();
  const std::vector<int> before = c.models[0].parameters;
  choose_orders(c, 1, 1);
  EXPECT_EQ(c.models[0].parameters, before);
  EXPECT_EQ(before.size(), 3U);
}

}  // namespace
}  // namespace wheeltap::identification
