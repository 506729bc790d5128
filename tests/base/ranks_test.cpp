// Loops with several ranks, with a fake implementation: two ranks, of which this process is the
// first and computes the even units; the outcomes of the other come as bytes. Tests under mpirun
// (ctest -L mpi) cover the real distribution.
#include "base/ranks.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <stdexcept>
#include <vector>

#include "base/parallel.hpp"
#include "base/parcel.hpp"

namespace wheeltap::base {
namespace {

class TwoRanks : public Ranks {
 public:
  [[nodiscard]] int rank() const override { return 0; }
  [[nodiscard]] int size() const override { return 2; }
  void share_out(int n, int, const std::function<void(int)>& job,
                 const Carriage& carriage) override {
    ++shared;
    for (int i = 0; i < n; i += 2) job(i);
    for (int i = 1; i < n; i += 2) {
      Packer parcel;
      parcel(10.0 * i);
      carriage.unpack(i, std::move(parcel).bytes());
    }
    agreed = agreed || wishes_to_stop();
  }
  [[nodiscard]] std::string from_first(std::string bytes) override { return bytes; }
  [[nodiscard]] bool all_have(const std::string&) override { return true; }
  [[nodiscard]] bool meet(double) override { return true; }
  [[noreturn]] void abort(int) override { std::abort(); }
  [[nodiscard]] bool stop_agreed() const override { return agreed; }
  [[nodiscard]] bool stop_requested() const override { return told; }
  [[nodiscard]] bool pause_requested() const override { return false; }

  int shared = 0;
  bool agreed = false, told = false;
};

class SeveralRanks : public testing::Test {
 protected:
  SeveralRanks() { base::ranks() = &two; }
  ~SeveralRanks() override { base::ranks() = nullptr; }
  TwoRanks two;
};

TEST_F(SeveralRanks, ShareUnitsWithACarriage) {
  std::vector<double> x(5, -1.0);
  const auto job = [&](int i) { x[static_cast<std::size_t>(i)] = i; };
  parallel_for(5, 2, job,
               carriage([&](int i, auto& parcel) { parcel(x[static_cast<std::size_t>(i)]); }));
  EXPECT_EQ(x, (std::vector<double>{0, 10, 2, 30, 4}));
  parallel_for(5, 2, job);  // without a carriage, every rank computes all units
  EXPECT_EQ(x, (std::vector<double>{0, 1, 2, 3, 4}));
  EXPECT_EQ(two.shared, 1);
}

TEST_F(SeveralRanks, KeepALoopWithinAUnitOnItsRank) {
  const Carriage none{.pack = [](int) { return std::string(); },
                      .unpack = [](int, std::string_view) {}};
  std::atomic<int> calls = 0;
  const auto inner = [&] {
    parallel_for(
        3, 2, [&](int) { ++calls; }, none);
  };
  parallel_for(
      2, 1, [&](int) { inner(); }, none);  // this rank computes the even unit
  EXPECT_EQ(calls, 3);
  parallel_for(2, 1, [&](int) { inner(); });
  EXPECT_EQ(calls, 9);
  EXPECT_EQ(two.shared, 1);
  inner();
  EXPECT_EQ(two.shared, 2);
}

// Ranks that receive signals at different times must leave their loops at the same iteration.
TEST_F(SeveralRanks, StopOutsideOfUnitsOnlyByCommonDecision) {
  EXPECT_FALSE(is_to_stop(true));
  const Carriage none{.pack = [](int) { return std::string(); },
                      .unpack = [](int, std::string_view) {}};
  bool mine = false, theirs = false, local = true;
  parallel_for(
      1, 1,
      [&](int) {
        mine = is_to_stop(true);
        two.told = true;
        parallel_for(1, 1, [&](int) { theirs = is_to_stop(false); });
      },
      none);
  EXPECT_TRUE(mine);
  EXPECT_TRUE(theirs);
  parallel_for(1, 1, [&](int) { local = is_to_stop(true); });  // all ranks compute this one
  EXPECT_FALSE(local);
  EXPECT_FALSE(is_to_stop(true));
  two.on_wish_to_stop([] { return true; });
  parallel_for(
      1, 1, [](int) {}, none);
  EXPECT_TRUE(is_to_stop(false));
}

TEST_F(SeveralRanks, UnmarkAThreadAfterAUnitThatThrows) {
  const Carriage none{.pack = [](int) { return std::string(); },
                      .unpack = [](int, std::string_view) {}};
  EXPECT_THROW(parallel_for(
                   1, 1, [](int) { throw std::runtime_error("no"); }, none),
               std::runtime_error);
  EXPECT_FALSE(within().job);
  EXPECT_FALSE(within().shared);
}

}  // namespace
}  // namespace wheeltap::base
