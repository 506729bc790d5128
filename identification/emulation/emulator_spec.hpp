// What a case says of an emulator: which runs are made, and what joins them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "emulator/anova.hpp"
#include "emulator/multilinear_interpolant.hpp"

namespace wheeltap::identification {

/// The design of an emulator, or the file that holds one.
struct EmulatorSpec {
  enum class Runs { grid, latin_hypercube, sobol, csv };

  std::optional<std::filesystem::path> table;  ///< a file; the rest then comes from it
  Runs runs = Runs::grid;
  const emulator::InterpolantType* interpolant = &emulator::kMultilinear;
  std::vector<std::vector<int>>
      sites;  ///< 0-based elements; list i serves damage i, the last one all further ones
  std::vector<double> reductions;  ///< levels, increasing; of scattered runs the range, or empty
  bool compliance = false;         ///< interpolate in 1/(1-r), else in r
  std::optional<double>
      accuracy;  ///< grids gain sites and levels until errors are below so much of the frequencies
  std::optional<emulator::Additive>
      anova;  ///< in which more than two damages are summed from pairs; none: a table each
  std::vector<int> design_runs;   ///< scattered: entry i for i + 1 damages, the last beyond
  std::uint64_t design_seed = 1;  ///< of scattered designs
  std::vector<std::filesystem::path> csv;  ///< the user's own runs: file i has i + 1 damages
  bool symmetrise = false;     ///< answer with the mean over damages and their mirror images
  bool emulator_error = true;  ///< add its measured error to the noise
  bool exact = false;          ///< screen proposals only: the posterior is the FE solution's
  int holdout = 1000;          ///< fresh FE runs that measure it, a count

  /// Tables that serve up to `max_count` damages, one a count: two at most with ANOVA.
  [[nodiscard]] int tables(int max_count) const { return anova && max_count > 2 ? 2 : max_count; }
};

}  // namespace wheeltap::identification
