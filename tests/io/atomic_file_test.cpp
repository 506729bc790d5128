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

TEST(AtomicFile, TakesThePlaceAtCommitOnly) {
  const test::TemporaryDirectory directory;
  const auto path = directory / "a.txt";
  test::put_bytes(path, "old");
  {
    AtomicFile file(path);
    test::put_bytes(file.temporary(), "lost");
  }
  EXPECT_EQ(test::bytes_of(path), "old");
  AtomicFile file(path);
  test::put_bytes(file.temporary(), "new");
  EXPECT_EQ(test::bytes_of(path), "old");
  file.commit();
  EXPECT_EQ(test::bytes_of(path), "new");
  EXPECT_EQ(directory.files(), 1) << "no temporary file stays behind";
}

TEST(AtomicFile, TemporaryNamesAreNeverTheSame) {
  const test::TemporaryDirectory directory;
  std::set<fs::path> names;
  for (int i = 0; i < 100; ++i) names.insert(AtomicFile(directory / "a").temporary());
  EXPECT_EQ(names.size(), 100U);
  for (const fs::path& name : names) EXPECT_EQ(name.parent_path(), (directory / "a").parent_path());
}

// A name that could be guessed could be made first, as a link to somebody's file.
TEST(AtomicFile, ALinkWithTheTemporaryNameIsNeverFollowed) {
  const test::TemporaryDirectory directory;
  test::put_bytes(directory / "precious", "kept");
  // The names of before: the process and a counter.
  for (int i = 0; i < 1000; ++i)
    fs::create_symlink(directory / "precious", directory / ("a.part" + std::to_string(::getpid()) +
                                                            "-" + std::to_string(i)));
  AtomicFile file(directory / "a");
  test::put_bytes(file.temporary(), "new");
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

TEST(AtomicFile, NowhereToWrite) {
  const test::TemporaryDirectory directory;
  EXPECT_NE(refusal(directory / "absent/a").find("cannot be created"), std::string::npos);
}

}  // namespace
}  // namespace wheeltap::io
