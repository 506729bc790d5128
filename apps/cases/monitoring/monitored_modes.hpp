// Modes of many tests: from files of `wheeltap modal`, or identified from raw records.
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

/// The modes of one test, or the reason why they are missing.
struct MonitoredTest {
  std::string name = {};       ///< folder and file name
  std::uint64_t checksum = 0;  ///< checksum of the file's content
  ModesFile modes = {};
  std::string fault = {};  ///< reason why the modes are missing; empty if modes were identified
};

struct ModesReading {
  int threads = 1;
  std::uint64_t seed = 1;
  /// Folder that stores the identified modes of raw records for the next call; empty: not stored.
  std::filesystem::path kept = {};
  /// If true and the last file cannot be read, this file counts as incomplete, and the next call
  /// reads it again.
  bool following = false;
  std::function<void(double fraction)> progress = nullptr;
};

/// The modes.json files at `path`. A folder contributes its .json files and the modes.json files in
/// its subfolders. A text file without the extension .json lists one path or run folder per line.
/// For a .json file, the result is this file.
[[nodiscard]] std::vector<std::filesystem::path> mode_files(const std::filesystem::path& path);

/// The files that `names` specify, in this order. In the last component of a name, "*" matches any
/// text and "?" any character. Names at /series/modes can have any form that mode_files accepts.
[[nodiscard]] std::vector<std::filesystem::path> listed_files(
    const CaseFile& file, const Pointer& where, const std::vector<std::string>& names);

/// Reads modes.json files. Throws Failure.
[[nodiscard]] std::vector<MonitoredTest> read_tests(const std::vector<std::filesystem::path>& paths,
                                                    bool following = false);

/// The tests of /series/modes. Throws Failure.
[[nodiscard]] std::vector<MonitoredTest> read_modes_of_tests(const CaseFile& file,
                                                             const ModesReading& reading);

/// Identifies the modes of the records at /series/records, in parallel, with the modal case in this
/// block. Throws Failure if the modal case is invalid, or if no record gives modes.
[[nodiscard]] std::vector<MonitoredTest> identify_tests(const CaseFile& file,
                                                        const ModesReading& reading);

/// The tests that `name` may mean: those with this name (folder and file) or, if there are none,
/// those whose files have the same name.
[[nodiscard]] std::vector<const MonitoredTest*> tests_named(
    const std::string& name, const std::vector<MonitoredTest>& tests);

/// Converts tests to the input of the tracker; a test whose identification failed has no modes.
/// Throws Failure (65) if the sensors of a test differ from those of the first test.
[[nodiscard]] std::vector<identification::monitoring::IdentifiedRecord> identified_records(
    const std::vector<MonitoredTest>& tests);

}  // namespace wheeltap::apps
