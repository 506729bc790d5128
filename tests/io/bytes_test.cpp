#include "io/bytes.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "io/file_error.hpp"
#include "tests/emulator/temporary_directory.hpp"

namespace wheeltap::io::bytes_test {
namespace {

std::string refusal(const std::filesystem::path& path, FileError::Kind kind) {
  try {
    (void)read_bytes(path, 10);
  } catch (const FileError& error) {
    EXPECT_EQ(error.kind(), kind) << error.what();
    return error.reason();
  }
  return "nothing thrown";
}

TEST(Bytes, ReadsWholeFilesOrTheirBeginning) {
  const test::TemporaryDirectory directory;
  test::put_bytes(directory / "f", "0123456789");
  EXPECT_EQ(read_bytes(directory / "f", 10), "0123456789");
  EXPECT_EQ(first_bytes(directory / "f", 4, 4), "0123");
  test::put_bytes(directory / "f", "0123456789+");
  EXPECT_EQ(refusal(directory / "f", FileError::Kind::corrupt), "11 bytes, must be at most 10");
}

// Regression: opening a pipe without a writer blocked, and /dev/zero was read until memory ran out.
TEST(Bytes, RejectsPipesDevicesAndFoldersAtOnce) {
  using Kind = FileError::Kind;
  const test::TemporaryDirectory directory;
  ASSERT_EQ(::mkfifo((directory / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(refusal(directory / "pipe", Kind::missing),
            "cannot be read: is a pipe, not a file: store its content in a file first");
  EXPECT_EQ(refusal("/dev/zero", Kind::missing), "cannot be read: is a device, not a file");
  EXPECT_EQ(refusal(directory / "", Kind::missing), "cannot be read: is a directory");
  EXPECT_EQ(refusal(directory / "none", Kind::missing), "no such file");
}

}  // namespace
}  // namespace wheeltap::io::bytes_test
