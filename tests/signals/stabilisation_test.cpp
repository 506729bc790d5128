#include "signals/modal/stabilisation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "random_vibration.hpp"

namespace wheeltap::signals {
namespace {

StochasticSubspace subspace_of(const VibratingStructure& structure, long samples, double noise) {
  const OutputCovariances c =
      output_covariances(structure.accelerations(samples, noise, 5), {.lags = 24, .blocks = 50});
  return StochasticSubspace(c, {.step = structure.step, .largest_order = 30});
}

TEST(Stabilisation, KeepsOnlyTheModes) {
  const VibratingStructure structure = chain(3, 1.0, 200.0);
  const StochasticSubspace subspace = subspace_of(structure, 18000, 0.05);
  const Stabilisation found = stabilise(subspace, {.lowest_hz = 0.3});
  const Eigen::VectorXd truth = structure.modes().frequencies_hz;
  ASSERT_EQ(found.modes.size(), 3U);
  for (std::size_t m = 0; m < 3; ++m) {
    const ModeCluster& cluster = found.modes[m];
    const Pole& pole = found.poles[static_cast<std::size_t>(cluster.chosen)];
    EXPECT_NEAR(pole.frequency_hz, truth[static_cast<Eigen::Index>(m)], 5.0 * pole.frequency_sd);
    EXPECT_GT(cluster.share(), 0.8);
    // One pole per order, and no pole in two modes.
    std::set<int> orders;
    for (const int i : cluster.members) {
      EXPECT_TRUE(found.hard[static_cast<std::size_t>(i)]);
      EXPECT_TRUE(orders.insert(found.poles[static_cast<std::size_t>(i)].order).second);
    }
    EXPECT_TRUE(std::ranges::count(cluster.members, cluster.chosen));
  }
  EXPECT_EQ(found.orders, 15);
}

// Pure noise has no modes.
TEST(Stabilisation, FindsNothingInNoise) {
  base::Random random(8, 0, 0, base::Purpose::test);
  Eigen::MatrixXd y(3, 18000);
  for (double& x : y.reshaped()) x = random.normal();
  const OutputCovariances c = output_covariances(y, {.lags = 24, .blocks = 50});
  const Stabilisation found = stabilise(StochasticSubspace(c, {.step = 0.05}), {});
  EXPECT_TRUE(found.modes.empty());
}

TEST(Stabilisation, SplitsIntoTwoClasses) {
  EXPECT_EQ(two_classes({0.0, 0.1, 0.2, 5.0, 5.1}), 3U);
  EXPECT_EQ(two_classes({0.0, 7.0}), 1U);
  EXPECT_EQ(two_classes({-9.0, 0.0, 0.1, 0.3}), 1U);
}

Pole pole_of(int order, double f, double bend, double frequency_sd = 1e-3) {
  Pole out;
  out.order = order;
  out.frequency_hz = f;
  out.damping = 0.01;
  out.frequency_sd = frequency_sd * f;
  out.damping_sd = 1e-3;
  out.shape = Eigen::Vector2cd(1.0, bend);
  return out;
}

const Pole& only_mode(const Stabilisation& found) {
  EXPECT_EQ(found.modes.size(), 1U);
  return found.poles.at(static_cast<std::size_t>(found.modes.at(0).chosen));
}

// A mode outside the band is not resolved below order 20. Until then it distorts the shape of the
// mode inside, whose pole is as certain there as later.
TEST(Stabilisation, SelectsOrdersThatResolveNeighbouringModes) {
  std::vector<std::vector<Pole>> by_order;
  for (int order = 2; order <= 40; order += 2) {
    const double moves = 1.0 + 1e-5 * order;
    by_order.push_back({pole_of(order, moves, order < 20 ? 0.55 : 0.5)});
    if (order >= 20) by_order.back().push_back(pole_of(order, 3.0 * moves, -2.0));
  }
  const Stabilisation found = stabilise(std::move(by_order), {.lowest_hz = 0.5, .highest_hz = 2.0});
  const Pole& chosen = only_mode(found);
  EXPECT_EQ(found.modes[0].members.size(), 20U);
  EXPECT_GE(chosen.order, 20);
  EXPECT_EQ(chosen.shape[1].real(), 0.5);
  for (const Pole& p : found.poles) EXPECT_LT(p.frequency_hz, 2.0);
}

// The mode that distorts it below order 8 is not in the diagram, and poles are equally certain up
// to order 30. Frequencies decrease, so the median of all these would be that of a distorted pole.
TEST(Stabilisation, SkipsLowerOrdersThatAreNoMoreCertain) {
  std::vector<std::vector<Pole>> by_order;
  for (int order = 2; order <= 40; order += 2) {
    const double moves = 1.0 + 1e-5 * std::abs(order - 16);
    by_order.push_back({pole_of(order, moves, order < 8 ? 0.55 : 0.5, order > 30 ? 4e-3 : 1e-3)});
  }
  const Stabilisation found = stabilise(std::move(by_order), {});
  const Pole& chosen = only_mode(found);
  EXPECT_GT(chosen.order, 14);
  EXPECT_LE(chosen.order, 30);
}

// One order that is far better than all others represents the mode, not the best of the others.
// This also holds if a cluster that begins late would leave only worse ones.
TEST(Stabilisation, SelectsASingleGoodOrder) {
  for (const bool with_late : {false, true}) {
    std::vector<std::vector<Pole>> by_order;
    for (int order = 2; order <= 40; order += 2) {
      const double moves = 1.0 + 1e-5 * order;
      by_order.push_back({pole_of(order, moves, 0.5, order == 6 ? 1e-3 : 2e-2)});
      if (with_late && order >= 34) by_order.back().push_back(pole_of(order, 3.0 * moves, -2.0));
    }
    EXPECT_EQ(only_mode(stabilise(std::move(by_order), {.highest_hz = 2.0})).order, 6);
  }
}

// A well damped mode whose pole moves at order 22, by less than its uncertainty but more than
// between neighbouring orders, is one mode.
TEST(Stabilisation, JoinsClustersThatExplainOnePeak) {
  std::vector<std::vector<Pole>> by_order;
  for (int order = 10; order <= 50; order += 2) {
    const bool late = order >= 22;
    Pole p = pole_of(order, (late ? 0.1830 : 0.1840) + 1e-6 * order, late ? 0.502 : 0.5, 9e-3);
    p.damping = late ? 0.0476 : 0.0488;
    p.damping_sd = 0.008;
    by_order.push_back({p});
  }
  const Stabilisation found = stabilise(std::move(by_order), {.smallest_order = 10});
  const Pole& chosen = only_mode(found);
  EXPECT_NEAR(chosen.frequency_hz, 0.1835, 0.001);
  EXPECT_EQ(found.modes[0].members.size(), 21U);
  EXPECT_EQ(found.modes[0].orders, 21);
}

// Two modes at this distance remain separate if their shapes differ, or if their uncertainties are
// smaller than the distance.
TEST(Stabilisation, KeepsCloseModesApart) {
  for (const bool by_shape : {true, false}) {
    std::vector<std::vector<Pole>> by_order;
    for (int order = 4; order <= 40; order += 2) {
      const double sd = by_shape ? 9e-3 : 5e-4;
      by_order.push_back({pole_of(order, 1.000, 0.5, sd),
                          pole_of(order, by_shape ? 1.004 : 1.010, by_shape ? -2.0 : 0.5, sd)});
    }
    EXPECT_EQ(stabilise(std::move(by_order), {.smallest_order = 4}).modes.size(), 2U) << by_shape;
  }
}

// A square frame sways in two directions at nearly equal frequencies.
TEST(Stabilisation, KeepsTheTwoModesOfASquareFrame) {
  VibratingStructure square = chain(2, 1.0, 200.0);
  square.stiffness << 200.0, 0.0, 0.0, 200.0 * 1.01 * 1.01;
  const OutputCovariances c =
      output_covariances(square.accelerations(18000, 0.05, 5), {.lags = 24, .blocks = 50});
  const Stabilisation found = stabilise(
      StochasticSubspace(c, {.step = square.step, .largest_order = 20}), {.lowest_hz = 0.3});
  ASSERT_EQ(found.modes.size(), 2U);
  const auto shape = [&](std::size_t m) {
    return found.poles[static_cast<std::size_t>(found.modes[m].chosen)].shape;
  };
  EXPECT_LT(modal_assurance(shape(0), shape(1)), 0.5);
}

}  // namespace
}  // namespace wheeltap::signals
