// A file of finished runs, from which an interrupted experiment resumes.
#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "io/file_error.hpp"
#include "io/file_lock.hpp"

namespace wheeltap::emulator {

/// One line of text that identifies the experiment, then one record per finished run: number,
/// responses and checksum. If a process is killed while writing, the incomplete record at the end
/// fails its checksum, and opening the journal removes it. Not thread-safe.
class Journal {
 public:
  struct Entry {
    std::int64_t run;
    std::vector<double> response;
  };

  /// Use by one process or by several at a time; records of several processes do not interleave.
  enum class Use { alone, shared };

  /// Opens or creates the journal of an experiment with this identity and number of responses.
  /// Throws FileError: foreign if the file is not a journal, mismatch if it belongs to another
  /// experiment, unwritable if it cannot be written or another process has exclusive use.
  Journal(std::filesystem::path path, std::string_view identity, std::size_t responses,
          Use use = Use::alone);

  /// Removes a journal, of whatever experiment, if it exists. Throws FileError (unwritable) without
  /// removing the file if it is not a journal or another process writes to it.
  static void remove(const std::filesystem::path& path);

  /// The runs in the file when it was opened.
  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }

  /// Appends a run and passes it to the operating system. Throws FileError (unwritable) on a full
  /// disk.
  void append(std::int64_t run, std::span<const double> response);

 private:
  std::filesystem::path path_;
  std::vector<Entry> entries_;
  std::ofstream stream_;
  std::optional<io::FileLock> lock_;
};

}  // namespace wheeltap::emulator
