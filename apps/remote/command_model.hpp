// A program that predicts: it is run once an answer, parameters in a file, predictions in a file.
#pragma once

#include "apps/cases/outside_case.hpp"

namespace wheeltap::apps {

/// Each run has a directory of its own, made where temporary files go and its current one, taken
/// away again unless the run failed. There {in} holds the parameters: an object {"E": 2.1e11, …},
/// or plain numbers, one a line. {out} is to hold as many numbers as there are outputs: a list, or
/// an object with such a list as "predictions"; or plain numbers with blanks or line ends between
/// them. {case} is the folder of the case, in which a program with a / in its name is looked for
/// too. No shell reads the words. What the program prints is kept in the directory, in stdout.txt
/// and stderr.txt. A run that takes too long is killed with all that it started.
class CommandModel final : public identification::OutsideModel {
 public:
  CommandModel(CommandSpec spec, std::vector<std::string> names, int outputs);

  [[nodiscard]] int inputs() const override { return static_cast<int>(names_.size()); }
  [[nodiscard]] int outputs() const override { return outputs_; }
  void evaluate(std::span<const double> x, std::span<double> y) override;

 private:
  /// What went wrong, or nothing.
  std::string attempt(std::span<const double> x, std::span<double> y, bool last);
  [[nodiscard]] std::vector<std::string> words_in(const std::filesystem::path& directory) const;
  [[nodiscard]] std::string answer_in(const std::filesystem::path& file, std::span<double> y) const;

  CommandSpec spec_;
  std::vector<std::string> names_;
  int outputs_;
};

}  // namespace wheeltap::apps
