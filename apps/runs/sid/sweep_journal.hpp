// Journal of the finished rows of a sweep.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "apps/results/summary.hpp"

namespace wheeltap::apps {

/// A text file with one line that identifies the sweep and then one line per row: checksum, blank,
/// JSON. The reader removes the first line with a wrong checksum (from a killed program) and all
/// lines after it.
class SweepJournal {
 public:
  /// Opens or creates the journal of the sweep with the given identity. Without `resume`, the rows
  /// of an earlier journal are discarded. Throws io::FileError: unwritable if the file cannot be
  /// written or is not a journal; mismatch if it is the journal of another sweep.
  SweepJournal(std::filesystem::path path, std::string_view identity, bool resume);
  SweepJournal(const SweepJournal&) = delete;
  SweepJournal& operator=(const SweepJournal&) = delete;
  ~SweepJournal();

  /// Returns the row of the given swept value, if the journal has this row.
  [[nodiscard]] std::optional<Report> find(const Report& value) const;
  /// Appends a row and synchronises it to disk. Throws io::FileError (unwritable).
  void append(const Report& value, const Report& row);
  /// Removes the journal. Call this function when all rows are in the result files.
  void remove();

 private:
  void put(std::string_view line) const;

  std::filesystem::path path_;
  int descriptor_ = -1;
  std::map<std::string, Report> rows_;  // rows by the text of the swept value
};

}  // namespace wheeltap::apps
