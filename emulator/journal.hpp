// A file that remembers finished runs, so that an interrupted experiment goes on where it stopped.
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

/// One line of text that says what the runs belong to, then a record for each finished run: its
/// number, its responses, and a checksum. A process killed in the middle of a record leaves a tail
/// that fails its checksum; opening the journal again cuts it off. Not thread-safe.
class Journal {
 public:
  struct Entry {
    std::int64_t run;
    std::vector<double> response;
  };

  /// One process at a time writes it, or as many as like: what they add stands record by record.
  enum class Use { alone, shared };

  /// Opens or creates the journal of an experiment with this identity and number of responses.
  /// Throws FileError: foreign (not a journal), mismatch (of another experiment), unwritable, also
  /// where another process has it alone.
  Journal(std::filesystem::path path, std::string_view identity, std::size_t responses,
          Use use = Use::alone);

  /// Removes a journal, of whichever experiment, if there is one. Throws FileError (unwritable)
  /// where something else has its name, or another process writes it; it stays then.
  static void remove(const std::filesystem::path& path);

  /// The runs found in the file when it was opened.
  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }

  /// Adds a run and hands it to the operating system. Throws FileError (unwritable) on a full disk.
  void append(std::int64_t run, std::span<const double> response);

 private:
  std::filesystem::path path_;
  std::vector<Entry> entries_;
  std::ofstream stream_;
  std::optional<io::FileLock> lock_;
};

}  // namespace wheeltap::emulator
