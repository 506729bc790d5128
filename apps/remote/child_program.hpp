// Execution of this program as a child process.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace wheeltap::apps {

/// Runs `wheeltap ARGUMENTS` as a child in a separate process group, so that Ctrl-C at a terminal
/// does not stop the child. The system kills the child if this process is killed. Standard input
/// and output of the child are /dev/null; this object stores its standard error. The environment of
/// the child has `variables` ("NAME=VALUE") and none of the variables that mpirun sets for ranks.
class ChildProgram {
 public:
  /// Starts the child. Throws std::system_error if the child cannot be started.
  explicit ChildProgram(const std::vector<std::string>& arguments,
                        const std::vector<std::string>& variables = {});
  ChildProgram(ChildProgram&& other) noexcept;
  ChildProgram(const ChildProgram&) = delete;
  ChildProgram& operator=(const ChildProgram&) = delete;
  ChildProgram& operator=(ChildProgram&&) = delete;
  ~ChildProgram();  ///< kills the child if it is running

  void send(int signal) const;
  /// The file descriptor that becomes readable when the child prints or ends.
  [[nodiscard]] int descriptor() const { return pipe_; }
  /// Reads the output of the child. After the end of the child, returns its exit code, or 128 + the
  /// number of the signal that ended it.
  [[nodiscard]] std::optional<int> ended();
  /// The last line of the child's standard error, without "wheeltap: ".
  [[nodiscard]] std::string last_line() const;
  /// Returns the text that `ended` has read from the child's standard error since the last call.
  [[nodiscard]] std::string take_output() { return std::exchange(said_, {}); }

 private:
  pid_t pid_ = -1;
  int pipe_ = -1;
  std::string said_;
};

}  // namespace wheeltap::apps
