#include "emulator/journal.hpp"

#include <cstring>
#include <iterator>
#include <optional>
#include <string>

#include "io/bytes.hpp"
#include "io/fingerprint.hpp"

namespace wheeltap::emulator {
namespace {

namespace fs = std::filesystem;
using Kind = io::FileError::Kind;

constexpr std::string_view kMagic = "wheeltap-journal 1 ";

template <class T>
void put(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

template <class T>
T get(std::string_view bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

constexpr std::chrono::seconds kToEnd{2};     // for a killed process to release its lock
constexpr std::chrono::seconds kToShare{60};  // for other processes to read or append

io::FileLock held_alone(const fs::path& path, std::chrono::seconds patience = kToEnd) {
  if (std::optional<io::FileLock> lock = io::FileLock::take(path, patience))
    return std::move(*lock);
  throw io::FileError(Kind::unwritable, path, "is in use by another run");
}

}  // namespace

Journal::Journal(fs::path path, std::string_view identity, std::size_t responses, Use use)
    : path_(std::move(path)) {
  const std::string header =
      std::string(kMagic) + io::fingerprint(identity) + " " + std::to_string(responses) + "\n";
  const std::size_t record =
      sizeof(std::int64_t) + responses * sizeof(double) + sizeof(io::fnv1a(""));
  std::string bytes;
  std::error_code error;
  const auto there = fs::symlink_status(path_, error);
  if (fs::is_directory(there)) throw io::FileError(Kind::unwritable, path_, "is a directory");
  if (fs::exists(there) && !fs::is_regular_file(there))
    throw io::FileError(Kind::unwritable, path_, "is not a regular file");
  // Creates a missing file before locking it, so that only one of two simultaneous runs gets the
  // lock. Processes that share the file hold the lock only while they open the file.
  if (!std::ofstream(path_, std::ios::binary | std::ios::app))
    throw io::FileError(Kind::unwritable, path_, "cannot be written");
  std::optional<io::FileLock> while_opening =
      held_alone(path_, use == Use::alone ? kToEnd : kToShare);
  if (use == Use::alone) lock_ = std::move(*while_opening);
  if (std::ifstream existing(path_, std::ios::binary); existing)
    bytes.assign(std::istreambuf_iterator<char>(existing), {});

  // If a process was killed while writing the first line, the file holds only a part of this line.
  // The journal then starts anew.
  const bool fresh = bytes.size() < header.size() && header.starts_with(bytes);
  if (!fresh && !bytes.starts_with(kMagic))
    throw io::FileError(Kind::foreign, path_, "is not a journal of runs");
  if (!fresh && !bytes.starts_with(header))
    throw io::FileError(Kind::mismatch, path_,
                        "is the journal of another experiment: remove it to start a new one");

  std::size_t end = header.size();
  for (; !fresh && end + record <= bytes.size(); end += record) {
    const std::string_view body(bytes.data() + end, record - sizeof(std::uint64_t));
    if (get<std::uint64_t>(bytes, end + body.size()) != io::fnv1a(body)) break;
    Entry entry{.run = get<std::int64_t>(body, 0), .response = std::vector<double>(responses)};
    std::memcpy(entry.response.data(), body.data() + sizeof entry.run, responses * sizeof(double));
    entries_.push_back(std::move(entry));
  }
  error.clear();
  // Removes an incomplete record. No process appends without the lock.
  if (fresh) end = 0;
  if (end < bytes.size()) fs::resize_file(path_, end, error);
  stream_.open(path_, std::ios::binary | std::ios::app);
  if (fresh) stream_ << header << std::flush;
  if (error || !stream_) throw io::FileError(Kind::unwritable, path_, "cannot be written");
}

void Journal::remove(const fs::path& path) {
  std::error_code error;
  const auto there = fs::symlink_status(path, error);
  if (!fs::exists(there)) return;
  const bool ours = fs::is_regular_file(there) && [&] {
    // Accepts an incomplete first line, from a process that was killed while writing.
    const std::string beginning = io::first_bytes(path, kMagic.size());
    return kMagic.starts_with(beginning);
  }();
  if (!ours)
    throw io::FileError(Kind::unwritable, path,
                        "is not a journal of runs and was not removed: choose another name");
  const io::FileLock lock = held_alone(path);
  fs::remove(path, error);
}

void Journal::append(std::int64_t run, std::span<const double> response) {
  std::string record;
  put(record, run);
  for (const double value : response) put(record, value);
  put(record, io::fnv1a(record));
  std::optional<io::FileLock> while_appending;
  if (!lock_) while_appending = held_alone(path_, kToShare);
  if (!stream_.write(record.data(), static_cast<std::streamsize>(record.size())).flush())
    throw io::FileError(Kind::unwritable, path_, "cannot be written (is the disk full?)");
}

}  // namespace wheeltap::emulator
