// Writing a file so that nothing half-written ever stands under its name.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "io/file_error.hpp"

namespace wheeltap::io {

/// Holds a temporary name in the directory of `path`: "NAME.part" and 16 random hexadecimal digits,
/// made exclusively and locked while this lives. What is written there takes `path`'s place at
/// `commit`, and is removed when it never comes to that. A process that was killed leaves its
/// temporary file behind, without a lock: the next one for the same `path` removes it.
class AtomicFile {
 public:
  /// Throws FileError (unwritable) where no file can be created there, something else than a
  /// regular file has the name (a folder, a pipe, a device), or there is no room for `reserve`
  /// bytes, which are then this file's while it lives.
  explicit AtomicFile(std::filesystem::path path, std::size_t reserve = 0);
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] const std::filesystem::path& temporary() const { return temporary_; }
  /// The whole content, in place of what was written before. Throws FileError (unwritable).
  void write(std::string_view bytes);
  /// Behind what was written before. Throws FileError (unwritable).
  void append(std::string_view bytes);
  /// `use` may open the temporary file by its name, to write or to read it, with locks of its own.
  void lend(const std::function<void(const std::filesystem::path& temporary)>& use);
  /// Waits for the disk. Throws FileError (unwritable).
  void settle();
  /// Settles and renames. Throws FileError (unwritable).
  void commit();

 private:
  friend void commit_together(std::span<AtomicFile* const> files);
  void put(std::string_view bytes) const;
  void rename() const;
  void close();

  std::filesystem::path path_, temporary_;
  int descriptor_ = -1;
  bool committed_ = false;
};

/// Gives files of one folder their names as if at once. Where one cannot have its name, none has,
/// and what had the names before is there again. A process killed between the first and the last,
/// or one that cannot even go back, leaves a note of what remains to be done (kCommitNote), which
/// `finish_commit` does. Throws FileError (unwritable).
void commit_together(std::span<AtomicFile* const> files);

/// Ends what a killed `commit_together` began in this folder, if there is such a thing.
void finish_commit(const std::filesystem::path& folder);

inline constexpr const char* kCommitNote = ".wheeltap-commit";

}  // namespace wheeltap::io
