// Results of a run on one random case, and its truth: one line of a file.
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
  std::vector<std::string> kinds = {};  ///< type of each kind
  std::vector<int> most = {};           ///< largest count of each kind
  std::vector<int> truth = {};          ///< true count of each kind
  double cv = 0.0;
  int modes = 0;

  struct Model {
    std::vector<int> counts;
    double probability = 0.0;
  };
  std::vector<Model> models = {};
  bool converged = false;
  std::vector<std::string> why_not = {};   ///< reasons of the verdict, in words
  std::vector<std::string> warnings = {};  ///< other warnings of the findings

  /// Rank of a function g of the state, by name: P(g < g_true) + U P(g = g_true) by the draws, U
  /// uniform. It is uniform if the posterior is calibrated, with or without ties (Talts et al.
  /// 2018; Modrák et al. 2023 for the log likelihood). Several ranks if there are several kinds.
  std::map<std::string, std::vector<double>> ranks = {};
  /// ln p(data | truth) less the largest of any draw: well above 0 if the draws missed a mode.
  double truth_above_draws = 0.0;
  double likelihood_calls = 0.0, seconds = 0.0;

  [[nodiscard]] double probability_of_truth() const;
  /// True if the run has not converged or its findings have a warning.
  [[nodiscard]] bool warned() const { return !converged || !warnings.empty(); }
  [[nodiscard]] std::string to_line() const;                    ///< JSON
  [[nodiscard]] static Row from_line(const std::string& line);  ///< throws as the parser does
};

/// Runs the engine on the case, on one thread and with the case's seed.
///
/// Ranks over all models: "number" (of each kind), "number of all", "severity of all" (the sum of
/// each kind's), "deepest of all" (the largest severity in terms of its prior's end), "log
/// likelihood". Ranks over the draws of the true model: "severity" (the sum of each kind that the
/// truth has), "deepest", and "place" if it has one of the kind. These three are omitted if they
/// have fewer than `kEnough` effective draws.
[[nodiscard]] Row run(const RandomCase& random, inference::Options options = {});
inline constexpr double kEnough = 50.0;

}  // namespace wheeltap::coverage
