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

  /// Returns the path of the file `name`. The name is relative to the folder; "/" separates its
  /// components. The file need not exist. The result is empty if the name is empty, absolute or
  /// longer than 1024 bytes, or contains a control character or a backslash. The result is also
  /// empty if a component of the path begins with "." (".." and hidden files), or if the name leads
  /// out of the folder through a symbolic link.
  [[nodiscard]] std::optional<std::filesystem::path> place(const std::string& name) const;

  /// Returns the path of a file below the folder, relative to the folder.
  [[nodiscard]] std::string name_of(const std::filesystem::path& path) const;

  /// True if the path, after its symbolic links are resolved, is below the folder.
  [[nodiscard]] bool contains(const std::filesystem::path& path) const;

 private:
  std::filesystem::path root_;  // absolute path without symbolic links
};

}  // namespace wheeltap::apps
