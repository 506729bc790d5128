#include "io/read_apart.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

#include <array>
#include <cerrno>
#include <cmath>
#include <concepts>
#include <csignal>
#include <fstream>
#include <new>
#include <optional>
#include <stdexcept>
#include <type_traits>

#include "base/start_program.hpp"
#include "base/stop_signals.hpp"

namespace wheeltap::io {
namespace {

enum class Outcome : char { bytes, refused, no_memory, beyond_bound, failed };

struct Refusal {
  FileError::Kind kind = FileError::Kind::corrupt;
  std::string path, reason;
  Place place;
};

template <class Parcel, class Of>
requires std::same_as<std::remove_const_t<Of>, Refusal>
void carry(Parcel& parcel, Of& refusal) {
  parcel(refusal.kind, refusal.path, refusal.reason, refusal.place.line, refusal.place.sample,
         refusal.place.column, refusal.place.header);
}

void write_all(int to, const std::string& bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t n = ::write(to, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno != EINTR) _exit(1);
    if (n > 0) done += static_cast<std::size_t>(n);
  }
}

/// Limits the memory of this process to its present memory plus `bytes`. Returns false if the limit
/// cannot be set, or if a lower limit already exists.
bool bound_memory(double bytes) {
  double pages = 0.0;
  rlimit now{};
  if (!(std::ifstream("/proc/self/statm") >> pages) || getrlimit(RLIMIT_AS, &now) != 0)
    return false;
  const double most = pages * static_cast<double>(sysconf(_SC_PAGESIZE)) + bytes;
  if (now.rlim_cur != RLIM_INFINITY && static_cast<double>(now.rlim_cur) <= most) return false;
  now.rlim_cur = static_cast<rlim_t>(most);
  return setrlimit(RLIMIT_AS, &now) == 0;
}

/// Resource limits of a child process.
struct Bounds {
  double seconds, bytes;
};

/// The code of the child process. It calls no destructor and flushes no buffer of the
/// parent.
[[noreturn]] void in_child(int to, const std::optional<Bounds>& bounds,
                           const std::function<std::string()>& work) {
#ifdef __linux__
  prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
  // Ignore the signals that stop the parent, because the child ends with the parent anyway.
  for (const int signal : base::kStopSignals) std::signal(signal, SIG_IGN);
  for (const int signal : {SIGPIPE, SIGXCPU}) std::signal(signal, SIG_DFL);
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  if (bounds) {
    const auto most = static_cast<rlim_t>(std::ceil(bounds->seconds));
    const rlimit time{most, most + 1};
    setrlimit(RLIMIT_CPU, &time);
  }
  if (const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC); nowhere >= 0) {
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
  }
  const bool bounded = bounds && bound_memory(bounds->bytes);
  Outcome outcome = Outcome::bytes;
  std::string bytes;
  try {
    bytes = work();
  } catch (const FileError& error) {
    outcome = Outcome::refused;
    base::Packer parcel;
    parcel(Refusal{error.kind(), error.path().string(), error.reason(), error.place()});
    bytes = std::move(parcel).bytes();
  } catch (const std::bad_alloc&) {
    outcome = bounded ? Outcome::beyond_bound : Outcome::no_memory;
  } catch (const std::exception& error) {
    outcome = Outcome::failed;
    bytes = error.what();
  }
  write_all(to, std::string(1, static_cast<char>(outcome)));
  write_all(to, bytes);
  _exit(0);
}

std::string read_all(int from) {
  std::string out;
  std::array<char, 1 << 16> buffer;
  for (;;) {
    const ssize_t n = ::read(from, buffer.data(), buffer.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return out;
    out.append(buffer.data(), static_cast<std::size_t>(n));
  }
}

/// The result of a child process.
struct Ended {
  int signal = 0;      ///< signal that terminated the child
  bool whole = false;  ///< true if the child completed
  Outcome outcome = Outcome::failed;
  std::string bytes;
};

/// Runs a function in a child process. Returns std::nullopt if the system cannot start a child.
std::optional<Ended> apart(const std::optional<Bounds>& bounds,
                           const std::function<std::string()>& work) {
  int ends[2];
  if (pipe(ends) != 0) return {};
  for (const int end : ends) fcntl(end, F_SETFD, FD_CLOEXEC);
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    in_child(ends[1], bounds, work);
  }
  close(ends[1]);
  if (child < 0) {
    close(ends[0]);
    return {};
  }
  Ended ended{.bytes = read_all(ends[0])};
  close(ends[0]);
  const int status = base::wait_for(child);
  ended.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  if (ended.signal == SIGKILL)
    throw std::bad_alloc();  // the system killed the child because
                             // memory was exhausted
  ended.whole = ended.signal == 0 && WEXITSTATUS(status) == 0 && !ended.bytes.empty();
  if (!ended.whole) return ended;
  ended.outcome = static_cast<Outcome>(ended.bytes[0]);
  ended.bytes.erase(0, 1);
  if (ended.outcome == Outcome::no_memory) throw std::bad_alloc();
  if (ended.outcome == Outcome::failed) throw std::runtime_error(ended.bytes);
  if (ended.outcome == Outcome::refused) {
    Refusal refusal;
    base::Unpacker parcel(ended.bytes);
    parcel(refusal);
    throw FileError(refusal.kind, refusal.path, refusal.place, refusal.reason);
  }
  return ended;
}

}  // namespace

double most_seconds(std::uintmax_t bytes) {
  constexpr double kLeast = 3.0, kBytesASecond = 2e6;
  return kLeast + static_cast<double>(bytes) / kBytesASecond;
}

double most_bytes(std::uintmax_t bytes) {
  constexpr double kLeast = 1073741824.0, kOfOne = 100.0;
  return kLeast + kOfOne * static_cast<double>(bytes);
}

std::string read_apart(const std::filesystem::path& path, const std::function<std::string()>& read,
                       double seconds) {
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
  return read();  // fuzzing build: a fuzzer can observe only its own process
#endif
  std::error_code no_size;
  const std::uintmax_t size = std::filesystem::file_size(path, no_size);
  if (!(seconds > 0.0)) seconds = most_seconds(no_size ? 0 : size);
  const double memory = most_bytes(no_size ? 0 : size);
  std::optional<Ended> ended = apart(Bounds{seconds, memory}, read);
  if (!ended) return read();
  if (ended->signal == SIGXCPU)
    throw FileError(FileError::Kind::corrupt, path,
                    "probably corrupt: " + std::to_string(static_cast<int>(seconds)) +
                        " s of processor time were not enough to read it");
  if (!ended->whole)
    throw FileError(FileError::Kind::corrupt, path,
                    "probably corrupt: the library that reads such files crashed");
  if (ended->outcome == Outcome::beyond_bound)
    throw FileError(FileError::Kind::corrupt, path,
                    "probably corrupt: " + std::to_string(std::llround(memory / 1048576.0)) +
                        " MB of memory were not enough to read it (if the file is valid and only "
                        "strongly compressed, store it without compression)");
  return std::move(ended->bytes);
}

bool write_apart(const std::filesystem::path& path, const std::function<void()>& write) {
  try {
    const std::optional<Ended> ended = apart({}, [&] {
      write();
      return std::string();
    });
    if (ended && !ended->whole)
      throw FileError(FileError::Kind::unwritable, path,
                      "the library that writes such files crashed");
    return ended.has_value();
  } catch (const std::bad_alloc&) {
    throw FileError(FileError::Kind::unwritable, path,
                    "there is not enough memory to write it, or the writing process was killed");
  }
}

}  // namespace wheeltap::io
