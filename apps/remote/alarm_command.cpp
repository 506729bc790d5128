#include "apps/remote/alarm_command.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <memory>

#include "base/start_program.hpp"

namespace wheeltap::apps {
namespace {

namespace fs = std::filesystem;

void replace_all(std::string& word, const std::string& what, const std::string& by) {
  for (auto at = word.find(what); at != std::string::npos; at = word.find(what, at + by.size()))
    word.replace(at, what.size(), by);
}

/// Waits until the process ends. Returns false after the time limit.
bool ends_in_time(pid_t pid, double seconds) {
  const auto handle = static_cast<int>(syscall(SYS_pidfd_open, pid, 0));
  if (handle < 0) return true;  // old system without pidfd: wait without a limit
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  bool ended = false;
  for (;;) {
    const double left =
        std::chrono::duration<double>(end - std::chrono::steady_clock::now()).count();
    pollfd watched{.fd = handle, .events = POLLIN, .revents = 0};
    const int ready =
        left > 0.0 ? poll(&watched, 1, static_cast<int>(std::min(1e9, std::ceil(1e3 * left)))) : 0;
    if (ready < 0 && errno == EINTR) continue;
    ended = ready > 0;
    break;
  }
  close(handle);
  return ended;
}

}  // namespace

std::string run_on_alarm(const AlarmCommand& command, const fs::path& summary,
                         const std::string& text) {
  std::vector<std::string> words = command.words;
  for (std::string& word : words) {
    replace_all(word, "{summary}", fs::absolute(summary).string());
    replace_all(word, "{case}", fs::absolute(command.folder).string());
  }
  if (words[0].find('/') != std::string::npos && fs::path(words[0]).is_relative())
    words[0] = fs::absolute(command.folder / words[0]).lexically_normal().string();
  const std::string name = "on_alarm: " + words[0];
  const std::unique_ptr<FILE, int (*)(FILE*)> input(std::tmpfile(), &std::fclose);
  if (!input || std::fwrite(text.data(), 1, text.size(), input.get()) != text.size() ||
      std::fflush(input.get()) != 0 || lseek(fileno(input.get()), 0, SEEK_SET) != 0)
    return name + ": cannot write the temporary file for its input: " + std::strerror(errno);
  const pid_t pid = base::start_program({.file = words[0].c_str(),
                                         .words = words,
                                         .directory = fs::absolute(command.folder).string(),
                                         .input = fileno(input.get()),
                                         .output = STDERR_FILENO,
                                         .error = STDERR_FILENO});
  if (pid < 0) return name + ": cannot start a process: " + std::strerror(errno);
  const bool ended = ends_in_time(pid, command.timeout_seconds);
  kill(-pid, SIGKILL);
  const int status = base::wait_for(pid);
  if (!ended) return name + ": did not end within the time limit, and was stopped";
  if (WIFEXITED(status) && WEXITSTATUS(status) == base::kProgramNotFound)
    return name + ": no such program";
  if (WIFEXITED(status) && WEXITSTATUS(status) != 0)
    return name + ": ended with exit code " + std::to_string(WEXITSTATUS(status));
  if (WIFSIGNALED(status)) return name + ": ended by signal " + std::to_string(WTERMSIG(status));
  return {};
}

}  // namespace wheeltap::apps
