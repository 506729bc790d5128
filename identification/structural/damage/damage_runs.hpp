// Runs of the FE model with damages: which are made to train an emulator, and the making of them.
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
  std::uint64_t seed = 1;                   ///< of the held-out runs
  std::filesystem::path journal_stem = {};  ///< runs are remembered in STEM.count_K; empty: nowhere
  std::function<void(int count, Eigen::Index done, Eigen::Index total)> progress = {};
  /// In place of the FE solution: frequencies at a run's point, or, at one without numbers, of the
  /// intact beam.
  emulator::ModelFactory model = {};
  /// Runs made before, by `run_part`: nothing of the design is run again.
  const emulator::TableFile* runs = nullptr;
};

/// A run's point is location_1 [m], reduction_1, location_2 …
[[nodiscard]] std::vector<fem::Damage> sorted_damages(std::span<const double> point);

/// Whether a frequency waves along each factor of `count` damages: along their places it does.
[[nodiscard]] std::vector<bool> waves(int count);

/// The elastic frequencies [Hz] at such a point.
[[nodiscard]] emulator::ModelFactory fe_model(const fem::Reanalysis& reanalysis);

/// Those of a model of someone else's, which takes as many damages as there may be at the most
/// (DamageProblemOptions::outside). Whatever it throws, passes.
[[nodiscard]] emulator::ModelFactory outside_model(OutsideModel& model, int max_count);

/// `options.model`, or the FE solution where there is none.
[[nodiscard]] emulator::ModelFactory model_of(const fem::Reanalysis& reanalysis,
                                              const RunOptions& options);

/// The first and the last element that a prior gives room to.
[[nodiscard]] std::pair<int, int> elements_of(const inference::Prior& location,
                                              const fem::Beam& beam);

/// The runs with `count` damages that `spec` asks for: a grid, or points scattered over the priors
/// of `kind` with damages in order of location, at midpoints, none twice. Throws
/// std::invalid_argument for more than 10 million runs, and a place prior of one element.
[[nodiscard]] emulator::Design damage_design(const fem::Beam& beam, const EmulatorSpec& spec,
                                             const DefectKind& kind, int count);

/// The table of these runs: made now, or before (`options.runs`), or the user's own (`spec.csv`),
/// or as many as an accuracy needs. Adds those made now to `made`. Throws std::invalid_argument,
/// and io::FileError for the user's own.
[[nodiscard]] emulator::Table run_table(const fem::Reanalysis& reanalysis, const EmulatorSpec& spec,
                                        const DefectKind& kind, int modes, int count,
                                        const RunOptions& options, long& made);

/// Part `part` (0-based) of `parts` of all runs that training makes. Throws alike.
[[nodiscard]] emulator::TableFile run_part(const fem::Reanalysis& reanalysis,
                                           const EmulatorSpec& spec, const DefectKind& kind,
                                           int modes, int part, int parts,
                                           const RunOptions& options);

}  // namespace wheeltap::identification
