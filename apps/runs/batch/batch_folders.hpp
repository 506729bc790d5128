// Which folder of a batch belongs to which case.
#pragma once

#include <map>
#include <set>
#include <vector>

#include "apps/runs/batch/batch_list.hpp"

namespace wheeltap::apps {

inline constexpr const char* kBatchFolders = "batch.json";

/// A case is known by its path, whatever its place in the list: lists may grow, shrink and change
/// their order between two calls, and each case keeps its folder. Paths are relative to the batch's
/// folder, so that both may be moved together. FOLDER/batch.json keeps them:
/// {"format": 1, "folders": [{"case": "../a/case.json", "folder": "case"}, …]}.
class BatchFolders {
 public:
  /// With `resume`, begins with what `folder` keeps. Throws io::FileError (foreign) where
  /// batch.json is none of ours, which is not written over.
  BatchFolders(std::filesystem::path folder, bool resume);

  /// Sets name and place: the folder that the path has, of the n-th time that it is in the list the
  /// n-th; else a new one, the stem of its file, with "-2", "-3", … where that is taken.
  void give(BatchCase& one);

  /// Writes batch.json. Throws io::FileError (unwritable).
  void keep() const;

 private:
  [[nodiscard]] std::string place_of(const std::filesystem::path& path) const;
  std::string new_name(const std::filesystem::path& path);

  std::filesystem::path folder_;
  std::map<std::string, std::vector<std::string>> of_;  // folders of each path
  std::map<std::string, std::size_t> given_;            // how many of them are given out
  std::set<std::string> taken_;
  std::map<std::string, int> last_;  // number behind a stem
};

}  // namespace wheeltap::apps
