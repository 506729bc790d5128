// Problems with known answers: what the engine must find (list 1), and what it must find, flag or
// own to be below the resolution it states (list 2).
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
  int dimension = 0;  ///< of the largest model
  Problem problem;
  std::vector<double> probability;   ///< of each model, exact
  std::vector<double> log_evidence;  ///< of each model, exact
  Asked asked = Asked::found;
  /// Share of the prior from which steepest ascent of the posterior in standard normal coordinates
  /// (where the engine climbs) leads to the hidden mode; 1 where none is hidden. Of a continuous
  /// path: one with finite steps may leap over a narrow mode.
  double basin = 1.0;
  /// Share of the prior where the hidden mode's density is the larger: what is left of the basin
  /// for a climb that leaps.
  double core = 1.0;
  bool quick = false;    ///< runs in the short suite
  bool balance = false;  ///< to be run with Options::balance
  /// One exact draw of a model's posterior; components, if any, in no order.
  std::function<void(int model, base::Random& random, std::span<double> x)> draw;
  std::vector<double> hidden;  ///< its top, in the first model of this dimension; empty: none
};

/// Both lists. Those with data beside the checkout are apart.
[[nodiscard]] const std::vector<HardProblem>& hard_problems();

/// A problem's name in letters, digits and underscores, as test names must be.
[[nodiscard]] std::string identifier(const std::string& name);

/// Radiata pine (Williams 1959; Carlin & Chib 1995): two regressions, neither within the other, of
/// `folder`/pine.csv. Its evidences are by quadrature over ln τ; no draws.
[[nodiscard]] HardProblem radiata_problem(const std::string& folder);

}  // namespace wheeltap::inference
