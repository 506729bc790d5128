// Computation of the eigenvalues of the damaged structure as roots of the secular problem, with
// proven error bounds. Internal to the reanalysis.
#pragma once

#include <span>
#include <vector>

#include "fem/secular.hpp"
#include "fem/window.hpp"

namespace wheeltap::fem::detail {

/// Proven bound of the relative error of a root, apart from rounding errors.
inline constexpr double kConfirmed = 1e-12;

/// Result of one evaluation of the secular problem for one root.
struct Found {
  double lambda = 0.0;  ///< the Rayleigh quotient
  double radius = 0.0;  ///< an eigenvalue lies between lambda - radius and lambda + radius
  double at = 0.0;      ///< the λ at which the secular problem was evaluated
  int below = 0;        ///< number of eigenvalues below `at`
};

/// The intact modes, and those properties of the defects that determine bounds of the roots. The
/// caller owns the arrays.
struct SecularProblem {
  const double* eigenvalues;  ///< `stride` eigenvalues, ascending
  const double* scales;       ///< s_j
  std::size_t stride;         ///< distance between columns: the larger of 2 and the number of modes
  int modes;
  const Window* window;
  int added_poles = 0;           ///< number of floating masses, the first `eigenvalues`
  int negative_poles = 0;        ///< number of floating masses with negative mass, which come first
  double residual_factor = 1.0;  ///< Secular::residual_factor
  int columns;
  int supports;                         ///< number of support columns, which come first
  int held;                             ///< number of degrees of freedom that the supports remove
  double least_remaining;               ///< root i is at least least_remaining · λ_i; may be 0
  double added_stiffness;               ///< stiffness of the springs, a bound of the increase of
                                        ///< any root
  const double* c;                      ///< columns × stride
  std::span<const double> starts = {};  ///< initial value of each root; empty: first-order estimate
};

/// Finds eight roots at a time, each in a SIMD lane of `SecularKernel`. Eigenvalue counts by the
/// inertia of S bracket each root. From a first-order estimate, Rayleigh quotients converge
/// quadratically to the root.
///
/// A root is accepted if r² / gap is at most 2e-13, where r is the residual and gap an estimate of
/// the distance to the next eigenvalue. Afterwards, RootSearch proves an error bound. Each root has
/// an interval that contains at least one eigenvalue. Suppose that b of these intervals are
/// disjoint and lie below a value λ, and that exactly b eigenvalues lie below λ according to the
/// inertia of S. Then each interval contains exactly one eigenvalue, and the gap is the distance of
/// this eigenvalue to the others. Thus
///
///   |λ - lambda| <= r² / gap (Temple 1928; Parlett 1998, The Symmetric Eigenvalue Problem, section
///   10.5)
///
/// is proven for nearly every root without another evaluation. If the relative error bound of a
/// root exceeds `kConfirmed`, counts of eigenvalues at λ (1 ± kConfirmed) confirm the root. If the
/// counts do not confirm the root, bisection follows.
class RootSearch {
 public:
  /// Sets the secular problem. The caller must call this function for each set of defects.
  /// RootSearch keeps pointers to `kernel` and to the arrays of `problem`.
  void set(const SecularProblem& problem, const SecularKernel& kernel);

  /// Writes the eigenvalues with the indices first … lambda.size() - 1 to `lambda`; the eigenvalues
  /// before `first` are zero.
  void find(int first, std::span<double> lambda);

  /// The mode shape that belongs to one root: its components along the two nearest intact modes,
  /// and the forces η of `DefectColumns`.
  struct Mode {
    int root;
    double lambda;
    int pole;
    double a1, a2;
    std::span<double> eta;
    bool found;  ///< false if no pair of intact modes determines the mode shape
  };
  /// Calls visit(mode) for each root from `first` on, in order.
  template <class Visit>
  void modes(int first, std::span<const double> lambda, Visit&& visit);

  /// Writes the component of the mode shape along intact mode j to coordinates[j].
  void coordinates(const Mode& mode, double* coordinates) const;

 private:
  /// State of the refinement of one root in one SIMD lane.
  struct Search {
    int root = -1;   // index (from 0) of the eigenvalue; -1 if the lane is idle
    double z = 0.0;  // next λ at which the secular problem is evaluated
    double low = 0.0, high = 0.0;
    int evaluations = 0;
    bool confirming = false;  // true while the root waits for confirmation
    double lambda = 0.0;      // approximate root that waits for confirmation
  };

  [[nodiscard]] Search begin(int root) const;
  [[nodiscard]] Search confirm(int root) const;
  void run(bool confirming);
  [[nodiscard]] int lower_pole(double z, int guess) const;
  void evaluate(const Pack& z, const int (&poles)[kLanes]);
  [[nodiscard]] int first_followed(int below, int lane) const;
  [[nodiscard]] int left_out_below(double z, int pole) const;
  [[nodiscard]] int count_below(int pole, int lane) const;
  [[nodiscard]] bool counts(int lane) const;
  [[nodiscard]] bool tells_shape(int root, double lambda, int pole, int lane) const;
  [[nodiscard]] int pole_of_shape(double lambda) const;
  static void narrow(Search& search, double z, int below);
  [[nodiscard]] static double cut(const Search& search, int part, int parts);
  [[nodiscard]] bool advance(Search& search, int pole, int lane);
  [[nodiscard]] bool advance_confirmation(Search& search, bool followed, double next) const;
  [[nodiscard]] Found& found(int root) { return found_[static_cast<std::size_t>(root)]; }
  [[nodiscard]] const Found& found(int root) const {
    return found_[static_cast<std::size_t>(root)];
  }
  void queue_unproven(int first, int count, int total);
  Mode mode_at(int root, double lambda, int pole, int lane);
  void reserve();

  SecularProblem problem_{};
  const SecularKernel* kernel_ = nullptr;
  Secular secular_;
  SecularScratch scratch_;  // parts of `packs_`
  SecularSteps steps_;
  std::vector<Pack> packs_;
  std::vector<double> pairs_, product_, eta_;
  std::vector<Found> found_;  // one entry per root, and one additional entry
  std::vector<int> queue_;
  int last_ = 0;  // index of the root after the requested roots, evaluated once; -1: none
};

template <class Visit>
void RootSearch::modes(int first, std::span<const double> lambda, Visit&& visit) {
  const int count = static_cast<int>(lambda.size());
  for (int root = first; root < count; root += kLanes) {
    Pack z;
    int poles[kLanes];
    const auto at = [&](int l) { return root + l < count ? root + l : root; };
    for (int l = 0; l < kLanes; ++l) {
      z.lane[l] = lambda[static_cast<std::size_t>(at(l))];
      poles[l] = lower_pole(z.lane[l], at(l));
    }
    evaluate(z, poles);
    bool all = true;
    for (int l = 0; l < kLanes; ++l) {
      if (tells_shape(at(l), z.lane[l], poles[l], l)) continue;
      all = false;
      poles[l] = pole_of_shape(z.lane[l]);
    }
    if (!all) evaluate(z, poles);
    for (int l = 0; l < kLanes && root + l < count; ++l)
      visit(mode_at(root + l, z.lane[l], poles[l], l));
  }
}

}  // namespace wheeltap::fem::detail
