// What a run says of one random case, beside its truth: a line of a file.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "inference/options.hpp"
#include "random_case.hpp"

namespace wheeltap::coverage {

struct Row {
  int number = 0;
  std::string family = {};
  std::vector<std::string> kinds = {};  ///< their types
  std::vector<int> most = {};           ///< of each kind
  std::vector<int> truth = {};          ///< how many of each there are
  double cv = 0.0;
  int modes = 0;

  struct Model {
    std::vector<int> counts;
    double probability = 0.0;
  };
  std::vector<Model> models = {};
  bool converged = false;
  std::vector<std::string> why_not = {};   ///< of the verdict, in words
  std::vector<std::string> warnings = {};  ///< what else the findings told of

  /// Of a function g of the state, P(g < g_true) + U P(g = g_true) by the draws, U uniform: uniform
  /// where the posterior is calibrated, ties or none (Talts et al. 2018; Modrák et al. 2023 for
  /// the log likelihood). By name; several where there are several kinds.
  std::map<std::string, std::vector<double>> ranks = {};
  /// ln p(data | truth) less the largest of any draw: well above 0 where the draws missed a mode.
  double truth_above_draws = 0.0;
  double likelihood_calls = 0.0, seconds = 0.0;

  [[nodiscard]] double probability_of_truth() const;
  /// Not converged, or something that the findings warn of.
  [[nodiscard]] bool warned() const { return !converged || !warnings.empty(); }
  [[nodiscard]] std::string to_line() const;                    ///< JSON
  [[nodiscard]] static Row from_line(const std::string& line);  ///< throws what the parser throws
};

/// Runs the engine on the case, on one thread and with a seed of the case's own.
///
/// Ranks over all models: "number" (of each kind), "number of all", "severity of all" (the sum of
/// each kind's), "deepest of all" (the largest severity in terms of its prior's end), "log
/// likelihood". Within the true model, whose draws alone are asked: "severity" (the sum of each
/// kind that the truth has), "deepest", and "place" where it has one of the kind. The last three
/// are left out where they have fewer than `kEnough` effective draws.
[[nodiscard]] Row run(const RandomCase& random, inference::Options options = {});
inline constexpr double kEnough = 50.0;

}  // namespace wheeltap::coverage
