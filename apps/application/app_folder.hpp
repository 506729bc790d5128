// The folder of the application: a browser names files below it only.
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

  /// The path of a name relative to the folder, with "/" between its parts. The file need not
  /// exist. None for an empty or absolute name, and for one of more than 1024 bytes, with control
  /// characters or with a backslash. None for a part that begins with ".", such as ".." and hidden
  /// files, and for a name that leads out of the folder through a symbolic link.
  [[nodiscard]] std::optional<std::filesystem::path> place(const std::string& name) const;

  /// The name of a path below the folder.
  [[nodiscard]] std::string name_of(const std::filesystem::path& path) const;

  /// True if the path, without symbolic links, is below the folder.
  [[nodiscard]] bool contains(const std::filesystem::path& path) const;

 private:
  std::filesystem::path root_;  // absolute, without symbolic links
};

}  // namespace wheeltap::apps
