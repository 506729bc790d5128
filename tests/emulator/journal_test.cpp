#include "emulator/journal.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <atomic>
#include <csignal>
#include <cstdlib>

#include "emulator/experiment.hpp"
#include "tests/emulator/temporary_directory.hpp"

namespace wheeltap::emulator::journal_test {
namespace {

using Kind = io::FileError::Kind;
using test::bytes_of;
using test::put_bytes;

Design grid() {
  return full_factorial({{"a", "", {0, 1, 2, 3, 4}}, {"b", "", {0, 0.1, 0.2, 0.3}}});
}

/// Counts its runs in `calls`.
ModelFactory counting(std::atomic<int>& calls) {
  return [&calls] {
    return [&calls](std::span<const double> x, std::span<double> y) {
      ++calls;
      y[0] = x[0] + x[1];
      y[1] = x[0] * x[1];
    };
  };
}

class JournalTest : public testing::Test {
 protected:
  [[nodiscard]] std::optional<Kind> open_error(std::string_view identity,
                                               std::size_t responses) const {
    try {
      const Journal journal(path, identity, responses);
    } catch (const io::FileError& error) {
      return error.kind();
    }
    return std::nullopt;
  }

  test::TemporaryDirectory directory;
  const std::filesystem::path path = directory / "runs.journal";
};

TEST_F(JournalTest, KeepsAppendedRuns) {
  {
    Journal journal(path, "beam", 2);
    EXPECT_TRUE(journal.entries().empty());
    journal.append(4, std::vector{1.5, -2.0});
    journal.append(0, std::vector{0.0, 7.0});
  }
  const Journal again(path, "beam", 2);
  ASSERT_EQ(again.entries().size(), 2u);
  EXPECT_EQ(again.entries()[0].run, 4);
  EXPECT_EQ(again.entries()[0].response, (std::vector{1.5, -2.0}));
  EXPECT_EQ(again.entries()[1].run, 0);
}

// Regression: a run that started anew removed the journal of a running one.
TEST_F(JournalTest, IsWrittenByOneProcessAtATime) {
  Journal first(path, "beam", 2);
  first.append(0, std::vector{1.0, 2.0});
  EXPECT_EQ(open_error("beam", 2), Kind::unwritable);
  EXPECT_THROW(Journal::remove(path), io::FileError);
}

// Regression: the process that created the file overwrote the records of other processes.
TEST_F(JournalTest, SharedJournalsKeepAllRecords) {
  Journal first(path, "beam", 2, Journal::Use::shared);
  Journal second(path, "beam", 2, Journal::Use::shared);
  second.append(1, std::vector{1.0, 2.0});
  first.append(0, std::vector{3.0, 4.0});
  second.append(2, std::vector{5.0, 6.0});
  EXPECT_EQ(Journal(path, "beam", 2, Journal::Use::shared).entries().size(), 3u);
}

TEST_F(JournalTest, RejectsOtherExperimentsAndOtherFiles) {
  { Journal(path, "beam", 2).append(0, std::vector{1.0, 2.0}); }
  EXPECT_EQ(open_error("plate", 2), Kind::mismatch);
  EXPECT_EQ(open_error("beam", 3), Kind::mismatch);
  EXPECT_EQ(open_error("beam", 2), std::nullopt);
  put_bytes(path, "location,reduction\n");
  EXPECT_EQ(open_error("beam", 2), Kind::foreign);
  std::filesystem::remove(path);
  std::filesystem::create_directory(path);
  EXPECT_EQ(open_error("beam", 2), Kind::unwritable);
}

TEST_F(JournalTest, KeepsCompleteRecordsAfterTruncation) {
  std::atomic<int> calls = 0;
  const RowMatrix whole = run_experiment(grid(), 2, counting(calls), {.journal = path});
  ASSERT_EQ(calls, 20);
  const std::string bytes = bytes_of(path);
  const std::size_t header = bytes.find('\n') + 1;
  const std::size_t record = (bytes.size() - header) / 20;
  for (std::size_t cut = 0; cut <= bytes.size(); cut += 5) {
    put_bytes(path, bytes.substr(0, cut));
    calls = 0;
    ASSERT_EQ(whole, run_experiment(grid(), 2, counting(calls), {.journal = path}));
    const int kept = cut < header ? 0 : static_cast<int>((cut - header) / record);
    ASSERT_EQ(calls, 20 - kept) << "cut at byte " << cut;
    ASSERT_EQ(bytes_of(path).size(), bytes.size());
  }
}

TEST_F(JournalTest, RepeatsARunWithADamagedRecord) {
  std::atomic<int> calls = 0;
  const RowMatrix whole = run_experiment(grid(), 2, counting(calls), {.journal = path});
  std::string bytes = bytes_of(path);
  bytes[bytes.size() - 10] = static_cast<char>(bytes[bytes.size() - 10] ^ 1);
  put_bytes(path, bytes);
  calls = 0;
  EXPECT_EQ(whole, run_experiment(grid(), 2, counting(calls), {.journal = path}));
  EXPECT_EQ(calls, 1);
}

TEST_F(JournalTest, ResumesAfterAKillWithoutRepeatingRuns) {
  const pid_t child = ::fork();
  if (child == 0) {
    std::atomic<int> calls = 0;
    (void)run_experiment(grid(), 2, counting(calls),
                         {.journal = path, .progress = [](Eigen::Index done, Eigen::Index) {
                            if (done == 7) ::kill(::getpid(), SIGKILL);
                          }});
    std::_Exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  std::atomic<int> calls = 0;
  Eigen::Index first_done = 0;
  const RowMatrix resumed = run_experiment(
      grid(), 2, counting(calls),
      {.threads = 2, .journal = path, .progress = [&](Eigen::Index done, Eigen::Index) {
         if (first_done == 0) first_done = done;
       }});
  EXPECT_EQ(calls, 13);
  EXPECT_EQ(first_done, 8) << "progress resumes from the stored runs";
  EXPECT_EQ(resumed, run_experiment(grid(), 2, counting(calls)));
}

TEST_F(JournalTest, RejectsAnotherDesignOrIdentity) {
  std::atomic<int> calls = 0;
  (void)run_experiment(grid(), 2, counting(calls), {.journal = path, .identity = "beam"});
  EXPECT_THROW(
      (void)run_experiment(grid(), 2, counting(calls), {.journal = path, .identity = "plate"}),
      io::FileError);
  Design moved = grid();
  moved.points(3, 1) += 1e-9;
  EXPECT_THROW(
      (void)run_experiment(moved, 2, counting(calls), {.journal = path, .identity = "beam"}),
      io::FileError);
  EXPECT_EQ(calls, 20);
}

TEST_F(JournalTest, KeepsFinishedRunsAfterAFailure) {
  const ModelFactory failing = [] {
    return [](std::span<const double> x, std::span<double> y) {
      if (x[0] > 3) throw std::runtime_error("no convergence");
      y[0] = x[0] + x[1];
      y[1] = x[0] * x[1];
    };
  };
  EXPECT_THROW((void)run_experiment(grid(), 2, failing, {.journal = path}), RunError);
  std::atomic<int> calls = 0;
  (void)run_experiment(grid(), 2, counting(calls), {.journal = path});
  EXPECT_EQ(calls, 4);
}

// Regression: `table` without --resume removed any file with the journal's name.
TEST(Journal, RemovesOnlyJournals) {
  const test::TemporaryDirectory directory;
  const auto path = directory / "runs";
  Journal::remove(path);  // there is none
  { Journal(path, "any", 2).append(0, std::vector<double>{1.0, 2.0}); }
  Journal::remove(path);
  EXPECT_FALSE(std::filesystem::exists(path));
  put_bytes(path, "my notes");
  EXPECT_THROW(Journal::remove(path), io::FileError);
  EXPECT_EQ(bytes_of(path), "my notes");
  std::filesystem::remove(path);
  std::filesystem::create_symlink(directory / "elsewhere", path);
  EXPECT_THROW(Journal::remove(path), io::FileError);
  EXPECT_THROW(Journal(path, "any", 2), io::FileError) << "a link is not followed";
  EXPECT_FALSE(std::filesystem::exists(directory / "elsewhere"));
}

}  // namespace
}  // namespace wheeltap::emulator::journal_test
