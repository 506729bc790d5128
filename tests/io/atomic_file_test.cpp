#include "io/atomic_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <set>

#include "tests/emulator/temporary_directory.hpp"

namespace wheeltap::io {
namespace {

namespace fs = std::filesystem;

std::string refusal(const fs::path& path) {
  try {
    AtomicFile file(path);
    file.commit();
  } catch (const FileError& error) {
    EXPECT_EQ(error.kind(), FileError::Kind::unwritable);
    EXPECT_EQ(error.path(), path);
    return error.reason();
  }
  return "nothing thrown";
}

TEST(AtomicFile, ReplacesTheFileOnlyAtCommit) {
  const test::TemporaryDirectory directory;
  const auto path = directory / "a.txt";
  test::put_bytes(path, "old");
  {
    AtomicFile file(path);
    file.write("lost");
  }
  EXPECT_EQ(test::bytes_of(path), "old");
  AtomicFile file(path);
  file.write("new");
  EXPECT_EQ(test::bytes_of(path), "old");
  file.commit();
  EXPECT_EQ(test::bytes_of(path), "new");
  EXPECT_EQ(directory.files(), 1) << "no temporary file stays behind";
}

TEST(AtomicFile, TemporaryNamesAreUnique) {
  const test::TemporaryDirectory directory;
  std::set<fs::path> names;
  for (int i = 0; i < 100; ++i) names.insert(AtomicFile(directory / "a").temporary());
  EXPECT_EQ(names.size(), 100U);
  for (const fs::path& name : names) EXPECT_EQ(name.parent_path(), (directory / "a").parent_path());
}

// An attacker could create a predictable name first, as a link to another file.
TEST(AtomicFile, NeverFollowsALinkWithTheTemporaryName) {
  const test::TemporaryDirectory directory;
  test::put_bytes(directory / "precious", "kept");
  // Former names: the process and a counter.
  for (int i = 0; i < 1000; ++i)
    fs::create_symlink(directory / "precious", directory / ("a.part" + std::to_string(::getpid()) +
                                                            "-" + std::to_string(i)));
  AtomicFile file(directory / "a");
  file.write("new");
  file.commit();
  EXPECT_EQ(test::bytes_of(directory / "precious"), "kept");
}

TEST(AtomicFile, NeverReplacesAPipeADeviceOrAFolder) {
  const test::TemporaryDirectory directory;
  const auto pipe = directory / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_NE(refusal(pipe).find("pipe or a device"), std::string::npos);
  EXPECT_TRUE(fs::is_fifo(pipe));
  fs::create_directory(directory / "folder");
  EXPECT_EQ(refusal(directory / "folder"), "is a directory");
  EXPECT_EQ(directory.files(), 2);
}

TEST(AtomicFile, OverwritesReservedSpaceAndReleasesTheRest) {
  const test::TemporaryDirectory directory;
  AtomicFile file(directory / "a", 1 << 20);
  EXPECT_EQ(fs::file_size(file.temporary()), 1U << 20);
  file.write("a longer text");
  file.write("short");
  file.commit();
  EXPECT_EQ(test::bytes_of(directory / "a"), "short");
}

TEST(AtomicFile, AppendsToItsContent) {
  const test::TemporaryDirectory directory;
  AtomicFile file(directory / "a", 100);
  file.write("one longer than the next");
  file.write("one");
  file.append(", two");
  file.append("");
  file.append(", three");
  file.commit();
  EXPECT_EQ(test::bytes_of(directory / "a"), "one, two, three");
}

TEST(AtomicFile, RemovesTemporaryFilesOfKilledProcesses) {
  const test::TemporaryDirectory directory;
  test::put_bytes(directory / "a.part0123456789abcdef", "of a killed process");
  test::put_bytes(directory / "a.part", "not ours");
  test::put_bytes(directory / "a.part0123456789ABCDEF", "not ours");
  test::put_bytes(directory / "b.part0123456789abcdef", "another file's");
  fs::create_symlink(directory / "a.part", directory / "a.partffffffffffffffff");
  const AtomicFile living(directory / "a");
  const AtomicFile other(directory / "a");
  EXPECT_TRUE(fs::exists(living.temporary())) << "somebody is writing it";
  EXPECT_FALSE(fs::exists(directory / "a.part0123456789abcdef"));
  EXPECT_TRUE(fs::exists(directory / "a.part0123456789ABCDEF"));
  EXPECT_TRUE(fs::exists(directory / "b.part0123456789abcdef"));
  EXPECT_TRUE(fs::is_symlink(directory / "a.partffffffffffffffff"));
}

class CommitTogether : public testing::Test {
 protected:
  void commit() const {
    AtomicFile a(directory / "a"), b(directory / "b");
    a.write("new a");
    b.write("new b");
    AtomicFile* files[] = {&a, &b};
    commit_together(files);
  }
  test::TemporaryDirectory directory;
};

TEST_F(CommitTogether, RenamesAllFiles) {
  test::put_bytes(directory / "a", "old a");
  commit();
  EXPECT_EQ(test::bytes_of(directory / "a"), "new a");
  EXPECT_EQ(test::bytes_of(directory / "b"), "new b");
  EXPECT_EQ(directory.files(), 2) << "nothing else stays behind";
}

TEST_F(CommitTogether, RestoresAllFilesIfOneRenameFails) {
  test::put_bytes(directory / "a", "old a");
  AtomicFile a(directory / "a"), b(directory / "b"), c(directory / "c");
  a.write("new a");
  b.write("new b");
  fs::create_directory(directory / "c");
  AtomicFile* files[] = {&a, &b, &c};
  EXPECT_THROW(commit_together(files), FileError);
  EXPECT_EQ(test::bytes_of(directory / "a"), "old a");
  EXPECT_FALSE(fs::exists(directory / "b"));
  EXPECT_FALSE(fs::exists(directory / kCommitNote));
}

// The state after a process was killed between the first and the second rename.
TEST_F(CommitTogether, FinishesAnInterruptedCommit) {
  test::put_bytes(directory / "a", "new a");
  test::put_bytes(directory / "b", "old b");
  test::put_bytes(directory / "b.part0123456789abcdef", "new b");
  test::put_bytes(directory / kCommitNote,
                  "wheeltap-commit 1\na.partfedcba9876543210\na\nb.part0123456789abcdef\nb\n");
  finish_commit(directory / "");
  EXPECT_EQ(test::bytes_of(directory / "a"), "new a");
  EXPECT_EQ(test::bytes_of(directory / "b"), "new b");
  EXPECT_EQ(directory.files(), 2);
}

TEST_F(CommitTogether, RejectsNotesWithFilesOfOtherFolders) {
  fs::create_directory(directory / "run");
  test::put_bytes(directory / "precious", "kept");
  test::put_bytes(directory / "run/precious.part0123456789abcdef", "planted");
  test::put_bytes(directory / "run/x", "planted");
  test::put_bytes(directory / "run/y", "kept");
  test::put_bytes(fs::path(directory / "run") / kCommitNote,
                  "wheeltap-commit 1\nprecious.part0123456789abcdef\n../precious\nx\ny\n");
  finish_commit(directory / "run");
  EXPECT_EQ(test::bytes_of(directory / "precious"), "kept");
  EXPECT_EQ(test::bytes_of(directory / "run/y"), "kept");
}

TEST(AtomicFile, ReportsUnwritableFolders) {
  const test::TemporaryDirectory directory;
  EXPECT_NE(refusal(directory / "absent/a").find("cannot be created"), std::string::npos);
}

}  // namespace
}  // namespace wheeltap::io
