// Check of the mode numbers of measured frequencies if no shapes were measured.
//
// Without shapes, the i-th frequency is assigned to the i-th elastic mode. A numbering b_1 < b_2 <
// … assigns the i-th frequency to mode b_i instead. The prior weight of a numbering is a product of
// factors: 0.05 for each missed mode beyond the known gaps, and 0.1 for each known gap that
// corresponds to no mode. Under the priors, ln f of the computed modes has approximately the normal
// distribution N(m, S). m and S are estimated from draws. The probability density of the data is
// then
//
//   p(data | b) = N(ln f_obs; m_b, S_bb + C / (f fᵀ) + 0.02²),
//
// where 0.02² is the variance of a relative model error of 2 %. P(b | data) follows by Bayes' rule.
// P(b | data) only serves as a check of the assumed mode numbers; it is not part of the likelihood.
#pragma once

#include <optional>
#include <vector>

#include "base/eigen.hpp"
#include "identification/structural/modal_data.hpp"
#include "identification/structural/structure_model.hpp"

namespace wheeltap::identification {

struct Numbering {
  std::vector<int> modes = {};  ///< mode of the structure, from 1, for each measured mode
  double probability = 0.0;
};

struct NumberingFinding {
  std::vector<int> measured = {};  ///< assumed numbers of the measured modes, from 1
  double probability = 1.0;        ///< probability of the assumed numbers
  Numbering likeliest = {};        ///< most probable one of the other numberings
  int draws = 0;

  [[nodiscard]] bool is_doubtful() const { return probability < 0.9; }
};

/// `ln_f` is ln f of the computed modes: draws × modes, by ascending mode number. `measured` has,
/// for each measured mode, the assumed column of `ln_f`, from 0. `ln_measured` and `covariance` are
/// ln f of the measured modes and its covariance. Requires more than 2 draws per mode.
[[nodiscard]] NumberingFinding judge_numbering(const Eigen::MatrixXd& ln_f,
                                               const std::vector<int>& measured,
                                               const Eigen::VectorXd& ln_measured,
                                               const Eigen::MatrixXd& covariance);

/// Checks the mode numbers of a structure's data without shapes. `frequency_covariance` is the
/// covariance of all rows [Hz²]. The result is empty if shapes were measured, or if two seconds
/// allow too few solutions.
[[nodiscard]] std::optional<NumberingFinding> numbering_of(
    const StructureModel& model, const ModalData& data,
    const Eigen::MatrixXd& frequency_covariance);

}  // namespace wheeltap::identification
