#include "io/atomic_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <random>
#include <sstream>
#include <system_error>
#include <vector>

namespace wheeltap::io {
namespace {

namespace fs = std::filesystem;

constexpr int kTries = 100;
constexpr std::string_view kPart = ".part";
constexpr std::size_t kDigits = 16;
constexpr const char* kNoteHead = "wheeltap-commit 1";

[[noreturn]] void fail_to_write(const fs::path& path, const std::string& reason) {
  throw FileError(FileError::Kind::unwritable, path, reason);
}

[[noreturn]] void fail_to_write(const fs::path& path, int error) {
  fail_to_write(path, std::generic_category().message(error));
}

fs::path folder_of(const fs::path& path) {
  const fs::path folder = path.parent_path();
  return folder.empty() ? "." : folder;
}

/// Flushes the names in a folder to the disk. The function ignores a failure, because a writable
/// folder need not be readable, and some file systems lack this operation. The files are complete
/// even if the flush fails.
void sync_folder(const fs::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  static_cast<void>(::fsync(descriptor));
  ::close(descriptor);
}

/// Returns a random file name. Other users may have access to the folder, but cannot guess this
/// name.
fs::path temporary_name(const fs::path& path) {
  std::random_device random;
  char digits[kDigits + 1];
  std::snprintf(digits, sizeof digits, "%08x%08x", random(), random());
  fs::path name = path;
  return name += std::string(kPart) + digits;
}

bool is_temporary_of(const std::string& name, const std::string& final_name) {
  const std::string before = final_name + std::string(kPart);
  return name.starts_with(before) && name.size() == before.size() + kDigits &&
         name.find_first_not_of("0123456789abcdef", before.size()) == std::string::npos;
}

/// Locks a file. Returns false if another process holds the lock, or if the file system does not
/// support locks.
bool lock(int descriptor) {
  return ::flock(descriptor, LOCK_EX | LOCK_NB) == 0;
}

/// Opens and locks a regular file of this user. Returns -1 if `path` is any other file.
int open_own(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return -1;
  struct stat found {};
  if (::fstat(descriptor, &found) == 0 && S_ISREG(found.st_mode) && found.st_uid == ::geteuid() &&
      lock(descriptor)) {
    return descriptor;
  }
  ::close(descriptor);
  return -1;
}

/// Removes the temporary files of `path` that no process has locked.
void sweep(const fs::path& path) {
  std::error_code error;
  std::vector<fs::path> stale;
  const std::string name = path.filename().string();
  for (auto entry = fs::directory_iterator(folder_of(path), error);
       !error && entry != fs::directory_iterator(); entry.increment(error)) {
    if (is_temporary_of(entry->path().filename().string(), name)) stale.push_back(entry->path());
  }
  for (const fs::path& file : stale) {
    const int descriptor = open_own(file);
    if (descriptor < 0) continue;
    ::unlink(file.c_str());
    ::close(descriptor);
  }
}

}  // namespace

AtomicFile::AtomicFile(fs::path path, std::size_t reserve) : path_(std::move(path)) {
  std::error_code none;
  const auto there = fs::status(path_, none);
  if (fs::exists(there) && !fs::is_regular_file(there))
    fail_to_write(path_, fs::is_directory(there)
                             ? "is a directory"
                             : "is not a regular file: a pipe or a device cannot be replaced");
  sweep(path_);
  int error = EEXIST;
  for (int i = 0; i < kTries && error == EEXIST; ++i) {
    temporary_ = temporary_name(path_);
    descriptor_ =
        ::open(temporary_.c_str(), O_CREAT | O_EXCL | O_NOFOLLOW | O_WRONLY | O_CLOEXEC, 0666);
    error = descriptor_ < 0 ? errno : 0;
    if (error != 0) continue;
    // Another process may have removed the file before this process locked it.
    struct stat found {};
    lock(descriptor_);
    if (::fstat(descriptor_, &found) != 0 || found.st_nlink == 0) {
      close();
      error = EEXIST;
    }
  }
  if (error == ENOENT || error == ENOTDIR || error == EACCES || error == EPERM || error == EEXIST)
    fail_to_write(path_,
                  "cannot be created: check that its directory exists and may be written to");
  if (error != 0) fail_to_write(path_, error);
  if (reserve == 0) return;
  // Other errors are ignored: the file system lacks this operation, or file sizes are limited. A
  // later write then reports the error.
  error = ::posix_fallocate(descriptor_, 0, static_cast<off_t>(reserve));
  if (error == ENOSPC || error == EDQUOT) {
    ::unlink(temporary_.c_str());
    close();
    fail_to_write(path_, error);
  }
}

AtomicFile::~AtomicFile() {
  std::error_code ignored;
  if (!committed_) fs::remove(temporary_, ignored);
  close();
}

void AtomicFile::close() {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
}

void AtomicFile::write(std::string_view bytes) {
  // Overwrites the reserved space, and releases the remaining space.
  if (::lseek(descriptor_, 0, SEEK_SET) != 0) fail_to_write(path_, errno);
  put(bytes);
  if (::ftruncate(descriptor_, static_cast<off_t>(bytes.size())) != 0) fail_to_write(path_, errno);
}

void AtomicFile::append(std::string_view bytes) {
  if (::lseek(descriptor_, 0, SEEK_END) < 0) fail_to_write(path_, errno);
  put(bytes);
}

void AtomicFile::put(std::string_view bytes) const {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail_to_write(path_, written < 0 ? errno : ENOSPC);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

void AtomicFile::lend(const std::function<void(const fs::path& temporary)>& use) {
  ::flock(descriptor_, LOCK_UN);
  try {
    use(temporary_);
  } catch (...) {
    lock(descriptor_);
    throw;
  }
  lock(descriptor_);
}

void AtomicFile::flush() {
  // Without fsync, a renamed file may be empty after a power failure.
  if (::fsync(descriptor_) != 0) fail_to_write(path_, errno);
}

void AtomicFile::rename() const {
  if (::rename(temporary_.c_str(), path_.c_str()) != 0) fail_to_write(path_, errno);
}

void AtomicFile::commit() {
  flush();
  rename();
  committed_ = true;
  sync_folder(folder_of(path_));
}

void commit_together(std::span<AtomicFile* const> files) {
  if (files.empty()) return;
  const fs::path folder = folder_of(files[0]->path());
  std::ostringstream note;
  note << kNoteHead << '\n';
  for (AtomicFile* file : files) {
    file->flush();
    note << file->temporary().filename().string() << '\n'
         << file->path().filename().string() << '\n';
  }
  // The note is locked during the commit, so that no other process completes this commit.
  AtomicFile noted(folder / kCommitNote);
  noted.write(note.str());
  noted.commit();

  // Names of the previous files during the commit; a later cleanup removes such files.
  std::vector<fs::path> before;
  std::error_code error;
  try {
    for (AtomicFile* file : files) {
      before.push_back(temporary_name(file->path()));
      if (::link(file->path().c_str(), before.back().c_str()) != 0) before.back().clear();
      file->rename();
      file->committed_ = true;
    }
  } catch (const FileError&) {
    bool undone = true;
    for (std::size_t i = before.size(); i-- > 0;) {
      AtomicFile& file = *files[i];
      if (file.committed_) {
        fs::rename(file.path(), file.temporary(), error);
        if (!error && !before[i].empty()) fs::rename(before[i], file.path(), error);
        undone = undone && !error;
        file.committed_ = static_cast<bool>(error);
      }
      if (!file.committed_) fs::remove(before[i], error);
    }
    if (undone) {
      fs::remove(noted.path(), error);
    } else {
      for (AtomicFile* file : files) file->committed_ = true;  // finish_commit renames it
    }
    throw;
  }
  sync_folder(folder);
  fs::remove(noted.path(), error);
  for (const fs::path& name : before) {
    if (!name.empty()) fs::remove(name, error);
  }
}

void finish_commit(const fs::path& folder) {
  const fs::path note = folder / kCommitNote;
  const int descriptor = open_own(note);
  if (descriptor < 0) return;
  std::string text;
  char piece[4096];
  for (ssize_t got = 0; (got = ::read(descriptor, piece, sizeof piece)) > 0;)
    text.append(piece, static_cast<std::size_t>(got));
  std::istringstream lines(text);
  std::string line, name;
  if (std::getline(lines, line) && line == kNoteHead) {
    std::error_code error;
    while (std::getline(lines, line) && std::getline(lines, name)) {
      if (name.find('/') != std::string::npos || !is_temporary_of(line, name)) continue;
      if (fs::is_regular_file(fs::symlink_status(folder / line, error)))
        fs::rename(folder / line, folder / name, error);
      sweep(folder / name);
    }
    sync_folder(folder);
    fs::remove(note, error);
  }
  ::close(descriptor);
}

}  // namespace wheeltap::io
