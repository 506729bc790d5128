// Emulators of a beam's natural frequencies, trained on tables of FE solutions, one table per
// number of damages.
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
/// location[2] … Damages of the FE model cover whole elements, so locations are rounded to the
/// midpoint of their element. Damages are sorted by location; damage i uses the i-th list of sites.
class FrequencyEmulator {
 public:
  /// Makes the FE runs of `spec` for 1 … max_count damages (1 and 2 with ANOVA) and measures the
  /// error on holdout runs. The priors of `kind` give the ranges of the factors in space-filling
  /// designs. Throws std::invalid_argument if a design exceeds 10 million runs or does not cover
  /// the priors, or if `runs` is incomplete; throws FileError for the user's runs.
  static FrequencyEmulator train(const fem::Reanalysis& reanalysis, const EmulatorSpec& spec,
                                 const DefectKind& kind, int modes, const RunOptions& options);
  /// Reads a table file made for this beam. The interpolant of the table must be one of `types`.
  /// Throws io::FileError; throws std::invalid_argument if the file holds too few tables or modes.
  static FrequencyEmulator load(const std::filesystem::path& path, const fem::Beam& beam,
                                int max_count, int modes,
                                InterpolantTypes types = interpolant_types());
  /// Writes a table file with the standard attributes and `attributes`.
  void save(const std::filesystem::path& path, std::map<std::string, std::string> attributes) const;

  /// Computes the elastic frequencies [Hz] under `damages` (1 … max, sorted by location) and,
  /// unless `variance` is empty, the error variances [Hz²]. NaN if the ANOVA sum is not a valid
  /// frequency. Throws std::out_of_range outside the training domain.
  void evaluate(std::span<const fem::Damage> damages, std::span<double> out,
                std::span<double> variance = {}) const;

  [[nodiscard]] int max_count() const { return static_cast<int>(errors_.size()); }
  [[nodiscard]] int modes() const { return modes_; }
  /// Number of FE runs used for `count` damages.
  [[nodiscard]] Eigen::Index runs(int count) const;
  /// Number of FE runs made for training and for measuring the error; 0 for a table from a file.
  [[nodiscard]] long trained_runs() const { return trained_runs_; }
  [[nodiscard]] long fresh_runs() const { return fresh_runs_; }
  [[nodiscard]] const EmulatorError& error(int count) const {
    return errors_[static_cast<std::size_t>(count - 1)];
  }
  [[nodiscard]] const std::vector<emulator::HoldoutError>& holdout(int count) const {
    return error(count).holdout;
  }
  /// Description: "multilinear in r, 10 sites x 4 levels".
  [[nodiscard]] std::string describe(int count) const;
  /// True if an evaluation takes hundreds of microseconds instead of a few microseconds.
  [[nodiscard]] bool is_slow() const;

  /// A prior (location or severity) of a kind that extends outside the training domain, and the
  /// error message.
  struct Outside {
    InvalidInput::Part part;
    std::string message;
  };
  [[nodiscard]] std::optional<Outside> reaches_outside(const DefectKind& kind) const;

 private:
  /// The interpolant for predictions with a given number of damages.
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
  /// Adds emulators for larger numbers of damages than the tables cover, by ANOVA. Requires tables
  /// for one and for two damages. The table for two damages must contain the intact frequencies.
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
  bool symmetrised_ = false;  ///< predictions are means over damages and their mirror images
  std::vector<Part> parts_;
  std::vector<EmulatorError> errors_;
  std::optional<emulator::Additive> additive_;
  /// Emulator for numbers of damages above those of the tables
  std::shared_ptr<const emulator::AnovaEmulator> anova_;
};

}  // namespace wheeltap::identification
