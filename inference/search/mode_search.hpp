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
  /// Maximum number of likelihood evaluations; exact derivatives count like central differences.
  /// Optimisations in progress are completed. Optimisations after replacements of components may
  /// use 10 % more, or as many evaluations as before.
  long budget = 100000;
  /// Factor in (0, 1] that reduces the work for a growing record. It multiplies the numbers of
  /// optimisations from prior draws, of tracked posterior modes, and of draws per mode.
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
  /// Mean distance between the points at which these optimisations evaluated ln π, in standard
  /// deviations of the prior; 0: not known. The search may miss a narrower mode.
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
/// Levenberg & Marquardt's method (Moré 1978) with the same rule for its steps, and BFGS if this
/// method does not converge. If posterior modes are known, one or two Newton steps with the
/// curvature of the nearest mode are tried first. If these steps converge to the known mode, and
/// three points on the path show no other mode, the optimisation is complete after a few
/// evaluations. Thousands of optimisations are thus affordable if the posterior is nearly normal.
///
/// Components are exchangeable: each optimisation uses labelled vectors, in which ln π is
/// symmetric, and sorts its result. Two end points are the same posterior mode if ln π on the line
/// between them has no valley deeper than two nats.
///
/// If the problem can be shortened, the optimisations use its first 50 samples. The number of
/// samples is then doubled repeatedly. Each mode is followed by optimisations from the previous
/// mode and from draws of the normal approximation at this mode. If the mode does not exist for the
/// doubled record (it predicts the new samples far worse than the earlier samples), the best modes
/// are followed with smaller increments of the record. Further optimisations on the whole record
/// start from the draws with the highest posterior density among a few hundred draws of the prior.
///
/// With two or more components, optimisations also start from the highest modes, with one component
/// replaced by the most probable of 64 prior draws. New modes are treated in the same way.
///
/// If the basin of a posterior mode has the prior probability p, all n optimisations miss it with
/// probability (1-p)^n. The basin contains all points from which an optimisation with finite steps
/// reaches the mode. From the basin of steepest ascent, an optimisation reaches a mode of width w
/// with probability ≈ min(1, w / spacing), since it evaluates ln π only at points `spacing` apart.
[[nodiscard]] ModeSearch search_modes(const Problem& problem, int model,
                                      const ModeSearchOptions& options);

/// Adds optimisations from `options.starts` on the whole record. This function does not search
/// again for posterior modes in `found`, and does not change `found.climbs`, because chosen starts
/// are not draws of the prior.
void extend_search(const Problem& problem, int model, const ModeSearchOptions& options,
                   ModeSearch& found);

/// The prior probability of a basin that all n optimisations miss with probability 1 in 100: 1 -
/// 0.01^(1/n).
[[nodiscard]] double search_resolution(long climbs);

/// The resolution with respect to basins of steepest ascent, for posterior modes of the width
/// `width` [standard deviations of the prior]. For widths below the `spacing` of the optimisations,
/// the resolution is multiplied by spacing / width, up to at most 1.
[[nodiscard]] double search_resolution(double of_wide_modes, double spacing, double width);

}  // namespace wheeltap::inference
