// Terminal output that all kinds of runs share: wrapped text, tables, bars, progress.
#pragma once

#include <chrono>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "apps/text/answer.hpp"
#include "identification/findings/findings.hpp"

namespace wheeltap::apps {

inline constexpr int kTerminalWidth = 76;
/// Models with less probability are not described.
inline constexpr double kWorthPrinting = 0.05;

/// True if standard output is a terminal and NO_COLOR is not set.
[[nodiscard]] bool colour_wanted();

/// An output stream for text, with or without colours.
struct Page {
  std::ostream& out;
  bool colour;

  [[nodiscard]] std::string bold(const std::string& text) const {
    return colour ? "\x1b[1m" + text + "\x1b[0m" : text;
  }
  [[nodiscard]] std::string warn(const std::string& text) const {
    return colour ? "\x1b[33m" + text + "\x1b[0m" : text;
  }
  /// Prints text with line breaks at spaces and the given indents.
  void wrapped(const std::string& text, const std::string& first, const std::string& further) const;
  /// Prints rows of cells; the first row is the heading. The first column is left-aligned, all
  /// others are right-aligned.
  void table(const std::vector<std::vector<std::string>>& rows) const;
  void heading(const std::string& text) const;
};

/// Returns the number of columns that UTF-8 text takes.
[[nodiscard]] std::size_t columns(const std::string& text);
[[nodiscard]] std::string pad_right(const std::string& text, std::size_t width);
[[nodiscard]] std::string pad_left(const std::string& text, std::size_t width);
[[nodiscard]] std::string repeated(const std::string& glyph, int n);
/// Returns a bar with a resolution of an eighth of a character.
[[nodiscard]] std::string bar(double fraction, int width);
/// Returns x with `digits` significant digits; "-" if it is not finite.
[[nodiscard]] std::string number_or_dash(double x, int digits);

/// Prints the answer in two sentences.
void print_answer(const Page& page, const Answer& said);
/// Prints one bar per model; of more than kMostBars models the kTopModels most probable.
inline constexpr std::size_t kMostBars = 12, kTopModels = 5;
void print_models(const Page& page, const std::vector<identification::ModelFinding>& models);
/// Prints the heading of numbers that are conditional on a model: "If cubic (56 %)", or its name if
/// it is the only model.
void print_condition(const Page& page, const identification::ModelFinding& model, bool several);
void print_evidence(const Page& page, const identification::Findings& findings);
/// Prints warnings, cost and convergence; `what` names the quantity that the models count.
void print_closing(const Page& page, const identification::Findings& findings,
                   const std::vector<std::string>& warnings, const std::string& what);

/// Returns the model probabilities of the draws so far: "P = 0.25 0.75"; of more than kMostListed
/// models the two most probable by name, "P = 0.97 linear + cubic, 0.02 linear". Empty before the
/// first draw.
inline constexpr std::size_t kMostListed = 6;
[[nodiscard]] std::string probabilities_so_far(const std::vector<double>& probabilities,
                                               const std::vector<std::string>& names);

/// Selects the progress lines of a log: one at the start of a stage; then one after at least a
/// tenth of the stage and 5 s, or after 30 s.
class ProgressLines {
 public:
  /// Returns a line, or none yet. `seconds`: since the start of the run; `left`: remaining,
  /// negative if not known.
  [[nodiscard]] std::optional<std::string> next(const std::string& stage, double fraction,
                                                double seconds, double left,
                                                const std::string& detail);

 private:
  std::string stage_;
  double fraction_ = 0.0, seconds_ = 0.0;
};

/// Shows the progress of a run on standard error: one line that overwrites itself on a terminal,
/// plain lines in a file or a pipe.
class ProgressBar {
 public:
  explicit ProgressBar(bool quiet);
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  ~ProgressBar() { clear(); }

  /// Shows that `fraction` of `stage` is done, followed by `detail`. `left`: remaining seconds of
  /// the whole run; without it the bar extrapolates the stage.
  void show(const std::string& stage, double fraction, const std::string& detail,
            std::optional<double> left = {});
  void clear();

 private:
  bool quiet_, terminal_;
  bool json_ = false;  // kProgressVariable
  bool drawn_ = false;
  std::string stage_;
  ProgressLines lines_;
  std::chrono::steady_clock::time_point created_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point began_{}, last_{};
};

}  // namespace wheeltap::apps
