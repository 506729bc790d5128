// Problems with known answers: those that the engine must solve (list 1), and those that it must
// solve, flag, or state to be below its resolution (list 2).
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/random.hpp"
#include "inference/model/target.hpp"

namespace wheeltap::inference {

enum class Asked {
  found,            ///< converged, and every probability within 4 reported errors
  found_or_flagged  ///< the same, or not converged, or the basin below the stated resolution
};

struct HardProblem {
  std::string name;
  std::string family;
  int dimension = 0;  ///< dimension of the largest model
  Problem problem;
  std::vector<double> probability;   ///< one per model, exact
  std::vector<double> log_evidence;  ///< one per model, exact
  Asked asked = Asked::found;
  /// Share of the prior from which steepest ascent of the posterior in standard normal coordinates
  /// (as in the engine) leads to the hidden mode; 1 if none is hidden. It refers to a continuous
  /// path; finite steps may skip a narrow mode.
  double basin = 1.0;
  /// Share of the prior where the hidden mode has the higher density: the remaining basin for a
  /// climb that skips it.
  double core = 1.0;
  bool quick = false;    ///< in the short suite
  bool balance = false;  ///< use Options::balance
  /// Makes one exact draw of a model's posterior, with components in any order.
  std::function<void(int model, base::Random& random, std::span<double> x)> draw;
  std::vector<double> hidden;  ///< its maximum, in the first model of this dimension; empty: none
};

/// Both lists, without problems that need data outside the repository.
[[nodiscard]] const std::vector<HardProblem>& hard_problems();

/// A problem's name in letters, digits and underscores, as required for test names.
[[nodiscard]] std::string identifier(const std::string& name);

/// Radiata pine (Williams 1959; Carlin & Chib 1995): two regressions, not nested, of
/// `folder`/pine.csv. Evidences by quadrature over ln τ; no draws.
[[nodiscard]] HardProblem radiata_problem(const std::string& folder);

}  // namespace wheeltap::inference
