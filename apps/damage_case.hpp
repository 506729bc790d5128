// A damage case, parsed once at the door: everything behind it works on these types.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "apps/case_file.hpp"
#include "emulator/anova.hpp"
#include "fem/beam.hpp"
#include "fem/defect.hpp"
#include "inference/prior.hpp"

namespace wheeltap::apps {

/// A defect kind that the case allows: so many of them, each somewhere, each so bad.
struct DefectKind {
  enum class Type { reduction, support };
  struct Rigid {};
  /// Reduction [-] of a damage under a prior, or stiffness [N/m, N·m/rad] of a support: rigid,
  /// known or under a prior.
  using Severity = std::variant<Rigid, double, inference::Prior>;
  struct True {
    double location;  ///< [m]
    double severity;  ///< reduction, or stiffness (∞: rigid)
  };

  Type type = Type::reduction;
  std::string name, plural;  ///< "damage", "damages"
  int min_count = 0;
  int max_count = 0;
  std::vector<double> weights;  ///< prior of min_count … max_count, sums to 1
  inference::Prior location;    ///< [m]
  Severity severity;
  bool rotation = false;    ///< a support that holds the rotation
  std::vector<True> truth;  ///< what simulations use, by increasing location
  Pointer where;            ///< of its block in the case, for complaints

  [[nodiscard]] const inference::Prior* severity_prior() const {
    return std::get_if<inference::Prior>(&severity);
  }
  /// "reduction" or "stiffness".
  [[nodiscard]] std::string severity_name() const {
    return type == Type::reduction ? "reduction" : "stiffness";
  }
  /// "" for a reduction.
  [[nodiscard]] std::string severity_unit() const {
    return type == Type::reduction ? "" : (rotation ? "N m/rad" : "N/m");
  }
};

/// What was measured: the lowest elastic natural frequencies.
struct FrequencyData {
  std::vector<double> frequencies_hz;  ///< NaN where a mode was not measured
  std::vector<double> sd_hz;           ///< empty where `cov` is inferred
  std::optional<double> cov;           ///< where the case gives a number
  std::optional<inference::Prior> cov_prior;
  double discrepancy_cov = 0.0;  ///< of what the beam model itself leaves out, beside the noise
  bool simulated = false;        ///< made from the case's truth
  std::string origin;            ///< in words, for the summary

  [[nodiscard]] int modes() const { return static_cast<int>(frequencies_hz.size()); }
  [[nodiscard]] int measured() const;
};

/// A simulation asked for by the case.
struct Simulation {
  int modes = 10;
  double cov = 0.0;  ///< noise: sd = cov · true frequency
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
  CaseFile file;
  std::string title;
  std::vector<std::string> notes;
  bool balance = false;  ///< sample models evenly and reweight
  fem::Beam beam;
  int rigid_body_modes = 0;  ///< of the intact beam; data and predictions leave them out
  FrequencyData data;        ///< empty frequencies where it is to be simulated
  std::optional<Simulation> simulation;
  std::vector<DefectKind> kinds;
  std::optional<EmulatorSpec> emulator;  ///< none: the FE solution itself

  /// Modes that predictions are needed for.
  [[nodiscard]] int modes() const {
    return data.modes() > 0 ? data.modes() : (simulation ? simulation->modes : 0);
  }
  [[nodiscard]] fem::Defects true_defects() const;
};

/// What a command needs from the case's data.
enum class Needs {
  structure,  ///< the beam only (`modes`, `table` where no data are given)
  data        ///< frequencies, or a truth to simulate them from
};

/// Reads, checks and parses. Throws Failure.
[[nodiscard]] DamageCase parse_damage_case(CaseFile file, Needs needs = Needs::data);

/// The elastic frequencies [Hz] of the beam under these defects, by the full solve, `modes` of
/// them.
[[nodiscard]] std::vector<double> elastic_frequencies(const fem::Beam& beam,
                                                      const fem::Defects& defects, int modes);

/// Frequencies of the true structure with Gaussian noise, sd = cov · true frequency. Throws Failure
/// where the case has no truth.
[[nodiscard]] FrequencyData simulate(const DamageCase& damage_case, std::uint64_t seed);

}  // namespace wheeltap::apps
