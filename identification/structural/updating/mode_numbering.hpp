// Whether frequencies without shapes have the numbers of the structure's modes.
//
// Without shapes the i-th frequency is taken for the i-th elastic mode. A numbering b_1 < b_2 < …
// gives each measured mode another one. Before the data a numbering has a weight of 0.05 for each
// mode of the structure that was missed besides the known gaps, and 0.1 for each known gap that was
// no mode at all. Under the priors ln f of the computed modes is taken for normal, N(m, S), from
// draws, so that
//
//   p(data | b) = N(ln f_obs; m_b, S_bb + C / (f fᵀ) + 0.02²),
//
// 2 % being what a model leaves out. P(b | data) follows by Bayes' rule. It is a check of what was
// assumed, not a part of the likelihood.
#pragma once

#include <optional>
#include <vector>

#include "base/eigen.hpp"
#include "identification/structural/modal_data.hpp"
#include "identification/structural/structure_model.hpp"

namespace wheeltap::identification {

struct Numbering {
  std::vector<int> modes = {};  ///< of the structure, from 1: one a measured mode
  double probability = 0.0;
};

struct NumberingFinding {
  std::vector<int> measured = {};  ///< numbers of the measured modes, as they are used, from 1
  double probability = 1.0;        ///< of these
  Numbering likeliest = {};        ///< of all others
  int draws = 0;

  [[nodiscard]] bool is_doubtful() const { return probability < 0.9; }
};

/// `ln_f`: of computed modes, draws × modes, in the structure's order. `measured`: which of
/// the first computed modes each measured one is taken for, from 0. `ln_measured`, `covariance`: of
/// the measured ones. Needs more draws than twice the modes.
[[nodiscard]] NumberingFinding judge_numbering(const Eigen::MatrixXd& ln_f,
                                               const std::vector<int>& measured,
                                               const Eigen::VectorXd& ln_measured,
                                               const Eigen::MatrixXd& covariance);

/// The same of a structure's data without shapes; `frequency_covariance` is that of all rows [Hz²].
/// Nothing where there are shapes, or where too few solutions are made in two seconds.
[[nodiscard]] std::optional<NumberingFinding> numbering_of(
    const StructureModel& model, const ModalData& data,
    const Eigen::MatrixXd& frequency_covariance);

}  // namespace wheeltap::identification
