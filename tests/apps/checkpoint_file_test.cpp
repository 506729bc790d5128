// Parts of draws in separate checkpoint files: written once, needed to resume, removed at the end.
#include "apps/runs/checkpoint_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "inference/engine/reversible_jump.hpp"
#include "io/file_error.hpp"
#include "tests/emulator/temporary_directory.hpp"
#include "tests/inference/toy_problems.hpp"

namespace wheeltap::apps {
namespace {

namespace fs = std::filesystem;
using inference::Posterior;
using io::FileError;
using testing::ElementsAre;
using testing::IsEmpty;

class CheckpointParts : public testing::Test {
 protected:
  static constexpr int kPart = 10;

  [[nodiscard]] CheckpointFile file(bool resume) const {
    CommonOptions common;
    common.resume = resume;
    return {directory_ / "",
            {.command = "damage", .options = {}, .case_json = {}, .inputs = {}},
            common};
  }
  // Runs until shortly after this number of saved parts; 0: to the end.
  [[nodiscard]] Posterior run(CheckpointFile& file, int saved = 0) const {
    inference::Options options{
        .seed = 3, .chains = 2, .threads = 1, .warmup = 40, .draws = 45, .thin = 1, .searches = 2};
    file.attach(options);
    options.checkpoints.part = kPart;
    options.checkpoints.every_seconds = 0.0;  // at every safe point
    struct Enough {};
    int seen = 0, drawing = 0;
    const auto save = options.checkpoints.save;
    options.checkpoints.save = [&](const inference::Checkpoint& checkpoint) {
      const long parts = inference::parts_of(checkpoint).second;
      if (parts > 0 && drawing++ % 4 == 0) save(checkpoint);
      if (saved > 0 && parts >= saved && ++seen > 5) throw Enough();  // like a kill
    };
    try {
      return inference::reversible_jump(inference::toy::bumps(), options);
    } catch (const Enough&) {
      return {};
    }
  }
  [[nodiscard]] std::set<std::string> names() const {
    std::set<std::string> all;
    for (const auto& entry : fs::directory_iterator(directory_ / ""))
      all.insert(entry.path().filename().string());
    return all;
  }
  // The names of `n` parts and their checkpoint.
  [[nodiscard]] static std::set<std::string> files(int first, int n) {
    std::set<std::string> all{"checkpoint.nc"};
    for (int i = first; i < first + n; ++i) all.insert("checkpoint-" + std::to_string(i) + ".nc");
    return all;
  }
  void write(const std::string& name, const std::string& bytes) const {
    test::put_bytes(directory_ / name, bytes);
  }
  static void expect_same(const Posterior& a, const Posterior& b) {
    ASSERT_EQ(a.chains.size(), b.chains.size());
    for (std::size_t c = 0; c < a.chains.size(); ++c) {
      EXPECT_EQ(a.chains[c].model, b.chains[c].model);
      EXPECT_EQ(a.chains[c].log_likelihood, b.chains[c].log_likelihood);
      EXPECT_EQ(a.chains[c].prediction, b.chains[c].prediction);
    }
  }

  test::TemporaryDirectory directory_;
};

TEST_F(CheckpointParts, ARunGoesOnFromThemAndLeavesNone) {
  CheckpointFile one = file(false);
  const Posterior straight = run(one);
  EXPECT_EQ(names(), files(0, 8));
  one.remove();
  EXPECT_THAT(names(), IsEmpty());

  CheckpointFile killed = file(false);
  static_cast<void>(run(killed, 2));
  EXPECT_EQ(names(), files(0, 2));
  // Simulates a kill between a part and its checkpoint, and an earlier one during its write.
  fs::copy(directory_ / "checkpoint-1.nc", directory_ / "checkpoint-2.nc");
  write("checkpoint-2.nc.part0123456789abcdef", "half of it");
  CheckpointFile again = file(true);
  expect_same(straight, run(again));
  again.remove();
  EXPECT_THAT(names(), IsEmpty());
}

TEST_F(CheckpointParts, ARepeatedRunKeepsThoseOfTheOneBeforeUntilItHasItsOwn) {
  CheckpointFile one = file(false);
  const Posterior straight = run(one);
  one.repeat({});
  expect_same(straight, run(one));
  EXPECT_EQ(names(), files(8, 8));
  CheckpointFile again = file(true);
  expect_same(straight, run(again));
}

TEST_F(CheckpointParts, ThoseOfAnEarlierRunAreCleared) {
  CheckpointFile one = file(false);
  static_cast<void>(run(one));
  static_cast<void>(file(false));
  EXPECT_THAT(names(), IsEmpty());
  write("checkpoint-7.nc", "my notes");
  write("checkpoint-mine.nc", "more of them");
  EXPECT_THROW(static_cast<void>(file(false)), FileError);
  EXPECT_THAT(names(), ElementsAre("checkpoint-7.nc", "checkpoint-mine.nc"));
}

TEST_F(CheckpointParts, AFileOfAnothersStaysAndTheRunGoesOn) {
  CheckpointFile killed = file(false);
  const Posterior straight = run(killed);
  static_cast<void>(file(false));
  CheckpointFile one = file(false);
  write("checkpoint-0.nc", "my notes");
  expect_same(straight, run(one));
  one.remove();
  EXPECT_THAT(names(), ElementsAre("checkpoint-0.nc"));
  EXPECT_EQ(test::bytes_of(directory_ / "checkpoint-0.nc"), "my notes");
}

TEST_F(CheckpointParts, WithoutThemOrWithOthersARunIsRefused) {
  CheckpointFile killed = file(false);
  static_cast<void>(run(killed, 2));
  const fs::path part = directory_ / "checkpoint-1.nc";
  const std::string whole = test::bytes_of(part);
  const auto refused = [&](const std::string& how) {
    CheckpointFile again = file(true);
    try {
      static_cast<void>(run(again));
      ADD_FAILURE() << how;
    } catch (const FileError& error) {
      EXPECT_EQ(error.kind(), FileError::Kind::corrupt);
      EXPECT_THAT(error.what(),
                  testing::AllOf(testing::HasSubstr("checkpoint-1.nc"), testing::HasSubstr(how)));
    }
  };
  for (const std::size_t n : {std::size_t{0}, std::size_t{7}, whole.size() / 2, whole.size() - 1}) {
    write("checkpoint-1.nc", whole.substr(0, n));
    refused("truncated or corrupt");
  }
  std::string changed = whole;
  changed[whole.size() / 2] = static_cast<char>(changed[whole.size() / 2] ^ 1);
  write("checkpoint-1.nc", changed);
  refused("truncated or corrupt");
  write("checkpoint-1.nc", test::bytes_of(directory_ / "checkpoint-0.nc"));
  refused("of another checkpoint");
  fs::remove(part);
  refused("does not exist");
}

}  // namespace
}  // namespace wheeltap::apps
