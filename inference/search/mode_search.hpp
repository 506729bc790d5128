// Modes of one model's posterior, each climbed to from many draws of its prior.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/eigen.hpp"
#include "inference/model/target.hpp"

namespace wheeltap::inference {

/// A maximum of ln π(z) (model_posterior.hpp) and the normal about it.
struct Mode {
  std::vector<double> z;
  double log_posterior = 0.0;
  Eigen::MatrixXd covariance;  ///< inverse of minus the Hessian, made positive definite
  double log_mass = 0.0;       ///< Laplace: ln π + (d/2) ln 2π + ½ ln|covariance|
  long climbs = 0;             ///< that ended here
};

struct ModeSearchOptions {
  std::uint64_t seed = 1;
  long climbs = 0;       ///< 0: as many as `budget` pays for, between kFewestClimbs and kMostClimbs
  long budget = 100000;  ///< likelihood calls; what has been begun is finished
  /// In (0, 1]: how much of what is done as a record grows is done, of climbs from the prior, modes
  /// followed, and draws about each.
  double effort = 1.0;
  /// Also climbed from, e.g. draws of another method; not counted.
  std::vector<std::vector<double>> starts{};
  bool fine = false;  ///< these are near modes: the first differences there are fine (climb.hpp)
  int threads = 0;    ///< 0: as many as the machine has. Never changes a result.
  /// Called from one thread with the share done so far; returning false ends the search.
  std::function<bool(double share)> progress = nullptr;
  /// Asked between two likelihoods by any thread; true ends the search. Climbs on their way then
  /// count for nothing.
  std::function<bool()> stop = nullptr;
};

struct ModeSearch {
  std::vector<Mode> modes;  ///< the weightiest first; those e^-25 below it and less are left out
  long climbs = 0;          ///< begun at a possible point and ended
  /// How far apart the points are at which these climbs evaluated ln π, in standard deviations of
  /// the prior, on average over their paths; 0: not known. A narrower mode may lie between two of
  /// them.
  double spacing = 0.0;
  long likelihood_evaluations = 0;
};

inline constexpr long kFewestClimbs = 30;
inline constexpr long kMostClimbs = 10000;

/// Climbs from draws of the prior, in standard normal coordinates:
///
///   z ← z + t B g,   g = ∇ ln π,   B ≈ (-∇² ln π)⁻¹
///
/// by BFGS (Nocedal & Wright 2006, section 6.1) with differences, or the likelihood's own gradient
/// where it serves, from the diagonal of second differences, t halved until the gain is what the
/// quadratic model says to within a factor of ten: a step that leaves the region where the model
/// holds may leave the basin. A likelihood that offers Gauss & Newton's quadratic is climbed by
/// Levenberg & Marquardt's method instead (Moré 1978), its steps held to the same, and by BFGS from
/// where that does not arrive. Where modes are known, one or two Newton
/// steps with the nearest one's curvature are tried first; if they end there, and three points on
/// the way show nothing that they leapt over, that start is spent for a few calls. So thousands of
/// starts are paid for where the posterior is nearly normal.
///
/// Components are exchangeable: the climb is over labelled vectors, on which ln π is symmetric, and
/// its end is put in order. Two ends are one mode where the straight line between them has no
/// valley deeper than two nats.
///
/// Where the problem can be shortened, climbs are made on its first 50 samples, and modes are
/// followed as the record doubles, each from itself and from draws of the normal about it; the best
/// in smaller steps where twice the record has no such mode: ln π falls by far more than the new
/// samples' share of it. On the whole record the likeliest of a few hundred draws of the prior are
/// climbed from besides.
///
/// A mode whose basin holds a share p of the prior is missed by n climbs with probability (1-p)^n,
/// the basin being all points from which these climbs, with steps of finite length, arrive. From
/// the basin of steepest ascent, a path without steps, a climb arrives at a mode of width w with a
/// probability of about min(1, w / spacing), since it evaluates ln π only every `spacing`.
[[nodiscard]] ModeSearch search_modes(const Problem& problem, int model,
                                      const ModeSearchOptions& options);

/// Climbs from `options.starts` besides, on the whole record. Modes that `found` has are not
/// climbed to again; its `climbs` stay: chosen starts say nothing of the prior.
void extend_search(const Problem& problem, int model, const ModeSearchOptions& options,
                   ModeSearch& found);

/// The largest share of the prior that a basin can hold and still be missed by all of n climbs with
/// a probability of 1 in 100: 1 - 0.01^(1/n).
[[nodiscard]] double search_resolution(long climbs);

/// The same of modes so wide, in standard deviations of the prior, and of the basins of steepest
/// ascent: larger in proportion where they are narrower than the climbs' `spacing`, and 1 at most.
[[nodiscard]] double search_resolution(double of_wide_modes, double spacing, double width);

}  // namespace wheeltap::inference
