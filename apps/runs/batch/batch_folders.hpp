// Assignment of folders to the cases of a batch.
#pragma once

#include <map>
#include <set>
#include <vector>

#include "apps/runs/batch/batch_list.hpp"

namespace wheeltap::apps {

inline constexpr const char* kBatchFolders = "batch.json";

/// Identifies a case by its path, not by its position: each case keeps its folder if the list
/// grows, shrinks or changes its order between two calls. Paths are relative to the batch folder,
/// so that both can move together. FOLDER/batch.json stores them:
/// {"format": 1, "folders": [{"case": "../a/case.json", "folder": "case"}, …]}.
class BatchFolders {
 public:
  /// With `resume`, reads FOLDER/batch.json. Throws io::FileError (foreign) if it is not a file of
  /// a batch, and does not overwrite it.
  BatchFolders(std::filesystem::path folder, bool resume);

  /// Sets name and place. The n-th occurrence of a path gets the n-th stored folder of this path.
  /// If there is none, it gets a new folder, named as the file without extension, with "-2", "-3",
  /// … if this name is in use.
  void give(BatchCase& one);

  /// Writes batch.json. Throws io::FileError (unwritable).
  void keep() const;

 private:
  [[nodiscard]] std::string place_of(const std::filesystem::path& path) const;
  std::string new_name(const std::filesystem::path& path);

  std::filesystem::path folder_;
  std::map<std::string, std::vector<std::string>> of_;  // folders of each path
  std::map<std::string, std::size_t> given_;            // number of them already assigned
  std::set<std::string> taken_;
  std::map<std::string, int> last_;  // last number after a stem
};

}  // namespace wheeltap::apps
