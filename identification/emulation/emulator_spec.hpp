// The design of a frequency emulator: training runs and interpolant.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "emulator/anova.hpp"
#include "emulator/multilinear_interpolant.hpp"

namespace wheeltap::identification {

/// The emulator section of a case: a design, or a file that holds a trained emulator.
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
  /// Increasing levels of the reduction. For scattered runs: range of the reduction, or empty
  std::vector<double> reductions;
  bool compliance = false;         ///< interpolate in 1/(1-r) instead of r
  std::optional<double> accuracy;  ///< largest relative error at which grid refinement ends
  std::optional<emulator::Additive>
      /// Quantity in which ANOVA adds the effects of damages; empty: no ANOVA, one table per count
      anova;
  std::vector<int>
      /// For scattered designs: entry i is the number of runs for i + 1 damages. The last
      /// entry also applies to all larger counts
      design_runs;
  std::uint64_t design_seed = 1;           ///< seed of scattered designs
  std::vector<std::filesystem::path> csv;  ///< runs of the user: file i has runs with i + 1 damages
  bool symmetrise = false;     ///< average predictions over damages and their mirror images
  bool emulator_error = true;  ///< add the measured emulator error to the noise
  bool exact = false;  ///< use the emulator for proposals only; the posterior uses the FE solution
  int holdout = 1000;  ///< number of holdout FE runs that measure the error

  /// Number of tables for up to `max_count` damages: one per count, or at most two with ANOVA.
  [[nodiscard]] int tables(int max_count) const { return anova && max_count > 2 ? 2 : max_count; }
};

}  // namespace wheeltap::identification
