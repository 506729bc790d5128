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
/// Smallest probability of a model that the terminal text describes.
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

/// Returns the width of UTF-8 text in terminal columns.
[[nodiscard]] std::size_t columns(const std::string& text);
[[nodiscard]] std::string pad_right(const std::string& text, std::size_t width);
[[nodiscard]] std::string pad_left(const std::string& text, std::size_t width);
[[nodiscard]] std::string repeated(const std::string& glyph, int n);
/// Returns a bar with a resolution of an eighth of a character.
[[nodiscard]] std::string bar(double fraction, int width);
/// Returns x with `digits` significant digits; "-" if it is not finite.
[[nodiscard]] std::string number_or_dash(double x, int digits);

/// Prints the main result of a run in two sentences.
void print_answer(const Page& page, const Answer& said);
/// Prints one bar per model. If there are more than kMostBars models, only the kTopModels most
/// probable models get a bar.
inline constexpr std::size_t kMostBars = 12, kTopModels = 5;
void print_models(const Page& page, const std::vector<identification::ModelFinding>& models);
/// Prints the heading of results that are conditional on a model: "If cubic (56 %)", or only the
/// name of the model if the run has one model.
void print_condition(const Page& page, const identification::ModelFinding& model, bool several);
void print_evidence(const Page& page, const identification::Findings& findings);
/// Prints warnings, cost and convergence; `what` names the items that the models count.
void print_closing(const Page& page, const identification::Findings& findings,
                   const std::vector<std::string>& warnings, const std::string& what);

/// A model and its probability, estimated from the draws so far.
struct ModelSoFar {
  std::string name;
  double probability;
};
/// Returns the most probable models, most probable first. The list is empty before the first draw.
inline constexpr std::size_t kMostSoFar = 8;
[[nodiscard]] std::vector<ModelSoFar> models_so_far(const std::vector<double>& probabilities,
                                                    const std::vector<std::string>& names);
/// Names the two most probable models, for example "P(1 damage) = 0.79, P(2 damages) = 0.21".
[[nodiscard]] std::string probabilities_so_far(const std::vector<ModelSoFar>& models);

/// Selects the progress lines of a log. The log has one line at the start of a stage. A further
/// line follows when both a tenth of the stage and 5 s have passed, or when 30 s have passed.
class ProgressLines {
 public:
  /// Returns the next progress line, or an empty result if no line is due. `seconds` is the time
  /// since the start of the run. `left` is the remaining time; negative if unknown.
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

  /// Shows that `fraction` of `stage` is done, followed by `detail`. `left` is the remaining time
  /// of the whole run in seconds. Without `left`, the bar shows the remaining time of the stage,
  /// extrapolated from `fraction`. In JSON Lines output, the key "models" of each line contains
  /// `models`.
  void show(const std::string& stage, double fraction, const std::string& detail,
            std::optional<double> left = {}, const std::vector<ModelSoFar>& models = {});
  void clear();

 private:
  bool quiet_, terminal_;
  bool json_ = false;  // true if kProgressVariable is "json"
  bool drawn_ = false;
  std::string stage_;
  ProgressLines lines_;
  std::chrono::steady_clock::time_point created_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point began_{}, last_{};
};

}  // namespace wheeltap::apps
