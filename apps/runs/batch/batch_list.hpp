// The cases of a batch.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace wheeltap::apps {

struct BatchCase {
  std::filesystem::path path;
  std::string name{};   ///< name of the case's folder (BatchFolders)
  std::string place{};  ///< path of the case relative to the batch folder (BatchFolders)
};

/// Reads a list with one path per line, relative to the folder of the list; ignores blank lines and
/// lines that begin with #. The cases have no folders yet. Throws io::FileError if the list is
/// unreadable; Failure (65), with the line, for control characters or invalid UTF-8, and for a list
/// without cases.
[[nodiscard]] std::vector<BatchCase> read_batch_list(const std::filesystem::path& list);

}  // namespace wheeltap::apps
