// What single measured modes say: the posterior without each, and their shapes beside the model's.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/eigen.hpp"
#include "fem/structures/modes/parametric_modes.hpp"
#include "identification/structural/likelihood/modal_likelihood.hpp"

namespace wheeltap::identification {

/// ln p of each measured mode at one state of the parameters, given the other modes: what leaving
/// it out takes from the likelihood. Of frequencies with residuals r ~ N(0, C), P = C⁻¹,
///
///   r_i | the others ~ N(r_i - (P r)_i / P_ii, 1 / P_ii)   (Rue & Held 2005, theorem 2.3),
///
/// and shapes are independent of them. `with`: the modes whose frequencies were measured, `c` their
/// covariance [Hz²]. Where modes are doubted (`data.doubt`), as the matching has it.
[[nodiscard]] Eigen::VectorXd single_mode_densities(const ModalData& data,
                                                    const std::vector<int>& with,
                                                    const Eigen::MatrixXd& c,
                                                    const ModalLikelihood::Score& score);

/// The posterior without one mode, by draws of the posterior with it, weighted by 1/p of that mode
/// (importance sampling: Gelfand, Dey & Chang 1992).
struct WithoutMode {
  std::vector<double> weights;  ///< of the draws, of sum 1
  double information = 0.0;     ///< KL(posterior ‖ without) [nats]
  bool reliable = true;         ///< the weights are worth 50 draws or more
};
/// `log_density`: of the mode, at each draw. `weights`: of the draws in the posterior; all 1 where
/// there are none.
[[nodiscard]] WithoutMode without_mode(std::span<const double> log_density,
                                       std::span<const double> weights = {});

/// P(χ² with so many degrees of freedom > `chi_square`); 1 without any.
[[nodiscard]] double chi_square_tail(double freedoms, double chi_square);

/// Measured shapes of one state beside those of the model.
struct ShapesBeside {
  int state = 0;
  Eigen::MatrixXd mac;  ///< measured × computed modes; NaN where no shape was measured
  /// Modes × sensors, of the modes matched, scaled to the measured ones; NaN where not measured.
  Eigen::MatrixXd computed;
};
[[nodiscard]] ShapesBeside shapes_beside(const ModalLikelihood& likelihood,
                                         const fem::ParametricModes::Modes& modes,
                                         std::span<const ModalLikelihood::Match> matches);

}  // namespace wheeltap::identification
