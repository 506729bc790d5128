// Interpolants of a beam's natural frequencies over tables of FE solutions, one table a damage
// count.
#pragma once

#include <memory>
#include <variant>

#include "apps/damage_case.hpp"
#include "emulator/cubic_interpolant.hpp"
#include "emulator/holdout.hpp"
#include "emulator/multilinear_interpolant.hpp"
#include "emulator/table_file.hpp"
#include "fem/reanalysis.hpp"

namespace wheeltap::apps {

/// What identifies a beam to its tables: geometry, mesh, supports, material and section as numbers.
[[nodiscard]] std::string beam_fingerprint(const fem::Beam& beam);

/// An interpolant for each number of damages 1 … max. The factors are location[1], reduction[1],
/// location[2] …; a location is a site's element midpoint, and since the FE model damages whole
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
  };

  /// Runs the design of `spec` for 1 … max_count damages and measures the error on fresh runs.
  /// Throws std::invalid_argument where a design would pass 10 million runs.
  static FrequencyEmulator train(const fem::Reanalysis& reanalysis, const EmulatorSpec& spec,
                                 int max_count, int modes, const TrainOptions& options);
  /// Reads a table file made for this beam. Throws emulator::FileError, and std::invalid_argument
  /// where it holds too few counts or modes.
  static FrequencyEmulator load(const std::filesystem::path& path, const fem::Beam& beam,
                                int max_count, int modes);
  /// As a table file; `attributes` are added to its own.
  void save(const std::filesystem::path& path, std::map<std::string, std::string> attributes) const;

  /// The elastic frequencies [Hz] under `damages` (sorted by location, 1 … max of them). Throws
  /// std::out_of_range outside the tables' box.
  void evaluate(std::span<const fem::Damage> damages, std::span<double> out) const;

  [[nodiscard]] int max_count() const { return static_cast<int>(tables_.size()); }
  [[nodiscard]] int modes() const { return modes_; }
  [[nodiscard]] Eigen::Index runs(int count) const { return table(count).values.rows(); }
  /// Error per mode on held-out FE runs with `count` damages.
  [[nodiscard]] const std::vector<emulator::HoldoutError>& holdout(int count) const {
    return table(count).holdout;
  }
  /// Where a prior of `kind` reaches outside the box of a table that would serve it: which one
  /// ("location" or "reduction"), and a sentence naming both.
  struct Outside {
    std::string prior, message;
  };
  [[nodiscard]] std::optional<Outside> reaches_outside(const DefectKind& kind) const;

 private:
  using Interpolant = std::variant<emulator::MultilinearInterpolant, emulator::CubicInterpolant>;

  explicit FrequencyEmulator(const fem::Beam& beam) : beam_(beam) {}
  [[nodiscard]] const emulator::Table& table(int count) const {
    return tables_[static_cast<std::size_t>(count - 1)];
  }
  void add(emulator::Table table);
  [[nodiscard]] double midpoint(double location, const emulator::Factor& factor) const;

  fem::Beam beam_;
  int modes_ = 0;
  std::vector<emulator::Table> tables_;
  std::vector<Interpolant> interpolants_;
};

}  // namespace wheeltap::apps
