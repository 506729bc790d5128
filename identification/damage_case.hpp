// What is asked of a damaged beam: the intact beam, the measured frequencies, what may be wrong
// with it, and what predicts.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "emulator/anova.hpp"
#include "fem/beam.hpp"
#include "fem/defect.hpp"
#include "identification/defect_kind.hpp"
#include "identification/noise_model.hpp"

namespace wheeltap::identification {

/// A simulation asked for by the case.
struct Simulation {
  int modes = 10;
  double cv = 0.0;  ///< noise: sd = cv · true frequency
  std::uint64_t seed = 1;
};

/// The design of an emulator, or the file that holds one.
struct EmulatorSpec {
  enum class Runs { grid, latin_hypercube, sobol, csv };
  enum class Rule { multilinear, cubic, monotone_cubic, gaussian_process, delaunay };

  std::optional<std::filesystem::path> table;  ///< a file; the rest then comes from it
  Runs runs = Runs::grid;
  Rule rule = Rule::multilinear;
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
};

/// "multilinear", "cubic", "monotone-cubic", "gaussian-process", "delaunay".
[[nodiscard]] std::string rule_name(EmulatorSpec::Rule rule);
/// Inverse of `rule_name`. Throws std::invalid_argument for another text.
[[nodiscard]] EmulatorSpec::Rule rule_named(const std::string& text);

struct DamageCase {
  std::string title = {};
  bool balance = false;  ///< sample models evenly and reweight
  fem::Beam beam = {};
  int rigid_body_modes = 0;  ///< of the intact beam; data and predictions leave them out
  FrequencyData data = {};   ///< empty frequencies where it is to be simulated
  std::optional<Simulation> simulation = {};
  std::vector<DefectKind> kinds = {};
  std::optional<EmulatorSpec> emulator = {};  ///< none: the FE solution itself

  /// Modes that predictions are needed for.
  [[nodiscard]] int modes() const {
    return data.modes() > 0 ? data.modes() : (simulation ? simulation->modes : 0);
  }
  [[nodiscard]] fem::Defects true_defects() const;
};

/// Degrees of freedom that rigid supports leave.
[[nodiscard]] int free_degrees_of_freedom(const fem::Beam& beam);
/// Motions of the intact beam that cost no energy.
[[nodiscard]] int rigid_body_modes(const fem::Beam& beam);

/// Fills in what follows from the rest (rigid-body modes, equal weights of counts where none are
/// given) and checks that a run is possible. Throws InvalidInput.
void complete(DamageCase& damage_case);

/// The elastic frequencies [Hz] of the beam under these defects, by the full solve, `modes` of
/// them.
[[nodiscard]] std::vector<double> elastic_frequencies(const fem::Beam& beam,
                                                      const fem::Defects& defects, int modes);

/// Frequencies of the true structure with Gaussian noise, sd = cv · true frequency. Throws
/// InvalidInput where the case has no truth, or no number for the noise.
[[nodiscard]] FrequencyData simulate(const DamageCase& damage_case, std::uint64_t seed);

}  // namespace wheeltap::identification
