#include "apps/remote/child_program.hpp"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/start_program.hpp"

namespace wheeltap::apps {
namespace {

constexpr std::size_t kMostSaid = 1 << 16;  // bytes; only the end of longer output is kept

[[noreturn]] void fail(const char* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

bool is_of_mpirun(std::string_view variable) {
  for (const char* prefix : {"OMPI_", "PMIX_", "PMI_", "PRTE_", "MPI_", "HYDRA_"}) {
    if (variable.starts_with(prefix)) return true;
  }
  return false;
}

}  // namespace

ChildProgram::ChildProgram(const std::vector<std::string>& arguments,
                           const std::vector<std::string>& variables) {
  std::vector<std::string> words{"wheeltap"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  const auto is_replaced = [&](std::string_view variable) {
    const std::string_view name = variable.substr(0, variable.find('=') + 1);
    return std::ranges::any_of(variables, [&](const auto& mine) { return mine.starts_with(name); });
  };
  std::vector<std::string> environment = variables;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    if (!is_of_mpirun(*variable) && !is_replaced(*variable)) environment.emplace_back(*variable);
  }
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) fail("a pipe");
  const int nothing = open("/dev/null", O_RDWR | O_CLOEXEC);
  pid_ = base::start_program({.file = "/proc/self/exe",
                              .words = std::move(words),
                              .environment = std::move(environment),
                              .input = nothing,
                              .output = nothing,
                              .error = ends[1]});
  const int error = errno;
  close(nothing);
  if (pid_ < 0) {
    close(ends[0]);
    close(ends[1]);
    errno = error;
    fail("a process");
  }
  close(ends[1]);
  pipe_ = ends[0];
  fcntl(pipe_, F_SETFL, O_NONBLOCK);
}

ChildProgram::ChildProgram(ChildProgram&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)),
      pipe_(std::exchange(other.pipe_, -1)),
      said_(std::move(other.said_)) {}

ChildProgram::~ChildProgram() {
  if (pid_ > 0) {
    kill(pid_, SIGKILL);
    (void)base::wait_for(pid_);
  }
  if (pipe_ >= 0) close(pipe_);
}

void ChildProgram::send(int signal) const {
  if (pid_ > 0) kill(pid_, signal);
}

std::optional<int> ChildProgram::ended() {
  std::array<char, 4096> bytes{};
  ssize_t n = 0;
  while ((n = read(pipe_, bytes.data(), bytes.size())) > 0) {
    said_.append(bytes.data(), static_cast<std::size_t>(n));
    if (said_.size() > 2 * kMostSaid) said_.erase(0, said_.size() - kMostSaid);
  }
  if (n < 0) return {};  // the child is running and has printed nothing
  const int status = base::wait_for(pid_);
  if (status < 0) fail("waiting for a process");
  pid_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

std::string ChildProgram::last_line() const {
  std::string_view text = said_;
  while (text.ends_with('\n')) text.remove_suffix(1);
  text.remove_prefix(text.rfind('\n') + 1);  // npos + 1 = 0
  constexpr std::string_view kName = "wheeltap: ";
  if (text.starts_with(kName)) text.remove_prefix(kName.size());
  return std::string(text);
}

}  // namespace wheeltap::apps
