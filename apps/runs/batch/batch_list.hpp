// The cases of a batch.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace wheeltap::apps {

struct BatchCase {
  std::filesystem::path path;
  std::string name{};   ///< of its folder, BatchFolders
  std::string place{};  ///< its path from the batch's folder, BatchFolders
};

/// One path a line, relative to the list's own folder; blank lines and lines that begin with # are
/// passed over. The cases have no folders yet. Throws io::FileError for a list that cannot be read,
/// Failure (65) with the line for one that holds control characters or no UTF-8, and for a list
/// without cases.
[[nodiscard]] std::vector<BatchCase> read_batch_list(const std::filesystem::path& list);

}  // namespace wheeltap::apps
