// Shifts of features that one defect of a structure causes, at every place and severity.
//
//   δ_j(x, r) = ln f_j(x, r) - ln f_j(intact)
//
// f_j is the natural frequency of feature j's mode, by reanalysis. A path holds one place x with
// all severities r: shifts at nodes of equal prior probability, linear in between.
#pragma once

#include <vector>

#include "identification/structural/damage/damage_case.hpp"

namespace wheeltap::identification::monitoring {

struct DefectPath {
  int kind = 0;
  double from = 0.0, to = 0.0;  ///< its part of the kind's line
  double extent = 0.0;          ///< [m], where the kind's is unknown: a quantile of its prior
  double log_prior = 0.0;       ///< ln P(place | one defect of this kind)
  std::vector<double> severities = {};  ///< nodes, ascending; one where the severity is known
  Eigen::MatrixXd shifts = {};          ///< p x nodes; NaN: an impossible structure
};

/// All paths of the kinds of a case, one after the other. `modes`: p, the elastic mode (from 0) of
/// each feature. Throws InvalidInput, fem::InvalidStructure.
[[nodiscard]] std::vector<DefectPath> defect_paths(const DamageCase& damage_case,
                                                   const std::vector<int>& modes, int threads);

}  // namespace wheeltap::identification::monitoring
