#include "apps/runs/sid/sweep_journal.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "io/bytes.hpp"
#include "io/file_error.hpp"
#include "io/fingerprint.hpp"

namespace wheeltap::apps {
namespace {

using io::FileError;

constexpr std::string_view kMagic = "wheeltap-sweep 1 ";

[[noreturn]] void fail_journal(const std::filesystem::path& path, const std::string& reason) {
  throw FileError(FileError::Kind::unwritable, path, reason);
}

}  // namespace

SweepJournal::SweepJournal(std::filesystem::path path, std::string_view identity, bool resume)
    : path_(std::move(path)) {
  const std::string header = std::string(kMagic) + io::fingerprint(identity) + "\n";
  descriptor_ = ::open(path_.c_str(),
                       O_RDWR | O_CREAT | O_APPEND | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666);
  struct stat found {};
  if (descriptor_ < 0 || ::fstat(descriptor_, &found) != 0 || !S_ISREG(found.st_mode)) {
    const int error = descriptor_ < 0 ? errno : 0;
    if (descriptor_ >= 0) ::close(descriptor_);
    fail_journal(path_, error == 0 || error == ELOOP ? "is not a regular file"
                                                     : std::generic_category().message(error));
  }
  std::size_t end = 0;
  try {
    const std::string text = io::read_bytes(path_);
    const bool begun = header.starts_with(text);  // true if killed within the first line
    if (!begun && !text.starts_with(kMagic)) {
      fail_journal(
          path_,
          "exists already and is not the journal of a sweep, and Wheeltap does not overwrite it; "
          "remove it or choose another folder");
    }
    if (resume && !begun && !text.starts_with(header)) {
      throw FileError(FileError::Kind::mismatch, path_,
                      "is the journal of another sweep (its case, seed or options differ): omit "
                      "--resume to start a new one");
    }
    if (resume && !begun) end = header.size();
    for (std::size_t stop = 0; end > 0 && (stop = text.find('\n', end)) != std::string::npos;
         end = stop + 1) {
      const std::string_view line(text.data() + end, stop - end);
      const std::size_t blank = line.find(' ');
      if (blank == std::string_view::npos) break;
      const std::string_view json = line.substr(blank + 1);
      if (line.substr(0, blank) != io::fingerprint(json)) break;
      Report kept = Report::parse(json, nullptr, false);
      if (!kept.is_object() || !kept.contains("value") || !kept.contains("row")) break;
      rows_[kept["value"].dump()] = std::move(kept["row"]);
    }
    if (::ftruncate(descriptor_, static_cast<off_t>(end)) != 0) {
      fail_journal(path_, std::generic_category().message(errno));
    }
    if (end == 0) put(header);
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
}

SweepJournal::~SweepJournal() {
  ::close(descriptor_);
}

std::optional<Report> SweepJournal::find(const Report& value) const {
  const auto found = rows_.find(value.dump());
  return found == rows_.end() ? std::nullopt : std::optional(found->second);
}

void SweepJournal::append(const Report& value, const Report& row) {
  const std::string json = Report({{"value", value}, {"row", row}}).dump();
  put(io::fingerprint(json) + " " + json + "\n");
}

void SweepJournal::put(std::string_view line) const {
  while (!line.empty()) {
    const ssize_t written = ::write(descriptor_, line.data(), line.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0)
      fail_journal(path_, std::generic_category().message(written < 0 ? errno : ENOSPC));
    line.remove_prefix(static_cast<std::size_t>(written));
  }
  if (::fsync(descriptor_) != 0) fail_journal(path_, std::generic_category().message(errno));
}

void SweepJournal::remove() {
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

}  // namespace wheeltap::apps
