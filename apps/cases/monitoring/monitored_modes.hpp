// Modes of many tests: files of `wheeltap modal`, or raw records that are identified one by one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "apps/cases/records/modes_file.hpp"
#include "apps/cases/syntax/case_file.hpp"
#include "identification/monitoring/mode_tracking.hpp"

namespace wheeltap::apps {

/// One test: its modes, or why there are none.
struct MonitoredTest {
  std::string name = {};       ///< folder and name of its file
  std::uint64_t checksum = 0;  ///< over the file's content
  ModesFile modes = {};
  std::string fault = {};  ///< why no modes were identified; empty: they were
};

struct ModesReading {
  int threads = 1;
  std::uint64_t seed = 1;
  /// Folder that keeps the identified modes of raw records for the next call; empty: none.
  std::filesystem::path kept = {};
  /// A last file that cannot be read is still being written: it waits for the next call.
  bool following = false;
  std::function<void(double fraction)> progress = nullptr;
};

/// The modes.json files of a folder (also one folder below, and its other .json files), of a text
/// file without the ending .json that lists one path or folder of a run per line, or the file
/// itself.
[[nodiscard]] std::vector<std::filesystem::path> mode_files(const std::filesystem::path& path);

/// The files that `names` stands for: "*" and "?" in a name's last part stand for any text and any
/// letter, in order of names; names at /series/modes as for mode_files.
[[nodiscard]] std::vector<std::filesystem::path> listed_files(
    const CaseFile& file, const Pointer& where, const std::vector<std::string>& names);

/// Reads modes.json files. Throws Failure.
[[nodiscard]] std::vector<MonitoredTest> read_tests(const std::vector<std::filesystem::path>& paths,
                                                    bool following = false);

/// The tests of /series/modes. Throws Failure.
[[nodiscard]] std::vector<MonitoredTest> read_modes_of_tests(const CaseFile& file,
                                                             const ModesReading& reading);

/// Identifies the records of /series/records by the modal case there, several at a time. Throws
/// Failure where the modal case is at fault, or no record gives modes.
[[nodiscard]] std::vector<MonitoredTest> identify_tests(const CaseFile& file,
                                                        const ModesReading& reading);

/// As the tracker takes them; without modes where identification failed.
/// Throws Failure (65) where tests have other sensors than the first.
[[nodiscard]] std::vector<identification::monitoring::IdentifiedRecord> identified_records(
    const std::vector<MonitoredTest>& tests);

}  // namespace wheeltap::apps
