// Contribution of each measured mode to the posterior, and comparison of shapes.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/eigen.hpp"
#include "fem/structures/modes/parametric_modes.hpp"
#include "identification/structural/likelihood/modal_likelihood.hpp"

namespace wheeltap::identification {

/// ln p of each measured mode given the other modes at fixed parameters: the log likelihood minus
/// its value without the mode. For frequencies with residuals r ~ N(0, C), P = C⁻¹,
///
///   r_i | other r_j ~ N(r_i - (P r)_i / P_ii, 1 / P_ii)   (Rue & Held 2005, theorem 2.3);
///
/// shapes are independent of frequencies. `with` lists the modes with measured frequencies. `c` is
/// the covariance of these frequencies [Hz²]. If modes may be spurious (`data.doubt`), the result
/// is the log likelihood of each match in `score`.
[[nodiscard]] Eigen::VectorXd single_mode_densities(const ModalData& data,
                                                    const std::vector<int>& with,
                                                    const Eigen::MatrixXd& c,
                                                    const ModalLikelihood::Score& score);

/// The posterior without the data of one mode, as weighted draws of the posterior with these data.
/// The weights are 1/p of the mode (importance sampling: Gelfand, Dey & Chang 1992).
struct WithoutMode {
  std::vector<double> weights;  ///< one per draw; their sum is 1
  double information = 0.0;     ///< KL(posterior ‖ without) [nats]
  bool reliable = true;         ///< true if the effective sample size is 50 or more
};
/// `log_density` is the log density of the mode at each draw. `weights` are the weights of the
/// draws in the posterior; empty: all 1.
[[nodiscard]] WithoutMode without_mode(std::span<const double> log_density,
                                       std::span<const double> weights = {});

/// P(χ² with `freedoms` degrees of freedom > `chi_square`); 1 for `freedoms` = 0.
[[nodiscard]] double chi_square_tail(double freedoms, double chi_square);

/// Comparison of measured and computed shapes of one state.
struct ShapesBeside {
  int state = 0;
  Eigen::MatrixXd mac;  ///< MAC matrix (measured × computed modes); NaN if no shape was measured
  /// Modes × sensors, for the matched modes, scaled to the measured shapes; NaN if not measured.
  Eigen::MatrixXd computed;
};
[[nodiscard]] ShapesBeside shapes_beside(const ModalLikelihood& likelihood,
                                         const fem::ParametricModes::Modes& modes,
                                         std::span<const ModalLikelihood::Match> matches);

}  // namespace wheeltap::identification
