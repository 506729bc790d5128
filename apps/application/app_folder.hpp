// The folder of the application: a browser can access only files below this folder.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace wheeltap::apps {

class AppFolder {
 public:
  /// Throws Failure (66) if `root` is not a folder.
  explicit AppFolder(const std::filesystem::path& root);

  [[nodiscard]] const std::filesystem::path& root() const { return root_; }

  /// The path of `name`, which is relative to the folder and has "/" between its parts. The file
  /// need not exist. The result is empty for an empty or absolute name, and for a name of more than
  /// 1024 bytes, with control characters or with a backslash. The result is also empty if a part
  /// begins with "." (".." and hidden files), or if the name leads out of the folder through a
  /// symbolic link.
  [[nodiscard]] std::optional<std::filesystem::path> place(const std::string& name) const;

  /// The name of a path below the folder.
  [[nodiscard]] std::string name_of(const std::filesystem::path& path) const;

  /// True if the path, without symbolic links, is below the folder.
  [[nodiscard]] bool contains(const std::filesystem::path& path) const;

 private:
  std::filesystem::path root_;  // absolute path without symbolic links
};

}  // namespace wheeltap::apps
