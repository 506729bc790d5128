// Search for the posterior modes of one model by local optimisations that start from draws of its
// prior.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/eigen.hpp"
#include "inference/model/target.hpp"

namespace wheeltap::inference {

/// A maximum of ln π(z) (model_posterior.hpp) and its normal approximation.
struct Mode {
  std::vector<double> z;
  double log_posterior = 0.0;
  Eigen::MatrixXd covariance;  ///< inverse of minus the Hessian, made positive definite
  double log_mass = 0.0;       ///< Laplace: ln π + (d/2) ln 2π + ½ ln|covariance|
  long climbs = 0;             ///< number of local optimisations that ended at this posterior mode
};

struct ModeSearchOptions {
  std::uint64_t seed = 1;
  long climbs = 0;  ///< number of optimisations; 0: kFewestClimbs to kMostClimbs, by `budget`
  /// Maximum number of likelihood evaluations; exact derivatives count as much as central
  /// differences. Optimisations in progress are completed. Optimisations after replacements of
  /// components may add 10 % of the budget or, if this is more, as many evaluations as all earlier
  /// optimisations.
  long budget = 100000;
  /// Factor in (0, 1] that reduces the work for a growing record. The factor multiplies the numbers
  /// of optimisations from prior draws, of tracked posterior modes, and of draws per mode.
  double effort = 1.0;
  /// Additional starting points, e.g. draws of another method; `climbs` does not count them.
  std::vector<std::vector<double>> starts{};
  bool fine = false;  ///< `starts` are near posterior modes: use small difference steps (climb.hpp)
  int threads = 0;    ///< threads; 0: all of the machine. Results do not depend on this number.
  /// Callback, called from one thread with the completed fraction. If the callback returns false,
  /// the search ends.
  std::function<bool(double share)> progress = nullptr;
  /// Callback, called between two likelihood evaluations by any thread. If the callback returns
  /// true, the search ends, and optimisations in progress are discarded.
  std::function<bool()> stop = nullptr;
};

struct ModeSearch {
  std::vector<Mode> modes;  ///< by decreasing probability mass, down to e^-25 of the largest
  long climbs = 0;          ///< number of completed optimisations from starts of positive density
  /// Mean distance between the points at which the completed optimisations evaluated ln π, in
  /// standard deviations of the prior; 0: not known. The search may miss a posterior mode that is
  /// narrower than this distance.
  double spacing = 0.0;
  /// Number of further posterior modes, omitted because a search keeps a limited number of modes,
  /// and the fraction of the probability mass at these modes (Laplace's method).
  long left_out = 0;
  double left_out_share = 0.0;
  long likelihood_evaluations = 0;
};

inline constexpr long kFewestClimbs = 30;
inline constexpr long kMostClimbs = 10000;

/// Finds modes by local optimisations from draws of the prior, in standard normal coordinates:
///
///   z ← z + t B g,   g = ∇ ln π,   B ≈ (-∇² ln π)⁻¹
///
/// by BFGS (Nocedal & Wright 2006, section 6.1), starting with the diagonal of second differences.
/// The gradient is computed by differences, or by the likelihood if the likelihood has a gradient.
/// t is halved until the increase of ln π agrees with the quadratic model within a factor of ten. A
/// longer step may leave the region in which the quadratic model is valid, and the basin of the
/// posterior mode. If the likelihood offers a Gauss-Newton approximation, the optimisation uses
/// Levenberg & Marquardt's method (Moré 1978) with the same rule for its steps. If Levenberg &
/// Marquardt's method does not converge, the optimisation uses BFGS. If posterior modes are known,
/// one or two Newton steps with the curvature of the nearest mode are tried first. If these steps
/// converge to the known mode, and three points on the path show no other mode, the optimisation is
/// complete after a few evaluations. Thousands of optimisations are thus affordable if the
/// posterior is nearly normal.
///
/// Components are exchangeable: each optimisation uses labelled vectors, in which ln π is
/// symmetric, and sorts its result. Two end points are the same posterior mode if ln π on the line
/// between them has no valley deeper than two nats.
///
/// If the problem can be shortened, the optimisations use its first 50 samples. The number of
/// samples is then doubled repeatedly. Each mode is followed by optimisations from the previous
/// mode and from draws of the normal approximation at this mode. If the best fit to the doubled
/// record predicts the new samples far worse than the earlier samples, the record grows in smaller
/// steps. The best modes are then followed from step to step. Further optimisations on the whole
/// record start from the draws with the highest posterior density among a few hundred draws of the
/// prior.
///
/// With two or more components, optimisations also start from the highest posterior modes, with one
/// component replaced by the most probable of 64 prior draws. Further rounds replace components of
/// newly found modes.
///
/// If the basin of a posterior mode has the prior probability p, all n optimisations miss it with
/// probability (1-p)^n. The basin contains all points from which an optimisation with finite steps
/// reaches the mode. From a start in the basin of steepest ascent, an optimisation reaches a mode
/// of width w with probability ≈ min(1, w / spacing), because the optimisation evaluates ln π only
/// at points `spacing` apart.
[[nodiscard]] ModeSearch search_modes(const Problem& problem, int model,
                                      const ModeSearchOptions& options);

/// Starts optimisations on the whole record from `options.starts` and adds the resulting posterior
/// modes to `found`. This function keeps the modes in `found` without a new search. It does not
/// change `found.climbs`, because chosen starting points are not draws of the prior.
void extend_search(const Problem& problem, int model, const ModeSearchOptions& options,
                   ModeSearch& found);

/// The prior probability of a basin that all n optimisations miss with probability 1 in 100: 1 -
/// 0.01^(1/n).
[[nodiscard]] double search_resolution(long climbs);

/// The resolution for posterior modes of the width `width` [standard deviations of the prior], with
/// basins of attraction of steepest ascent. For widths below the `spacing` of the optimisations,
/// the resolution is multiplied by spacing / width, up to at most 1.
[[nodiscard]] double search_resolution(double of_wide_modes, double spacing, double width);

}  // namespace wheeltap::inference
