#include "base/start_program.hpp"

#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

#include <cerrno>
#include <csignal>

#include "base/stop_signals.hpp"

namespace wheeltap::base {
namespace {

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> out;
  for (std::string& text : texts) out.push_back(text.data());
  out.push_back(nullptr);
  return out;
}

}  // namespace

pid_t start_program(ProgramStart start) {
  // All memory is allocated before the fork, because only system calls are allowed between fork and
  // exec.
  const std::vector<char*> argv = pointers(start.words), own = pointers(start.environment);
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child != 0) {
    if (child > 0)
      setpgid(child, child);  // parent and child both call setpgid, because either may
                              // run first
    return child;
  }
  setpgid(0, 0);
#ifdef __linux__
  prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
  if (getppid() != parent || chdir(start.directory.c_str()) != 0) _exit(kProgramNotFound);
  dup2(start.input, STDIN_FILENO);
  dup2(start.output, STDOUT_FILENO);
  dup2(start.error, STDERR_FILENO);
  for (const int number : kStopSignals) std::signal(number, SIG_DFL);
  for (const int number : {SIGPIPE, SIGXFSZ}) std::signal(number, SIG_DFL);
  if (!start.environment.empty()) environ = const_cast<char**>(own.data());
  execvp(start.file, argv.data());
  _exit(errno == ENOENT ? kProgramNotFound : kNotRunnable);
}

int wait_for(pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return -1;
  }
  return status;
}

}  // namespace wheeltap::base
