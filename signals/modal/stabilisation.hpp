// Stabilisation diagrams with automatic selection of modes from the poles of many orders.
//
// Hard criteria keep poles with plausible damping and a sufficiently small standard deviation of
// frequency. The soft criterion is a distance between poles, d = |Δf| / max f + 1 - MAC (Magalhães,
// Cunha & Caetano 2009, MSSP 23:1431). Average linkage joins poles closer than a threshold to
// clusters with at most one pole of each order. The threshold follows from the distance of a pole
// to the nearest one of the previous order, in the class of stable poles (two classes of log d by
// least squares; Reynders 2012, Arch. Comput. Methods Eng. 19:51, section 4).
#pragma once

#include <span>
#include <stdexcept>
#include <string>
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
  noise,       ///< free decays are explained equally well without it
  not_chosen   ///< not in the list of poles chosen by hand
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
/// three. A cluster is a splinter if another one lies within three standard deviations, has the
/// same shape, more orders and half the uncertainty.
///
/// One pole represents the mode. The scatter of a pole is the geometric mean of both relative
/// standard deviations. Candidates are poles whose scatter is within the best tenth of the cluster
/// (or within 1.25 times the best, if that is less). The one with the median frequency in the upper
/// half of their orders is chosen. This avoids orders that are too large, whose poles scatter more,
/// and low orders that may not resolve neighbouring modes. The choice within them does not depend
/// on their uncertainty.
///
/// A mode that is not resolved distorts the shapes of others. Only orders count from which all
/// steady modes, including those outside the band, and all modes within the mode's skirts are
/// present. If no such order scatters as little as the best, the best of them are used. If there
/// are fewer than three, or all are twice as uncertain, every order counts. For poles without
/// standard deviations (NaN), which need largest_relative_sd = ∞, the median of all represents the
/// cluster.
[[nodiscard]] Stabilisation stabilise(const StochasticSubspace& subspace,
                                      const StabilisationOptions& options);

/// The same for the poles of any method: those of smallest_order, smallest_order + 2, …, within the
/// window. The result is limited to the band and damping of the options.
[[nodiscard]] Stabilisation stabilise(std::vector<std::vector<Pole>> by_order,
                                      const StabilisationOptions& options);

/// A pole chosen by hand: that of this order nearest to the frequency.
struct ChosenPole {
  int order = 0;
  double frequency_hz = 0.0;
};

/// A chosen pole that the diagram does not have.
struct ChosenPoleError : std::invalid_argument {
  ChosenPoleError(long which, const std::string& reason)
      : std::invalid_argument(reason), pole(which) {}
  long pole;  ///< index in the list
};

/// Largest distance of a chosen pole from its stated frequency, relative to this frequency. Numbers
/// are written with fewer digits than they have, and processors round differently.
inline constexpr double kChosenWithin = 0.005;

/// Replaces the modes by the chosen poles. A mode keeps the cluster of its pole, which becomes the
/// representative; a pole of no cluster is a mode by itself. Clusters without a chosen pole are
/// rejected. Throws ChosenPoleError for an order or a frequency that the diagram does not have, and
/// for a pole chosen twice.
void choose_poles(Stabilisation& diagram, std::span<const ChosenPole> chosen);

/// The distance d of two poles.
[[nodiscard]] double pole_distance(const Pole& a, const Pole& b);

/// Splits x into two classes by least squares and returns the index of the upper class's smallest
/// value in sorted x. Public for its test; needs two values.
[[nodiscard]] std::size_t two_classes(const std::vector<double>& sorted);

}  // namespace wheeltap::signals
