// What a person at a terminal sees, whatever the run was about: text in columns, tables, bars.
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

/// True where standard output is a terminal and NO_COLOR is not set.
[[nodiscard]] bool colour_wanted();

/// Where text goes, and whether it may be coloured.
struct Page {
  std::ostream& out;
  bool colour;

  [[nodiscard]] std::string bold(const std::string& text) const {
    return colour ? "\x1b[1m" + text + "\x1b[0m" : text;
  }
  [[nodiscard]] std::string warn(const std::string& text) const {
    return colour ? "\x1b[33m" + text + "\x1b[0m" : text;
  }
  /// Text broken at spaces, further lines indented.
  void wrapped(const std::string& text, const std::string& first, const std::string& further) const;
  /// Rows of cells, the first one their heading; the first column left-aligned, all others
  /// right-aligned.
  void table(const std::vector<std::vector<std::string>>& rows) const;
  void heading(const std::string& text) const;
};

/// Columns that UTF-8 text takes.
[[nodiscard]] std::size_t columns(const std::string& text);
[[nodiscard]] std::string pad_right(const std::string& text, std::size_t width);
[[nodiscard]] std::string pad_left(const std::string& text, std::size_t width);
[[nodiscard]] std::string repeated(const std::string& glyph, int n);
/// A bar of eighths of a character.
[[nodiscard]] std::string bar(double fraction, int width);
/// `digits` significant ones; "-" for what is not finite.
[[nodiscard]] std::string number_or_dash(double x, int digits);

/// The answer in two sentences, before any number.
void print_answer(const Page& page, const Answer& said);
/// One bar a model; of more than kMostBars the kTopModels most probable.
inline constexpr std::size_t kMostBars = 12, kTopModels = 5;
void print_models(const Page& page, const std::vector<identification::ModelFinding>& models);
/// What is said below holds under this model: "If cubic (56 %)", or its name where it is the only
/// one.
void print_condition(const Page& page, const identification::ModelFinding& model, bool several);
void print_evidence(const Page& page, const identification::Findings& findings);
/// Warnings, cost and convergence; `what` the models count.
void print_closing(const Page& page, const identification::Findings& findings,
                   const std::vector<std::string>& warnings, const std::string& what);

/// What a run's draws say of its models so far: "P = 0.25 0.75"; of more than kMostListed models
/// the two most probable by name, "P = 0.97 linear + cubic, 0.02 linear". Nothing before any draw.
inline constexpr std::size_t kMostListed = 6;
[[nodiscard]] std::string probabilities_so_far(const std::vector<double>& probabilities,
                                               const std::vector<std::string>& names);

/// Which lines a log gets of a run: one a stage, and further ones at least a tenth of the stage and
/// five seconds apart, or half a minute.
class ProgressLines {
 public:
  /// A line, or none yet. `seconds` since the run began, `left` of it: negative where not known.
  [[nodiscard]] std::optional<std::string> next(const std::string& stage, double fraction,
                                                double seconds, double left,
                                                const std::string& detail);

 private:
  std::string stage_;
  double fraction_ = 0.0, seconds_ = 0.0;
};

/// How far a run is, on standard error: a line that overwrites itself on a terminal, plain lines in
/// a file or a pipe.
class ProgressBar {
 public:
  explicit ProgressBar(bool quiet);
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  ~ProgressBar() { clear(); }

  /// `fraction` of `stage` is done; `detail` stands behind the bar. `left` are the seconds left of
  /// the whole run, where the caller knows; the bar else extrapolates the stage.
  void show(const std::string& stage, double fraction, const std::string& detail,
            std::optional<double> left = {});
  void clear();

 private:
  bool quiet_, terminal_;
  bool drawn_ = false;
  std::string stage_;
  ProgressLines lines_;
  std::chrono::steady_clock::time_point created_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point began_{}, last_{};
};

}  // namespace wheeltap::apps
