// Emulators of a beam's natural frequencies, trained on tables of FE solutions, one table a damage
// count.
#pragma once

#include <map>
#include <memory>
#include <variant>

#include "emulator/anova.hpp"
#include "emulator/cubic_interpolant.hpp"
#include "emulator/gaussian_process.hpp"
#include "emulator/holdout.hpp"
#include "emulator/multilinear_interpolant.hpp"
#include "emulator/table_file.hpp"
#include "fem/reanalysis.hpp"
#include "identification/damage_case.hpp"
#include "identification/invalid_input.hpp"
#ifdef WHEELTAP_WITH_CGAL
#include "emulator/delaunay_interpolant.hpp"
#endif

namespace wheeltap::identification {

/// What identifies a beam to its tables: geometry, mesh, supports, material and section as numbers.
[[nodiscard]] std::string beam_fingerprint(const fem::Beam& beam);

/// How wrong an emulator is for one number of damages, from held-out runs.
struct EmulatorError {
  std::vector<emulator::HoldoutError> holdout;  ///< one a mode
  /// The variance of mode i's error at damages r_1 … r_k is scale[i] · Σ r_j / (1 - r_j): it grows
  /// with the damage, as the effect itself does. For a Gaussian process it is scale[i] times its
  /// own variance, scale >= 1.
  std::vector<double> scale;
  std::vector<emulator::StandardisedResiduals> standardised;  ///< by that variance, one a mode
  /// Leave-one-out RMSE, one a mode, where the emulator has it (Gaussian process); else empty.
  std::vector<double> leave_one_out;
};

/// An emulator for each number of damages 1 … max. The factors are location[1], reduction[1],
/// location[2] …; a location is an element's midpoint, and since the FE model damages whole
/// elements the emulator is always asked at the midpoint of the element that contains x. Damages
/// are put in order of location first, so damage i meets the i-th list of sites.
class FrequencyEmulator {
 public:
  struct TrainOptions {
    int threads = 1;
    std::uint64_t seed = 1;  ///< of the held-out runs
    std::filesystem::path journal_stem =
        {};  ///< runs are remembered in STEM.count_K; empty: nowhere
    std::function<void(int count, Eigen::Index done, Eigen::Index total)> progress = {};
    /// Runs made before, by `run_part`: nothing of the design is run again.
    const emulator::TableFile* runs = nullptr;
  };

  /// Runs the design of `spec` for 1 … max_count damages (1 and 2 with ANOVA) and measures the
  /// error on fresh runs. `kind` says where scattered designs lie. Throws std::invalid_argument
  /// where a design would pass 10 million runs, does not cover the priors, or `runs` lacks some;
  /// FileError for the user's own runs.
  static FrequencyEmulator train(const fem::Reanalysis& reanalysis, const EmulatorSpec& spec,
                                 const DefectKind& kind, int modes, const TrainOptions& options);
  /// Part `part` (0-based) of `parts` of the runs that `train` would make. Throws alike.
  static emulator::TableFile run_part(const fem::Reanalysis& reanalysis, const EmulatorSpec& spec,
                                      const DefectKind& kind, int modes, int part, int parts,
                                      const TrainOptions& options);
  /// Reads a table file made for this beam. Throws io::FileError, and std::invalid_argument
  /// where it holds too few counts or modes.
  static FrequencyEmulator load(const std::filesystem::path& path, const fem::Beam& beam,
                                int max_count, int modes);
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
  using Interpolant = std::variant<emulator::MultilinearInterpolant, emulator::CubicInterpolant,
                                   emulator::GaussianProcess
#ifdef WHEELTAP_WITH_CGAL
                                   ,
                                   emulator::DelaunayInterpolant
#endif
                                   >;

  explicit FrequencyEmulator(const fem::Beam& beam) : beam_(beam) {}
  [[nodiscard]] const emulator::Table& table(int count) const {
    return tables_[static_cast<std::size_t>(count - 1)];
  }
  [[nodiscard]] int tables() const {
    return static_cast<int>(tables_.size());
  }
  void add(emulator::Table table, int threads);
  /// For counts beyond the tables'. Needs tables for one and two, and the intact frequencies in the
  /// latter.
  void add_anova(emulator::Additive additive);
  void measure(const fem::Reanalysis& reanalysis, int count, Eigen::Index runs,
               const TrainOptions& options);
  [[nodiscard]] double midpoint(double location, const emulator::Factor& factor) const;
  void call(std::span<const fem::Damage> damages, std::span<double> out,
            std::span<double> variance) const;
  void call_table(int count, std::span<const double> x, std::span<double> out,
                  std::span<double> variance) const;
  [[nodiscard]] bool contains(std::span<const fem::Damage> damages) const;
  [[nodiscard]] const emulator::Factor& factor(int count, std::size_t i) const;

  fem::Beam beam_;
  int modes_ = 0;
  long trained_runs_ = 0, fresh_runs_ = 0;
  bool symmetrised_ = false;  ///< answers are means over a set of damages and its mirror image
  std::vector<emulator::Table> tables_;
  std::vector<std::shared_ptr<const Interpolant>> interpolants_;
  std::vector<EmulatorError> errors_;
  std::optional<emulator::Additive> additive_;
  std::shared_ptr<const emulator::AnovaEmulator> anova_;  ///< for counts beyond the tables'
};

}  // namespace wheeltap::identification
