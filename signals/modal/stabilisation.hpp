// Stabilisation diagrams with automatic selection of modes from the poles of many model orders.
//
// Hard criteria keep poles with plausible damping and a sufficiently small standard deviation of
// frequency. The soft criterion is a distance between poles, d = |Δf| / max f + 1 - MAC (Magalhães,
// Cunha & Caetano 2009, MSSP 23:1431). Average linkage joins poles with a distance below a
// threshold into clusters with at most one pole of each model order. The threshold follows from the
// distances d between each pole and the nearest pole of the previous model order. A least-squares
// fit divides these poles into two classes by log d; the threshold is taken from the class of
// stable poles (Reynders 2012, Arch. Comput. Methods Eng. 19:51, section 4).
#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "signals/modal/stochastic_subspace.hpp"

namespace wheeltap::signals {

struct StabilisationOptions {
  double lowest_hz = 0.0, highest_hz = 1e300;
  int smallest_order = 2, largest_order = 0;  ///< largest_order = 0: the largest available order
  double highest_damping = 0.2;
  /// Smallest damping ratio of an accepted pole. The limit is negative, because the estimated
  /// damping ratio of a steady tone varies about 0.
  double lowest_damping = -0.002;
  double largest_relative_sd = 0.05;  ///< standard deviation / frequency
  double least_share = 0.25;          ///< smallest fraction of the model orders that must contain a
                                      ///< mode
  int threads = 0;
};

/// Poles of several model orders that belong to one mode.
struct ModeCluster {
  std::vector<int> members = {};  ///< indices in Stabilisation::poles, by order
  int orders = 0;                 ///< number of model orders from the first one with this mode
                                  ///< to the last one
  int chosen = -1;                ///< index of the chosen member, see `stabilise`
  [[nodiscard]] double share() const {
    return orders > 0 ? static_cast<double>(members.size()) / orders : 0.0;
  }
};

/// Reasons to reject a cluster as a mode.
enum class Rejection {
  few_orders,  ///< in less than the fraction least_share of the model orders, counted from the
               ///< first with the cluster
  splinter,    ///< duplicate cluster of a split mode; the other cluster has more poles and a
               ///< smaller uncertainty
  noise,       ///< a model without this cluster fits the free decays equally well
  not_chosen   ///< not in the list of poles chosen by the user
};
struct RejectedCluster {
  ModeCluster cluster = {};
  Rejection why = Rejection::few_orders;
};

struct Stabilisation {
  std::vector<Pole> poles = {};                ///< poles of all model orders within the band, by
                                               ///< ascending model order
  std::vector<bool> hard = {};                 ///< true for poles that meet the hard criteria
  double threshold = 0.0;                      ///< largest distance within a cluster
  int orders = 0;                              ///< number of model orders computed
  std::vector<ModeCluster> modes = {};         ///< modes by ascending frequency
  std::vector<RejectedCluster> rejected = {};  ///< rejected clusters with at least three poles
};

/// Selects modes from a stabilisation diagram. Clusters that belong to one peak of the spectrum are
/// joined. The poles of joined clusters have the same shape (MAC above 0.9). The frequencies and
/// damping ratios of these poles differ by less than three standard deviations, and the frequencies
/// lie within the half-power bandwidths. Clusters with different shapes are not joined, even if
/// their frequencies are close.
///
/// A mode is a cluster that occurs in at least three model orders, and in at least the fraction
/// `least_share` of the model orders from its first model order on. A cluster is rejected as a
/// splinter if a second cluster has the same frequency (within three standard deviations) and
/// shape, more poles and less than half the uncertainty.
///
/// One pole represents the mode. The uncertainty of a pole is the geometric mean of the relative
/// standard deviations of frequency and damping ratio. Candidates are poles whose uncertainty is at
/// most 1.1 times a limit. The limit is the smaller of two values: the 10 % quantile of the
/// cluster's uncertainties, and 1.25 times the smallest uncertainty. Among the candidates in the
/// upper half of the candidates' model orders, the pole with the median frequency is chosen. This
/// rule avoids model orders that are too high, because their poles are less accurate. The rule also
/// avoids low model orders, which may not resolve neighbouring modes. The choice among the
/// candidates does not depend on their uncertainties.
///
/// A mode that a model order does not yet resolve distorts the shapes of other modes. A pole is
/// therefore a candidate only if its model order resolves all steady modes, also outside the band,
/// and all modes with overlapping resonance peaks. A mode is steady if it occurs in at least half
/// of the model orders from its first one on. If no pole of the model orders that resolve these
/// modes meets the limit, the best poles of these orders are the candidates. Poles of every model
/// order can be candidates if these orders have fewer than three poles, or if the best pole of
/// these orders has more than twice the smallest uncertainty. Poles without standard deviations
/// (NaN) require largest_relative_sd = ∞; then the pole with the median frequency of all poles
/// represents the cluster.
[[nodiscard]] Stabilisation stabilise(const StochasticSubspace& subspace,
                                      const StabilisationOptions& options);

/// Selects modes from the poles of any method. `by_order` holds the poles of the model orders
/// smallest_order, smallest_order + 2, …. The result contains only poles within the limits of the
/// options for frequency and damping ratio.
[[nodiscard]] Stabilisation stabilise(std::vector<std::vector<Pole>> by_order,
                                      const StabilisationOptions& options);

/// A pole chosen by the user: the pole of the model order `order` that is nearest to the stated
/// frequency.
struct ChosenPole {
  int order = 0;
  double frequency_hz = 0.0;
};

/// The error for a chosen pole that the diagram does not contain.
struct ChosenPoleError : std::invalid_argument {
  ChosenPoleError(long which, const std::string& reason)
      : std::invalid_argument(reason), pole(which) {}
  long pole;  ///< index in the list
};

/// Largest distance of a chosen pole from its stated frequency, relative to this frequency. The
/// tolerance is necessary because case files state rounded frequencies, and rounding errors depend
/// on the processor.
inline constexpr double kChosenWithin = 0.005;

/// Replaces the modes by the chosen poles. Each chosen pole represents its cluster, and the cluster
/// becomes a mode. A chosen pole without a cluster becomes a mode by itself. Clusters without a
/// chosen pole are rejected. Throws ChosenPoleError for a model order or a frequency that the
/// diagram does not contain, and for a pole chosen twice.
void choose_poles(Stabilisation& diagram, std::span<const ChosenPole> chosen);

/// Computes the distance d = |Δf| / max f + 1 - MAC of two poles.
[[nodiscard]] double pole_distance(const Pole& a, const Pole& b);

/// Divides the values `sorted` into two classes by least squares. Returns the index of the smallest
/// value in the upper class. Requires at least two values. Public for its test.
[[nodiscard]] std::size_t two_classes(const std::vector<double>& sorted);

}  // namespace wheeltap::signals
