// The design of a frequency emulator: training runs and interpolant.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "emulator/anova.hpp"
#include "emulator/multilinear_interpolant.hpp"

namespace wheeltap::identification {

/// The emulator section of a case: a design of training runs, or a file with a trained emulator.
struct EmulatorSpec {
  enum class Runs { grid, latin_hypercube, sobol, csv };

  /// File with a trained emulator, which replaces the design below
  std::optional<std::filesystem::path> table;
  Runs runs = Runs::grid;
  const emulator::InterpolantType* interpolant = &emulator::kMultilinear;
  std::vector<std::vector<int>>
      /// 0-based indices of the elements at the damage sites. List i is for damage i; the last list
      /// also applies to all further damages.
      sites;
  /// Levels of the reduction, ascending; space-filling design: lower and upper limit (empty: prior
  /// limits)
  std::vector<double> reductions;
  bool compliance = false;         ///< interpolate over 1/(1-r) instead of the reduction r
  std::optional<double> accuracy;  ///< relative error of a frequency at which grid refinement ends
  std::optional<emulator::Additive>
      /// Quantity in which ANOVA adds the effects of damages; empty: one table per damage count
      anova;
  std::vector<int>
      /// For space-filling designs: entry i is the number of FE runs for i + 1 damages. The last
      /// entry also applies to all larger damage counts
      design_runs;
  std::uint64_t design_seed = 1;           ///< seed of space-filling designs
  std::vector<std::filesystem::path> csv;  ///< user's training runs; file i: with i + 1 damages
  bool symmetrise = false;     ///< average predictions over damages and their mirror images
  bool emulator_error = true;  ///< add the measured emulator error to the noise
  bool exact = false;  ///< use the emulator for proposals only; the posterior uses the FE solution
  int holdout = 1000;  ///< number of holdout FE runs that measure the error

  /// Number of tables for 1 to `max_count` damages: one table per number; with ANOVA, at most two
  /// tables.
  [[nodiscard]] int tables(int max_count) const { return anova && max_count > 2 ? 2 : max_count; }
};

}  // namespace wheeltap::identification
