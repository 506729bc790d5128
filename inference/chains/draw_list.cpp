#include "inference/chains/draw_list.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <new>
#include <string>
#include <system_error>

namespace wheeltap::inference {
namespace {

// Opens an unnamed file, or a file whose name is deleted at once; -1 if both are impossible.
int nameless_file(const std::filesystem::path& folder) {
#ifdef O_TMPFILE
  if (const int file = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600); file >= 0)
    return file;
#endif
  std::string name = (folder / ".wheeltap-draws-XXXXXX").string();
  const int file = ::mkstemp(name.data());
  if (file < 0) return -1;
  ::fcntl(file, F_SETFD, FD_CLOEXEC);
  ::unlink(name.c_str());
  return file;
}

// Reserves disk space. Returns false for a full disk; without disk space, access to a mapped page
// would kill the process. If the file system cannot reserve space, this function writes and
// synchronises zeros.
bool take_room(int file, std::size_t from, std::size_t to) {
  int error = EINTR;
  while (error == EINTR)
    error = ::posix_fallocate(file, static_cast<off_t>(from), static_cast<off_t>(to - from));
  return error == 0 && ::fsync(file) == 0;
}

}  // namespace

DrawMemory::~DrawMemory() {
  free();
}

void DrawMemory::free() {
  if (file_ < 0) {
    std::free(data_);
    return;
  }
  if (data_ != nullptr) ::munmap(data_, capacity_);
  ::close(file_);
}

void DrawMemory::swap(DrawMemory& other) noexcept {
  folder_.swap(other.folder_);
  std::swap(data_, other.data_);
  std::swap(capacity_, other.capacity_);
  std::swap(file_, other.file_);
}

void DrawMemory::grow(std::size_t bytes) {
  if (bytes <= capacity_) return;
  if (!folder_.empty() && bytes > kOnHeap) {
    if (grow_file(bytes)) return;
    folder_.clear();
  }
  grow_heap(bytes);
}

bool DrawMemory::grow_file(std::size_t bytes) {
  constexpr std::size_t kPages = 1 << 16;
  bytes = (bytes + kPages - 1) / kPages * kPages;
  const bool first = file_ < 0;
  const int file = first ? nameless_file(folder_) : file_;
  if (file < 0) return false;
  void* at = MAP_FAILED;
  if (take_room(file, first ? 0 : capacity_, bytes))
    at = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  if (at == MAP_FAILED) {
    if (first) ::close(file);
    return false;
  }
  if (first) {
    if (capacity_ > 0) std::memcpy(at, data_, capacity_);
    std::free(data_);
  } else {
    ::munmap(data_, capacity_);
  }
  data_ = static_cast<std::byte*>(at);
  capacity_ = bytes;
  file_ = file;
  return true;
}

void DrawMemory::grow_heap(std::size_t bytes) {
  void* at = file_ < 0 ? std::realloc(data_, bytes) : std::malloc(bytes);
  if (at == nullptr) throw std::bad_alloc();
  if (file_ >= 0) {
    std::memcpy(at, data_, capacity_);
    free();
    file_ = -1;
  }
  data_ = static_cast<std::byte*>(at);
  capacity_ = bytes;
}

// A copy-on-write file system may run out of space even for reserved blocks.
void DrawMemory::settle() const {
  if (file_ < 0 || ::fsync(file_) == 0) return;
  throw DrawsLost(std::generic_category().message(errno));
}

void DrawMemory::let_go() const {
#ifdef __linux__
  // In a shared mapping, changed pages are not lost: they remain in the cache and are written.
  if (file_ >= 0) ::madvise(data_, capacity_, MADV_DONTNEED);
#endif
}

}  // namespace wheeltap::inference
