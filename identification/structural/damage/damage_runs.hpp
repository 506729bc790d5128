// Design and execution of the FE runs of the damaged beam that train an emulator.
#pragma once

#include <functional>
#include <utility>

#include "emulator/experiment.hpp"
#include "emulator/table.hpp"
#include "fem/beam/reanalysis.hpp"
#include "identification/emulation/emulator_spec.hpp"
#include "identification/emulation/outside_model.hpp"
#include "identification/structural/defects/defect_kind.hpp"

namespace wheeltap::identification {

struct RunOptions {
  int threads = 1;
  std::uint64_t seed = 1;                   ///< seed of the holdout runs
  std::filesystem::path journal_stem = {};  ///< each run is saved to STEM.count_K; empty: no file
  std::function<void(int count, Eigen::Index done, Eigen::Index total)> progress = {};
  /// Replaces the FE solution: computes the frequencies at a design point. An empty point means
  /// the intact beam.
  emulator::ModelFactory model = {};
  /// Results of `run_part`; if given, no new runs are made.
  const emulator::TableFile* runs = nullptr;
};

/// The damages at a design point (location_1 [m], reduction_1, location_2 …), sorted by location.
[[nodiscard]] std::vector<fem::Damage> sorted_damages(std::span<const double> point);

/// One entry per factor of `count` damages: true for a location, because frequencies oscillate
/// with the location; false for a reduction.
[[nodiscard]] std::vector<bool> waves(int count);

/// Computes the elastic frequencies [Hz] at a design point by the FE solution.
[[nodiscard]] emulator::ModelFactory fe_model(const fem::Reanalysis& reanalysis);

/// Computes the elastic frequencies [Hz] at a design point by an external model. The model has
/// inputs for the largest allowed number of damages (DamageProblemOptions::outside). Exceptions of
/// the model are rethrown.
[[nodiscard]] emulator::ModelFactory outside_model(OutsideModel& model, int max_count);

/// Returns `options.model` or, by default, the FE solution.
[[nodiscard]] emulator::ModelFactory model_of(const fem::Reanalysis& reanalysis,
                                              const RunOptions& options);

/// The first and the last element within the support of this location prior.
[[nodiscard]] std::pair<int, int> elements_of(const inference::Prior& location,
                                              const fem::Beam& beam);

/// The design of `spec` for `count` damages: a grid, or a space-filling design over the priors of
/// `kind`, with damages sorted by location, at midpoints of elements. Throws std::invalid_argument
/// for more than 10 million runs, and for a location prior that covers one element.
[[nodiscard]] emulator::Design damage_design(const fem::Beam& beam, const EmulatorSpec& spec,
                                             const DefectKind& kind, int count);

/// The table of training runs: new runs, previous runs (`options.runs`) or runs of the user
/// (`spec.csv`). If `spec.accuracy` is set, the accuracy determines the number of runs. Adds the
/// number of new runs to `made`. Throws std::invalid_argument. Throws io::FileError if the runs of
/// the user cannot be read or are invalid.
[[nodiscard]] emulator::Table run_table(const fem::Reanalysis& reanalysis, const EmulatorSpec& spec,
                                        const DefectKind& kind, int modes, int count,
                                        const RunOptions& options, long& made);

/// Divides the training runs into `parts` parts and makes the runs of part `part` (0-based). Throws
/// the exceptions of `run_table`.
[[nodiscard]] emulator::TableFile run_part(const fem::Reanalysis& reanalysis,
                                           const EmulatorSpec& spec, const DefectKind& kind,
                                           int modes, int part, int parts,
                                           const RunOptions& options);

}  // namespace wheeltap::identification
