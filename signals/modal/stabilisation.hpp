// Which poles of many orders are modes: a stabilisation diagram that reads itself.
//
// Hard criteria leave poles of a plausible damping whose frequency is known well enough. Soft
// criteria are in one distance between poles, d = |Δf| / max f + 1 - MAC (Magalhães, Cunha &
// Caetano 2009, MSSP 23:1431): poles nearer than a threshold are joined to clusters by average
// linkage, where no cluster may hold two poles of one order. The threshold comes from how far a
// pole lies from the nearest one of the order before, in the class of those that stay (two classes
// of log d by least squares; Reynders 2012, Arch. Comput. Methods Eng. 19:51, section 4).
#pragma once

#include <vector>

#include "signals/modal/stochastic_subspace.hpp"

namespace wheeltap::signals {

struct StabilisationOptions {
  double lowest_hz = 0.0, highest_hz = 1e300;
  int smallest_order = 2, largest_order = 0;  ///< 0: the largest there is
  double highest_damping = 0.2;
  /// Poles below 0 by no more are kept: a steady tone scatters about 0.
  double lowest_damping = -0.002;
  double largest_relative_sd = 0.05;  ///< of the frequency
  double least_share = 0.25;          ///< of the orders, for a cluster to be a mode
  int threads = 0;
};

/// Poles of several orders that are one mode.
struct ModeCluster {
  std::vector<int> members = {};  ///< in Stabilisation::poles, by order
  int orders = 0;                 ///< from the first that has it to the last there is
  int chosen = -1;                ///< of the members, see `stabilise`
  [[nodiscard]] double share() const {
    return orders > 0 ? static_cast<double>(members.size()) / orders : 0.0;
  }
};

/// Why poles that belong together are no mode.
enum class Rejection {
  few_orders,  ///< in less than least_share of the orders from the first one on
  splinter,    ///< a part of a mode that is known better
  noise        ///< of free decays, which are explained as well without it
};
struct RejectedCluster {
  ModeCluster cluster = {};
  Rejection why = Rejection::few_orders;
};

struct Stabilisation {
  std::vector<Pole> poles = {};                ///< within the band, of all orders, ascending
  std::vector<bool> hard = {};                 ///< which of them meet the hard criteria
  double threshold = 0.0;                      ///< of the distance
  int orders = 0;                              ///< that were tried
  std::vector<ModeCluster> modes = {};         ///< by frequency
  std::vector<RejectedCluster> rejected = {};  ///< of three poles and more
};

/// Clusters that explain one peak of the spectrum are joined: poles of one shape (MAC above 0.9)
/// whose frequencies and damping ratios differ by less than three of their standard deviations, and
/// whose frequencies lie within their half-power widths. Modes of other shapes stay apart, however
/// close they are.
///
/// A mode is a cluster in at least `least_share` of the orders from its first on, and in three; one
/// that another holds within three standard deviations, with the same shape, in more orders and
/// twice as well known, is a splinter of that. It
/// is represented by one of its poles: of those whose scatter (geometric mean of both relative
/// standard deviations) is within a tenth of the cluster's best tenth (of 1.25 times the best
/// where that is less), the one with the median frequency in the upper half of their orders. That
/// passes by the orders that are too large, whose poles scatter more, and those that may be too low
/// to have resolved whatever bends the shape, and selects among the others by nothing that has to
/// do with their uncertainty. Only orders count from where on all steady modes are there, those
/// beyond the band as well, and all within the mode's skirts: one that is not resolved bends the
/// shapes of others. Where no such order scatters as little as the best, the best of them do; where
/// there are fewer than three, or all are twice as uncertain, every order counts. Of poles without
/// standard deviations (NaN), which take largest_relative_sd = ∞, the median of all stands for the
/// cluster.
[[nodiscard]] Stabilisation stabilise(const StochasticSubspace& subspace,
                                      const StabilisationOptions& options);

/// The same of any method's poles: those of smallest_order, smallest_order + 2, …, within the
/// window. Cut to the options' band and damping.
[[nodiscard]] Stabilisation stabilise(std::vector<std::vector<Pole>> by_order,
                                      const StabilisationOptions& options);

/// d of two poles.
[[nodiscard]] double pole_distance(const Pole& a, const Pole& b);

/// Least of x, …, largest of x in two classes by least squares: the first value of the upper one's
/// place in sorted x. Exposed for its test; needs two values.
[[nodiscard]] std::size_t two_classes(const std::vector<double>& sorted);

}  // namespace wheeltap::signals
