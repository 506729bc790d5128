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

/// A journal file. The file contains one line of text that identifies the experiment, then one
/// record per finished run: index of the run, responses and checksum. If a process is killed while
/// writing, the last record is incomplete and its checksum is wrong; the next process that opens
/// the journal removes this record. The class is not thread-safe.
class Journal {
 public:
  struct Entry {
    std::int64_t run;
    std::vector<double> response;
  };

  /// `alone`: only one process may open the journal. `shared`: several processes may append at the
  /// same time; each record stays contiguous.
  enum class Use { alone, shared };

  /// Opens or creates the journal of an experiment with this identity and number of responses.
  /// Throws FileError of the kind foreign if the file is not a journal, and of the kind mismatch if
  /// the journal belongs to another experiment. The error kind is unwritable if the file cannot be
  /// written, or if another process has locked the journal. Processes that share a journal lock it
  /// only while they open it or append to it.
  Journal(std::filesystem::path path, std::string_view identity, std::size_t responses,
          Use use = Use::alone);

  /// Removes a journal of any experiment, if the file exists. Throws FileError (unwritable),
  /// without removing the file, if the file is not a journal or another process writes to the
  /// journal.
  static void remove(const std::filesystem::path& path);

  /// The runs that the file contained when the journal was opened.
  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }

  /// Appends the record of a run and passes the record to the operating system. Throws FileError
  /// (unwritable) if the disk is full.
  void append(std::int64_t run, std::span<const double> response);

 private:
  std::filesystem::path path_;
  std::vector<Entry> entries_;
  std::ofstream stream_;
  std::optional<io::FileLock> lock_;
};

}  // namespace wheeltap::emulator
