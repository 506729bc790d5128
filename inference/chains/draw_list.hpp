// A growing sequence of numbers that may exceed the available memory.
#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <iterator>
#include <stdexcept>
#include <type_traits>
#include <utility>

namespace wheeltap::inference {

/// Thrown if draws for which the file system had reserved space cannot be written to disk.
class DrawsLost : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A growing byte buffer on the heap. If a folder is given and the size of the buffer reaches
/// kOnHeap, the buffer moves to an unnamed file in that folder. The file is mapped into memory. The
/// operating system writes mapped pages to disk when memory is short. The operating system deletes
/// the file when this object is destroyed or the process ends. Disk space is reserved as the file
/// grows. If the disk is full, or the file system does not support unnamed files, the buffer stays
/// on the heap.
class DrawMemory {
 public:
  static constexpr std::size_t kOnHeap = std::size_t{1} << 22U;

  DrawMemory() = default;
  /// An empty buffer whose file, if needed, is in `folder`.
  explicit DrawMemory(std::filesystem::path folder) : folder_(std::move(folder)) {}
  DrawMemory(const DrawMemory&) = delete;
  DrawMemory& operator=(const DrawMemory&) = delete;
  DrawMemory(DrawMemory&& other) noexcept { swap(other); }
  DrawMemory& operator=(DrawMemory&& other) noexcept {
    swap(other);
    return *this;
  }
  ~DrawMemory();
  void swap(DrawMemory& other) noexcept;

  [[nodiscard]] std::byte* data() const { return data_; }
  [[nodiscard]] std::size_t capacity() const { return capacity_; }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] bool in_file() const { return file_ >= 0; }
  /// Sets the folder of the file that stores the buffer. The setting takes effect the next time the
  /// buffer grows.
  void keep_in(std::filesystem::path folder) { folder_ = std::move(folder); }
  /// Enlarges the buffer to at least `bytes` and keeps the content. Throws std::bad_alloc.
  void grow(std::size_t bytes);
  /// Waits until the file's content is on disk. Throws DrawsLost if the content cannot be written;
  /// the content is then invalid.
  void settle() const;
  /// Allows the system to page out the file's content until the next access. Concurrent reading is
  /// safe.
  void let_go() const;

 private:
  bool grow_file(std::size_t bytes);
  void grow_heap(std::size_t bytes);
  void free();

  std::filesystem::path folder_;
  std::byte* data_ = nullptr;
  std::size_t capacity_ = 0;
  int file_ = -1;
};

/// A sequence of numbers like std::vector that is stored in a DrawMemory.
template <class Number>
class DrawList {
  static_assert(std::is_trivially_copyable_v<Number>);

 public:
  using value_type = Number;
  using iterator = Number*;
  using const_iterator = const Number*;

  DrawList() = default;
  DrawList(std::initializer_list<Number> numbers) { append(numbers.begin(), numbers.end()); }
  DrawList(const DrawList& other) : memory_(other.memory_.folder()) {
    append(other.begin(), other.end());
  }
  DrawList(DrawList&& other) noexcept
      : memory_(std::move(other.memory_)), size_(std::exchange(other.size_, 0)) {}
  DrawList& operator=(DrawList other) noexcept {
    memory_.swap(other.memory_);
    std::swap(size_, other.size_);
    return *this;
  }
  ~DrawList() = default;

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] Number* data() { return numbers(); }
  [[nodiscard]] const Number* data() const { return numbers(); }
  [[nodiscard]] iterator begin() { return numbers(); }
  [[nodiscard]] iterator end() { return numbers() + size_; }
  [[nodiscard]] const_iterator begin() const { return numbers(); }
  [[nodiscard]] const_iterator end() const { return numbers() + size_; }
  [[nodiscard]] Number& operator[](std::size_t i) { return numbers()[i]; }
  [[nodiscard]] const Number& operator[](std::size_t i) const { return numbers()[i]; }
  [[nodiscard]] Number& back() { return numbers()[size_ - 1]; }
  [[nodiscard]] const Number& back() const { return numbers()[size_ - 1]; }

  /// Sets the folder of the file that stores long sequences (DrawMemory).
  void keep_in(const std::filesystem::path& folder) { memory_.keep_in(folder); }
  void settle() const { memory_.settle(); }
  void let_go() const { memory_.let_go(); }
  [[nodiscard]] bool in_file() const { return memory_.in_file(); }

  void reserve(std::size_t n) { memory_.grow(n * sizeof(Number)); }
  void clear() { size_ = 0; }
  void resize(std::size_t n, Number value = Number()) {
    make_room(n);
    if (n > size_) std::fill(numbers() + size_, numbers() + n, value);
    size_ = n;
  }
  void push_back(Number number) {
    make_room(size_ + 1);
    numbers()[size_++] = number;
  }
  /// Appends the numbers of another sequence.
  template <std::input_iterator It>
  void append(It first, It last) {
    const auto more = static_cast<std::size_t>(std::distance(first, last));
    make_room(size_ + more);
    std::copy(first, last, numbers() + size_);
    size_ += more;
  }
  template <std::input_iterator It>
  void assign(It first, It last) {
    clear();
    append(first, last);
  }
  void assign(std::size_t n, Number number) {
    clear();
    resize(n, number);
  }

  friend bool operator==(const DrawList& a, const DrawList& b) { return std::ranges::equal(a, b); }

 private:
  [[nodiscard]] Number* numbers() const { return reinterpret_cast<Number*>(memory_.data()); }
  void make_room(std::size_t n) {
    const std::size_t bytes = n * sizeof(Number), had = memory_.capacity();
    if (bytes > had) memory_.grow(std::max(bytes, had + had / 2));
  }

  DrawMemory memory_;
  std::size_t size_ = 0;
};

}  // namespace wheeltap::inference
