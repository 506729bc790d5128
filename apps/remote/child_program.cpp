#include "apps/remote/child_program.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/stop_signals.hpp"

namespace wheeltap::apps {
namespace {

constexpr std::size_t kMostSaid = 1 << 16;  // of which the last part is kept
constexpr int kNoProgram = 127;             // as the shell says it

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
                           std::vector<std::string> variables) {
  // All memory is taken before the fork: between it and exec there is no more than system calls.
  std::vector<std::string> words{"wheeltap"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv, environment;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const auto is_replaced = [&](std::string_view variable) {
    const std::string_view name = variable.substr(0, variable.find('=') + 1);
    return std::ranges::any_of(variables, [&](const auto& mine) { return mine.starts_with(name); });
  };
  for (char** variable = environ; *variable != nullptr; ++variable) {
    if (!is_of_mpirun(*variable) && !is_replaced(*variable)) environment.push_back(*variable);
  }
  for (std::string& mine : variables) environment.push_back(mine.data());
  environment.push_back(nullptr);
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) fail("a pipe");
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ < 0) {
    close(ends[0]);
    close(ends[1]);
    fail("a process");
  }
  if (pid_ == 0) {
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(kNoProgram);
    const int nothing = open("/dev/null", O_RDWR);
    dup2(nothing, STDIN_FILENO);
    dup2(nothing, STDOUT_FILENO);
    dup2(ends[1], STDERR_FILENO);
    for (const int number : base::kStopSignals) std::signal(number, SIG_DFL);
    for (const int number : {SIGPIPE, SIGXFSZ}) std::signal(number, SIG_DFL);
    execve("/proc/self/exe", argv.data(), environment.data());
    _exit(kNoProgram);
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
    waitpid(pid_, nullptr, 0);
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
  if (n < 0) return {};  // it runs, and says nothing
  int status = 0;
  if (waitpid(pid_, &status, 0) < 0) fail("waiting for a process");
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
