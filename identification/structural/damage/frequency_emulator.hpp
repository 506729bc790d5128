// Emulators of a beam's natural frequencies, trained on tables of FE solutions, one table a damage
// count.
#pragma once

#include <map>
#include <memory>
#include <optional>

#include "identification/emulation/frequency_tables.hpp"
#include "identification/emulation/interpolants.hpp"
#include "identification/invalid_input.hpp"
#include "identification/structural/damage/damage_runs.hpp"

namespace wheeltap::identification {

/// An emulator for each number of damages 1 … max. The factors are location[1], reduction[1],
/// location[2] …; a location is an element's midpoint, and since the FE model damages whole
/// elements the emulator is always asked at the midpoint of the element that contains x. Damages
/// are put in order of location first, so damage i meets the i-th list of sites.
class FrequencyEmulator {
 public:
  /// Runs the design of `spec` for 1 … max_count damages (1 and 2 with ANOVA) and measures the
  /// error on fresh runs. `kind` says where scattered designs lie. Throws std::invalid_argument
  /// where a design would pass 10 million runs, does not cover the priors, or `runs` lacks some;
  /// FileError for the user's own runs.
  static FrequencyEmulator train(const fem::Reanalysis& reanalysis, const EmulatorSpec& spec,
                                 const DefectKind& kind, int modes, const RunOptions& options);
  /// Reads a table file made for this beam, with one of `types`. Throws io::FileError, and
  /// std::invalid_argument where it holds too few counts or modes.
  static FrequencyEmulator load(const std::filesystem::path& path, const fem::Beam& beam,
                                int max_count, int modes,
                                InterpolantTypes types = interpolant_types());
  /// As a table file; `attributes` are added to its own.
  void save(const std::filesystem::path& path, std::map<std::string, std::string> attributes) const;

  /// The elastic frequencies [Hz] under `damages` (sorted by location, 1 … max of them) and, where
  /// asked, the variances [Hz²] of the emulator's error. NaN where ANOVA's sum is no frequency.
  /// Throws std::out_of_range outside the tables' box.
  void evaluate(std::span<const fem::Damage> damages, std::span<double> out,
                std::span<double> variance = {}) const;

  [[nodiscard]] int max_count() const { return static_cast<int>(errors_.size()); }
  [[nodiscard]] int modes() const { return modes_; }
  /// FE runs behind the answers for `count` damages.
  [[nodiscard]] Eigen::Index runs(int count) const;
  /// FE runs made here and now, for training and for measuring the error: none by a table read.
  [[nodiscard]] long trained_runs() const { return trained_runs_; }
  [[nodiscard]] long fresh_runs() const { return fresh_runs_; }
  [[nodiscard]] const EmulatorError& error(int count) const {
    return errors_[static_cast<std::size_t>(count - 1)];
  }
  [[nodiscard]] const std::vector<emulator::HoldoutError>& holdout(int count) const {
    return error(count).holdout;
  }
  /// The whole in words: "multilinear in the multiplier, 10 sites x 4 levels".
  [[nodiscard]] std::string describe(int count) const;
  /// Evaluations cost hundreds of microseconds rather than a few.
  [[nodiscard]] bool is_slow() const;

  /// Where a prior of `kind` reaches outside the box of a table that would serve it: which one
  /// (location or severity), and a sentence naming both.
  struct Outside {
    InvalidInput::Part part;
    std::string message;
  };
  [[nodiscard]] std::optional<Outside> reaches_outside(const DefectKind& kind) const;

 private:
  /// What answers for one count.
  struct Part {
    const emulator::InterpolantType* type;
    emulator::Table table;
    std::shared_ptr<const emulator::Interpolant> interpolant;
  };

  explicit FrequencyEmulator(const fem::Beam& beam) : beam_(beam) {}
  [[nodiscard]] const Part& part(int count) const {
    return parts_[static_cast<std::size_t>(count - 1)];
  }
  [[nodiscard]] int tables() const { return static_cast<int>(parts_.size()); }
  void add(const emulator::InterpolantType& type, emulator::Table table, int threads);
  /// For counts beyond the tables'. Needs tables for one and two, and the intact frequencies in the
  /// latter.
  void add_anova(emulator::Additive additive);
  void measure(const fem::Reanalysis& reanalysis, int count, Eigen::Index runs,
               const RunOptions& options);
  [[nodiscard]] double midpoint(double location, const emulator::Factor& factor) const;
  void call(std::span<const fem::Damage> damages, std::span<double> out,
            std::span<double> variance) const;
  [[nodiscard]] bool contains(std::span<const fem::Damage> damages) const;
  [[nodiscard]] const emulator::Factor& factor(int count, std::size_t i) const;

  fem::Beam beam_;
  int modes_ = 0;
  long trained_runs_ = 0, fresh_runs_ = 0;
  bool symmetrised_ = false;  ///< answers are means over a set of damages and its mirror image
  std::vector<Part> parts_;
  std::vector<EmulatorError> errors_;
  std::optional<emulator::Additive> additive_;
  std::shared_ptr<const emulator::AnovaEmulator> anova_;  ///< for counts beyond the tables'
};

}  // namespace wheeltap::identification
