#include "io/file_lock.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "io/file_error.hpp"
#include "tests/emulator/temporary_directory.hpp"

namespace wheeltap::io {
namespace {

TEST(FileLock, HasOneHolderAtATime) {
  const test::TemporaryDirectory directory;
  test::put_bytes(directory / "a", "text");
  {
    const auto first = FileLock::take(directory / "a");
    ASSERT_TRUE(first);
    EXPECT_FALSE(FileLock::take(directory / "a"));
    EXPECT_TRUE(FileLock::take(directory / "a" / "..")) << "the folder is another thing";
  }
  auto again = FileLock::take(directory / "a");
  ASSERT_TRUE(again);
  const FileLock moved = std::move(*again);
  again.reset();
  EXPECT_FALSE(FileLock::take(directory / "a"));
  EXPECT_THROW(static_cast<void>(FileLock::take(directory / "none")), FileError);
}

TEST(FileLock, EndsWithItsProcess) {
  const test::TemporaryDirectory directory;
  test::put_bytes(directory / "a", "text");
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const auto held = FileLock::take(directory / "a");
    static_cast<void>(!write(ready[1], held ? "y" : "n", 1));
    for (;;) pause();
  }
  char said = 0;
  ASSERT_EQ(read(ready[0], &said, 1), 1);
  EXPECT_EQ(said, 'y');
  EXPECT_FALSE(FileLock::take(directory / "a"));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_TRUE(FileLock::take(directory / "a"));
  close(ready[0]);
  close(ready[1]);
}

}  // namespace
}  // namespace wheeltap::io
