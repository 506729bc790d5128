// An external program as predictor: one run per evaluation, with files for input and output.
#pragma once

#include "apps/cases/outside_case.hpp"

namespace wheeltap::apps {

/// Each run has a separate temporary directory as its current directory. The directory is removed
/// after a successful run. The file {in} contains the parameters: an object {"E": 2.1e11, …}, or
/// plain numbers, one per line. The program must write one number per output to the file {out}. The
/// file contains a JSON list, a JSON object with such a list as "predictions", or plain numbers
/// separated by blanks or line ends. In the command, {case} is the folder of the case. A program
/// name with a / is a path relative to that folder. No shell interprets the command. stdout.txt and
/// stderr.txt in the directory contain the output of the program. A timeout kills the run with all
/// processes that it started.
class CommandModel final : public identification::OutsideModel {
 public:
  CommandModel(CommandSpec spec, std::vector<std::string> names, int outputs);

  [[nodiscard]] int inputs() const override { return static_cast<int>(names_.size()); }
  [[nodiscard]] int outputs() const override { return outputs_; }
  void evaluate(std::span<const double> x, std::span<double> y) override;

 private:
  /// Runs the program once. Returns an error message, or an empty string if the run succeeded.
  std::string attempt(std::span<const double> x, std::span<double> y, bool last);
  [[nodiscard]] std::vector<std::string> words_in(const std::filesystem::path& directory) const;
  [[nodiscard]] std::string answer_in(const std::filesystem::path& file, std::span<double> y) const;

  CommandSpec spec_;
  std::vector<std::string> names_;
  int outputs_;
};

}  // namespace wheeltap::apps
