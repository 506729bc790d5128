#include "inference/chains/draw_list.hpp"

#include <gmock/gmock.h>

#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "inference/engine/reversible_jump.hpp"
#include "tests/emulator/temporary_directory.hpp"
#include "tests/inference/toy_problems.hpp"

namespace wheeltap::inference {
namespace {

using testing::ElementsAre;

constexpr std::size_t kMany = DrawMemory::kOnHeap / sizeof(double) + 1;

TEST(DrawList, BehavesLikeAVector) {
  DrawList<int> list = {3, 1};
  list.push_back(4);
  const std::vector<int> more = {1, 5};
  list.append(more.begin(), more.end());
  EXPECT_THAT(list, ElementsAre(3, 1, 4, 1, 5));
  list.resize(2);
  list.resize(4, 9);
  EXPECT_THAT(list, ElementsAre(3, 1, 9, 9));
  DrawList<int> copy = list;
  copy[0] = 7;
  EXPECT_EQ(list[0], 3);
  EXPECT_FALSE(copy == list);
  const DrawList<int> taken = std::move(copy);
  EXPECT_THAT(taken, ElementsAre(7, 1, 9, 9));
  list.assign(more.begin(), more.end());
  EXPECT_THAT(list, ElementsAre(1, 5));
  list.clear();
  EXPECT_TRUE(list.empty());
}

// Reads equal values whether or not the pages are in memory.
void expect_counts(const DrawList<double>& list, std::size_t n) {
  for (int times = 0; times < 2; ++times, list.let_go()) {
    ASSERT_EQ(list.size(), n);
    for (std::size_t i = 0; i < n; ++i) ASSERT_EQ(list[i], static_cast<double>(i));
  }
}

TEST(DrawList, UsesAnUnnamedFileIfLong) {
  const test::TemporaryDirectory folder;
  DrawList<double> list;
  list.keep_in(folder / ".");
  std::size_t n = 0;
  const auto fill = [&](std::size_t to) {
    while (n < to) list.push_back(static_cast<double>(n++));
  };
  fill(kMany / 2);
  EXPECT_FALSE(list.in_file());
  fill(3 * kMany);
  EXPECT_TRUE(list.in_file());
  list.let_go();
  fill(10 * kMany);  // grows, with its pages released
  expect_counts(list, n);
  const DrawList<double> copy = list;
  EXPECT_TRUE(copy.in_file());
  list.clear();
  expect_counts(copy, n);
  const DrawList<double> moved = std::exchange(list, {});
  EXPECT_TRUE(moved.in_file());
  EXPECT_EQ(folder.files(), 0);
}

TEST(DrawList, UsesTheHeapIfNoFileIsPossible) {
  DrawList<double> homeless, lost;
  lost.keep_in("/nowhere/at/all");
  for (DrawList<double>* list : {&homeless, &lost}) {
    list->resize(2 * kMany);
    std::iota(list->begin(), list->end(), 0.0);
    list->resize(4 * kMany);
    EXPECT_FALSE(list->in_file());
    list->resize(2 * kMany);
    expect_counts(*list, 2 * kMany);
  }
}

// Storage in a file does not change draws.
TEST(DrawList, StorageDoesNotChangeDraws) {
  const test::TemporaryDirectory folder;
  const Problem problem = toy::bumps();
  Options options{.chains = 1, .warmup = 500, .draws = static_cast<int>(kMany), .thin = 1};
  options.prior_only = true;
  const Posterior held = reversible_jump(problem, options);
  options.draws_folder = folder / ".";
  const Posterior kept = reversible_jump(problem, options);
  EXPECT_FALSE(held.chains[0].log_prior.in_file());
  EXPECT_TRUE(kept.chains[0].log_prior.in_file());
  EXPECT_TRUE(held.chains[0].model == kept.chains[0].model);
  EXPECT_TRUE(held.chains[0].log_prior == kept.chains[0].log_prior);
  EXPECT_TRUE(held.chains[0].move == kept.chains[0].move);
}

}  // namespace
}  // namespace wheeltap::inference
