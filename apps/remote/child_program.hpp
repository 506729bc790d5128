// This program, run again as a process of its own.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace wheeltap::apps {

/// wheeltap ARGUMENTS in a process group of its own, so that a terminal's Ctrl-C does not reach it,
/// and killed where this process is. Standard input and output are /dev/null; what it says on
/// standard error is kept. It begins without what mpirun tells its ranks, and with `variables`,
/// "NAME=VALUE", in its environment.
class ChildProgram {
 public:
  /// Throws std::system_error where no process can be made.
  explicit ChildProgram(const std::vector<std::string>& arguments,
                        const std::vector<std::string>& variables = {});
  ChildProgram(ChildProgram&& other) noexcept;
  ChildProgram(const ChildProgram&) = delete;
  ChildProgram& operator=(const ChildProgram&) = delete;
  ChildProgram& operator=(ChildProgram&&) = delete;
  ~ChildProgram();  ///< kills it where it runs

  void send(int signal) const;
  /// The file descriptor that can be read when it says something or ends.
  [[nodiscard]] int descriptor() const { return pipe_; }
  /// Takes what it has said; its exit code once it has ended, or 128 + the signal that ended it.
  [[nodiscard]] std::optional<int> ended();
  /// The last line that it said, without "wheeltap: ".
  [[nodiscard]] std::string last_line() const;

 private:
  pid_t pid_ = -1;
  int pipe_ = -1;
  std::string said_;
};

}  // namespace wheeltap::apps
