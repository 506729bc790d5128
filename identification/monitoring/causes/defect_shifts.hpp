// Shifts of features caused by one defect of a structure, at every location and severity.
//
//   δ_j(x, r) = ln f_j(x, r) - ln f_j(intact)
//
// f_j is the natural frequency of feature j's mode, computed by reanalysis. A path contains the
// shifts for one location x and all severities r. It stores the shifts at some severities (nodes).
// All intervals between nodes are equally probable a priori; inside an interval, shifts are
// interpolated linearly.
#pragma once

#include <vector>

#include "identification/structural/damage/damage_case.hpp"

namespace wheeltap::identification::monitoring {

struct DefectPath {
  int kind = 0;
  double from = 0.0, to = 0.0;  ///< interval that the location represents, on the kind's line
  double extent = 0.0;          ///< [m]; if the kind's extent is unknown, a quantile of its prior
  double log_prior = 0.0;       ///< ln P(location | one defect of this kind)
  /// Severities at the nodes of the path, ascending; a single node if the severity is known
  std::vector<double> severities = {};
  Eigen::MatrixXd shifts = {};  ///< shifts (p x nodes); NaN: an impossible structure
};

/// The paths of all defects that are possible in a case. `modes` gives the elastic mode (from 0) of
/// each of the p features. Throws InvalidInput, fem::InvalidStructure.
[[nodiscard]] std::vector<DefectPath> defect_paths(const DamageCase& damage_case,
                                                   const std::vector<int>& modes, int threads);

}  // namespace wheeltap::identification::monitoring
