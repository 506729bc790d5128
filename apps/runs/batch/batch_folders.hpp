// Assignment of folders to the cases of a batch.
#pragma once

#include <map>
#include <set>
#include <vector>

#include "apps/runs/batch/batch_list.hpp"

namespace wheeltap::apps {

inline constexpr const char* kBatchFolders = "batch.json";

/// Assigns a folder to each case of a batch. A case is identified by its path, not by its position
/// in the list. A case therefore keeps its folder if the list grows, shrinks or changes its order
/// between two calls. Paths are relative to the batch folder, so that cases and batch folder can be
/// moved together. FOLDER/batch.json stores paths and folders: {"format": 1, "folders": [{"case":
/// "../a/case.json", "folder": "case"}, …]}.
class BatchFolders {
 public:
  /// With `resume`, reads FOLDER/batch.json. Throws io::FileError (foreign) if batch.json is not a
  /// file of a batch; the file is not overwritten.
  BatchFolders(std::filesystem::path folder, bool resume);

  /// Sets name and relative path of a case. The n-th occurrence of a path gets the n-th stored
  /// folder of this path. If there is no n-th stored folder, the case gets a new folder with the
  /// name of the file without extension. If this name is in use, "-2", "-3", … is appended.
  void give(BatchCase& one);

  /// Writes the folders to batch.json. Throws io::FileError (unwritable).
  void keep() const;

 private:
  [[nodiscard]] std::string place_of(const std::filesystem::path& path) const;
  std::string new_name(const std::filesystem::path& path);

  std::filesystem::path folder_;
  std::map<std::string, std::vector<std::string>> of_;  // folders of each path
  // Number of folders of each path that are already assigned to cases
  std::map<std::string, std::size_t> given_;
  std::set<std::string> taken_;
  std::map<std::string, int> last_;  // last number appended to a folder name
};

}  // namespace wheeltap::apps
