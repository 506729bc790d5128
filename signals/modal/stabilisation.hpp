// Stabilisation diagrams with automatic selection of modes from the poles of many orders.
//
// Hard criteria keep poles with plausible damping and a sufficiently small standard deviation of
// frequency. The soft criterion is a distance between poles, d = |Δf| / max f + 1 - MAC (Magalhães,
// Cunha & Caetano 2009, MSSP 23:1431). Average linkage joins poles closer than a threshold to
// clusters with at most one pole of each order. The threshold follows from the distance of a pole
// to the nearest one of the previous order, in the class of stable poles (two classes of log d by
// least squares; Reynders 2012, Arch. Comput. Methods Eng. 19:51, section 4).
#pragma once

#include <vector>

#include "signals/modal/stochastic_subspace.hpp"

namespace wheeltap::signals {

struct StabilisationOptions {
  double lowest_hz = 0.0, highest_hz = 1e300;
  int smallest_order = 2, largest_order = 0;  ///< 0: the largest available
  double highest_damping = 0.2;
  /// Largest negative damping that is kept, because the estimate of a steady tone scatters about 0.
  double lowest_damping = -0.002;
  double largest_relative_sd = 0.05;  ///< standard deviation / frequency
  double least_share = 0.25;          ///< smallest share of the orders for a mode
  int threads = 0;
};

/// Poles of several orders that belong to one mode.
struct ModeCluster {
  std::vector<int> members = {};  ///< indices in Stabilisation::poles, by order
  int orders = 0;                 ///< from the first one with this mode to the last
  int chosen = -1;                ///< index among the members, see `stabilise`
  [[nodiscard]] double share() const {
    return orders > 0 ? static_cast<double>(members.size()) / orders : 0.0;
  }
};

/// Reasons to reject a cluster as a mode.
enum class Rejection {
  few_orders,  ///< in less than least_share of the orders from its first one
  splinter,    ///< part of a mode that is known better
  noise        ///< free decays are explained equally well without it
};
struct RejectedCluster {
  ModeCluster cluster = {};
  Rejection why = Rejection::few_orders;
};

struct Stabilisation {
  std::vector<Pole> poles = {};                ///< within the band, of all orders, ascending
  std::vector<bool> hard = {};                 ///< true for poles that meet the hard criteria
  double threshold = 0.0;                      ///< limit of the distance
  int orders = 0;                              ///< number of orders computed
  std::vector<ModeCluster> modes = {};         ///< by frequency
  std::vector<RejectedCluster> rejected = {};  ///< with at least three poles
};

/// Clusters that explain one peak of the spectrum are joined: poles with the same shape (MAC above
/// 0.9) whose frequencies and damping ratios differ by less than three standard deviations, with
/// frequencies within their half-power widths. Modes with other shapes stay separate, however close
/// they are.
///
/// A mode is a cluster in at least `least_share` of the orders from its first one, and in at least
/// three. A cluster is rejected as a splinter of another cluster if that one lies within three
/// standard deviations and has the same shape, more orders and half the uncertainty.
///
/// One pole represents the mode. The scatter of a pole is the geometric mean of both relative
/// standard deviations. Candidates are poles whose scatter is within the best tenth of the cluster
/// (or within 1.25 times the best, if that is less). The one with the median frequency in the upper
/// half of their orders is chosen. This avoids orders that are too large, whose poles scatter more,
/// and low orders that may not resolve neighbouring modes. The choice within them does not depend
/// on their uncertainty.
///
/// A mode that is not yet resolved at an order distorts the shapes of other modes. An order
/// therefore counts only if it contains all steady modes, including those outside the band, and all
/// modes whose resonance peaks overlap with this one. If no such order has a scatter as small as
/// the best pole, the best of these orders are used. If there are fewer than three such orders, or
/// all of them are twice as uncertain, every order counts. Poles without standard deviations (NaN)
/// require largest_relative_sd = ∞; then the median of all poles represents the cluster.
[[nodiscard]] Stabilisation stabilise(const StochasticSubspace& subspace,
                                      const StabilisationOptions& options);

/// Selects modes from the poles of any method. `poles` holds those of smallest_order,
/// smallest_order + 2, …, within the window. The result is limited to the options' band and
/// damping.
[[nodiscard]] Stabilisation stabilise(std::vector<std::vector<Pole>> by_order,
                                      const StabilisationOptions& options);

/// The distance d of two poles.
[[nodiscard]] double pole_distance(const Pole& a, const Pole& b);

/// Splits x into two classes by least squares and returns the index of the upper class's smallest
/// value in sorted x. Requires at least two values. Public for its test.
[[nodiscard]] std::size_t two_classes(const std::vector<double>& sorted);

}  // namespace wheeltap::signals
