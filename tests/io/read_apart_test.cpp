#include "io/read_apart.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

#include "io/tables/columns.hpp"

namespace wheeltap::io {
namespace {

using Kind = FileError::Kind;

std::string refusal_apart(const std::function<std::string()>& read, double seconds = 0.0) {
  try {
    (void)read_apart("a.mat", read, seconds);
  } catch (const FileError& error) {
    EXPECT_EQ(error.kind(), Kind::corrupt);
    return error.what();
  }
  return "nothing was thrown";
}

TEST(ReadApart, ReturnsTheBytes) {
  const std::string long_one(3'000'000, 'x');
  EXPECT_EQ(read_apart("a.mat", [&] { return long_one; }), long_one);
  EXPECT_EQ(read_apart("a.mat", [] { return std::string(); }), "");
}

TEST(ReadApart, ReturnsATable) {
  const Columns table{.file = "a.mat",
                      .columns = {{.header = "force [N]",
                                   .name = "force",
                                   .unit = "N",
                                   .values = {1.0, 2.5},
                                   .decimals = 1,
                                   .digits = 2}},
                      .scalars = {{"dt", 0.01}, {"fs", 100.0}},
                      .first_line = 3,
                      .skipped = {1}};
  const auto got = read_apart_as<Columns>("a.mat", [&] { return table; });
  EXPECT_EQ(got.file, table.file);
  ASSERT_EQ(got.columns.size(), 1U);
  EXPECT_EQ(got.columns[0].header, "force [N]");
  EXPECT_EQ(got.columns[0].unit, "N");
  EXPECT_EQ(got.columns[0].values, table.columns[0].values);
  EXPECT_EQ(got.columns[0].digits, 2);
  EXPECT_EQ(got.scalars, table.scalars);
  EXPECT_EQ(got.first_line, 3);
  EXPECT_EQ(got.skipped, table.skipped);
}

TEST(ReadApart, RethrowsExceptionsOfTheReader) {
  try {
    (void)read_apart("a.mat", []() -> std::string {
      throw FileError(Kind::foreign, "b.mat", {.line = 3, .column = 2, .header = "u"}, "no number");
    });
    FAIL();
  } catch (const FileError& error) {
    EXPECT_EQ(error.kind(), Kind::foreign);
    EXPECT_STREQ(error.what(), "b.mat, line 3, column 2 ('u'): no number");
    EXPECT_EQ(error.place().header, "u");
  }
  EXPECT_THAT(refusal_apart([]() -> std::string { throw std::bad_alloc(); }),
              testing::HasSubstr("memory"));
  EXPECT_THROW((void)read_apart("a.mat", []() -> std::string { throw std::range_error("x"); }),
               std::runtime_error);
}

TEST(ReadApart, ReportsACrashAsADamagedFile) {
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE})
    EXPECT_THAT(refusal_apart([signal]() -> std::string {
                  std::signal(signal, SIG_DFL);  // sanitizers install their own handlers
                  std::raise(signal);
                  return "";
                }),
                testing::AllOf(testing::StartsWith("a.mat: "), testing::HasSubstr("crashed")));
  EXPECT_THAT(refusal_apart([]() -> std::string { _exit(3); }), testing::HasSubstr("crashed"));
}

// Ctrl-C reaches the whole process group; it does not mean a corrupt file.
TEST(ReadApart, DoesNotBlameTheFileForSignals) {
  EXPECT_EQ(read_apart("a.mat",
                       [] {
                         for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::raise(signal);
                         return std::string("read");
                       }),
            "read");
  // As when the system is out of memory.
  EXPECT_THROW((void)read_apart("a.mat",
                                []() -> std::string {
                                  std::raise(SIGKILL);
                                  return "";
                                }),
               std::bad_alloc);
}

TEST(ReadApart, StopsAReaderThatRunsForever) {
  EXPECT_THAT(refusal_apart(
                  []() -> std::string {
                    for (std::atomic<unsigned> i = 0;;) ++i;
                  },
                  1.0),
              testing::HasSubstr("1 s of processor time"));
}

// Regression: 288 bytes made libmatio allocate 1.9 GB.
TEST(ReadApart, LimitsTheMemoryForASmallFile) {
  // Allocates like the libraries; `new` would end the program under the address sanitizer.
  EXPECT_THAT(refusal_apart([]() -> std::string {
                void* volatile much = std::malloc(3'000'000'000);
                if (much == nullptr) throw std::bad_alloc();
                std::free(much);
                return "";
              }),
              testing::HasSubstr("1024 MB of memory were not enough"));
  EXPECT_EQ(read_apart("a.mat",
                       [] {
                         constexpr std::size_t kMuch = 500'000'000, kPage = 4096;
                         const std::unique_ptr<char[]> much(new char[kMuch]);
                         for (std::size_t at = 0; at < kMuch; at += kPage) much[at] = 'x';
                         return std::string(much.get(), 1);
                       }),
            "x");
}

TEST(ReadApart, SuppressesOutputOfTheReader) {
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  (void)read_apart("a.mat", [] {
    std::fputs("HDF5-DIAG: much", stderr);
    std::fputs("more", stdout);
    std::fflush(nullptr);
    return std::string();
  });
  EXPECT_EQ(testing::internal::GetCapturedStderr() + testing::internal::GetCapturedStdout(), "");
}

}  // namespace
}  // namespace wheeltap::io
