// The finished rows of a sweep, kept while the others run.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "apps/results/summary.hpp"

namespace wheeltap::apps {

/// One line of text that says which sweep, then one a row: its checksum, a blank, JSON. A line that
/// fails its checksum was being written when the program was killed; what follows is cut off.
class SweepJournal {
 public:
  /// Opens the journal of the sweep with this identity, or makes it; where `resume` is false, what
  /// a journal of before holds is forgotten. Throws io::FileError: unwritable, also where another
  /// program's file has the name; mismatch for the journal of another sweep.
  SweepJournal(std::filesystem::path path, std::string_view identity, bool resume);
  SweepJournal(const SweepJournal&) = delete;
  SweepJournal& operator=(const SweepJournal&) = delete;
  ~SweepJournal();

  /// What was kept of this value, if it was.
  [[nodiscard]] std::optional<Report> find(const Report& value) const;
  /// Keeps a row, and waits for the disk. Throws io::FileError (unwritable).
  void append(const Report& value, const Report& row);
  /// All is written elsewhere.
  void remove();

 private:
  void put(std::string_view line) const;

  std::filesystem::path path_;
  int descriptor_ = -1;
  std::map<std::string, Report> rows_;  // by the value's text
};

}  // namespace wheeltap::apps
