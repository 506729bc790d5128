// Contribution of single measured modes: the posterior without one mode, and comparison of shapes.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/eigen.hpp"
#include "fem/structures/modes/parametric_modes.hpp"
#include "identification/structural/likelihood/modal_likelihood.hpp"

namespace wheeltap::identification {

/// ln p of each measured mode given the other modes at fixed parameters, that is the decrease of
/// the log likelihood if the mode is omitted. For frequencies with residuals r ~ N(0, C), P = C⁻¹,
///
///   r_i | the others ~ N(r_i - (P r)_i / P_ii, 1 / P_ii)   (Rue & Held 2005, theorem 2.3);
///
/// shapes are independent of frequencies. `with`: modes with measured frequencies; `c`: their
/// covariance [Hz²]. For possibly spurious modes (`data.doubt`), uses the densities of the
/// matching.
[[nodiscard]] Eigen::VectorXd single_mode_densities(const ModalData& data,
                                                    const std::vector<int>& with,
                                                    const Eigen::MatrixXd& c,
                                                    const ModalLikelihood::Score& score);

/// The posterior without one mode: draws of the posterior with this mode, weighted by 1/p of the
/// mode (importance sampling: Gelfand, Dey & Chang 1992).
struct WithoutMode {
  std::vector<double> weights;  ///< one per draw; sum 1
  double information = 0.0;     ///< KL(posterior ‖ without) [nats]
  bool reliable = true;         ///< the effective number of draws is 50 or more
};
/// `log_density`: log density of the mode at each draw. `weights`: weights of the draws in the
/// posterior; empty: all 1.
[[nodiscard]] WithoutMode without_mode(std::span<const double> log_density,
                                       std::span<const double> weights = {});

/// P(χ² with `freedoms` degrees of freedom > `chi_square`); 1 for `freedoms` = 0.
[[nodiscard]] double chi_square_tail(double freedoms, double chi_square);

/// Comparison of measured and computed shapes of one state.
struct ShapesBeside {
  int state = 0;
  Eigen::MatrixXd mac;  ///< measured × computed modes; NaN if no shape was measured
  /// Modes × sensors, for the matched modes, scaled to the measured shapes; NaN if not measured.
  Eigen::MatrixXd computed;
};
[[nodiscard]] ShapesBeside shapes_beside(const ModalLikelihood& likelihood,
                                         const fem::ParametricModes::Modes& modes,
                                         std::span<const ModalLikelihood::Match> matches);

}  // namespace wheeltap::identification
