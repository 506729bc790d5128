// What a person at a terminal sees: results as text, progress as a bar.
#pragma once

#include <chrono>
#include <functional>
#include <iosfwd>
#include <string>

#include "apps/summary.hpp"

namespace wheeltap::apps {

/// The text of a finished damage run, from its summary.
void print_damage(std::ostream& out, const Report& summary, bool colour);

/// The text of a finished system-identification run, from its summary.
void print_sid(std::ostream& out, const Report& summary, bool colour);

/// An emulator's errors from `emulator_report`: per mode and with its warnings, or a line a count.
void print_emulator(std::ostream& out, const Report& emulator, bool colour, bool in_full);

/// The beam as text, `width` characters long: damage along it, the beam, its supports.
[[nodiscard]] std::string draw_beam(const Report& beam, const std::vector<double>& inclusion,
                                    int width);

/// True where standard output is a terminal and NO_COLOR is not set.
[[nodiscard]] bool colour_wanted();

/// One line on standard error that overwrites itself; silent unless that is a terminal.
class ProgressBar {
 public:
  explicit ProgressBar(bool quiet);
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  ~ProgressBar() { clear(); }

  /// `fraction` of `stage` is done; `detail` stands behind the bar.
  void show(const std::string& stage, double fraction, const std::string& detail);
  void clear();

 private:
  bool visible_;
  bool drawn_ = false;
  std::string stage_;
  std::chrono::steady_clock::time_point began_{}, last_{};
};

}  // namespace wheeltap::apps
