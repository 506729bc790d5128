// This program as a child process.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace wheeltap::apps {

/// Runs wheeltap ARGUMENTS in a separate process group, so that Ctrl-C at a terminal does not reach
/// it. The system kills it if this process is killed. Standard input and output are /dev/null; the
/// object stores its standard error. Its environment has `variables` ("NAME=VALUE") and none of the
/// variables that mpirun sets for ranks.
class ChildProgram {
 public:
  /// Throws std::system_error if the process cannot be started.
  explicit ChildProgram(const std::vector<std::string>& arguments,
                        const std::vector<std::string>& variables = {});
  ChildProgram(ChildProgram&& other) noexcept;
  ChildProgram(const ChildProgram&) = delete;
  ChildProgram& operator=(const ChildProgram&) = delete;
  ChildProgram& operator=(ChildProgram&&) = delete;
  ~ChildProgram();  ///< kills it if it is running

  void send(int signal) const;
  /// The file descriptor that becomes readable when it prints or ends.
  [[nodiscard]] int descriptor() const { return pipe_; }
  /// Reads its output; returns its exit code after its end, or 128 + the signal that ended it.
  [[nodiscard]] std::optional<int> ended();
  /// The last line of its standard error, without "wheeltap: ".
  [[nodiscard]] std::string last_line() const;
  /// Its standard error since the last call, as read by `ended`.
  [[nodiscard]] std::string take_output() { return std::exchange(said_, {}); }

 private:
  pid_t pid_ = -1;
  int pipe_ = -1;
  std::string said_;
};

}  // namespace wheeltap::apps
