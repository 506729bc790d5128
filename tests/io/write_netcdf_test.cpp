#include "io/netcdf/write_netcdf.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/resource.h>

#include <csignal>
#include <vector>

#include "io/bytes.hpp"
#include "io/fingerprint.hpp"
#include "io/netcdf/netcdf_reader.hpp"
#include "io/netcdf/netcdf_writer.hpp"
#include "tests/emulator/temporary_directory.hpp"

namespace wheeltap::io {
namespace {

constexpr std::size_t kDraws = 200'000;
constexpr std::size_t kLong = kNetcdfInMemory + 1;

void fill(const NetcdfWriter& file) {
  file.text(file.root(), NC_GLOBAL, "title", "draws");
  const int group = file.group("posterior");
  const int chain = file.dimension(group, "chain", 2, 0);
  const int draw = file.dimension(group, "draw", kDraws, 0);
  file.put_rows<double>(group, "k", {chain, draw}, [](std::size_t c, std::vector<double>& row) {
    for (std::size_t i = 0; i < kDraws; ++i)
      row.push_back(static_cast<double>((c + 1) * (i * i % 9973)));
  });
}

class WriteNetcdfTest : public testing::Test {
 protected:
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory / "posterior.nc";

  std::string written(std::size_t bytes) const {
    AtomicFile file(path);
    write_netcdf(file, bytes, fill);
    file.commit();
    return read_bytes(path);
  }
};

TEST_F(WriteNetcdfTest, DiskAndMemoryFilesHaveEqualBytes) {
  const std::string in_memory = written(1), on_disk = written(kLong);
  EXPECT_GT(in_memory.size(), 100'000U);
  EXPECT_TRUE(in_memory == on_disk);
  const NetcdfReader read(path);
  EXPECT_EQ(read.read(read.required_group("posterior"), "k").values[kDraws + 2], 8.0);
}

TEST_F(WriteNetcdfTest, ReportsAFullDisk) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto caught = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{100'000, before.rlim_max};
  std::string said;
  {
    AtomicFile file(path);
    setrlimit(RLIMIT_FSIZE, &small);
    try {
      write_netcdf(file, kLong, fill);
    } catch (const FileError& error) {
      EXPECT_EQ(error.kind(), FileError::Kind::unwritable);
      EXPECT_EQ(error.path(), path);
      said = error.reason();
    }
    setrlimit(RLIMIT_FSIZE, &before);
  }
  std::signal(SIGXFSZ, caught);
  EXPECT_EQ(said, "File too large");
  EXPECT_EQ(directory.files(), 0);
}

TEST_F(WriteNetcdfTest, SurvivesACrashOfTheLibrary) {
  AtomicFile file(path);
  try {
    write_netcdf(file, kLong, [](const NetcdfWriter&) { std::raise(SIGSEGV); });
    FAIL() << "nothing was thrown";
  } catch (const FileError& error) {
    EXPECT_THAT(error.reason(), testing::HasSubstr("crashed"));
  }
  // As the system does when it is out of memory.
  try {
    write_netcdf(file, kLong, [](const NetcdfWriter&) { std::raise(SIGKILL); });
    FAIL() << "nothing was thrown";
  } catch (const FileError& error) {
    EXPECT_EQ(error.kind(), FileError::Kind::unwritable);
    EXPECT_THAT(error.reason(), testing::HasSubstr("killed"));
  }
  try {
    write_netcdf(file, kLong, [](const NetcdfWriter& to) { to.check(NC_EBADNAME); });
    FAIL() << "nothing was thrown";
  } catch (const FileError& error) {
    EXPECT_EQ(error.path(), path);
    EXPECT_THAT(error.reason(), testing::HasSubstr("illegal"));
  }
}

TEST_F(WriteNetcdfTest, FingerprintCoversTheWholeFile) {
  const std::string bytes = written(1) + std::string(3'000'000, 'x');
  {
    AtomicFile file(path);
    file.write(bytes);
    file.commit();
  }
  const FileFingerprint found = fingerprint_of_file(path);
  EXPECT_EQ(found.bytes, bytes.size());
  EXPECT_EQ(found.digits, fingerprint(bytes));
}

}  // namespace
}  // namespace wheeltap::io
