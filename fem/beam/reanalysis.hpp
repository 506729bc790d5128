// Exact computation of the natural frequencies of a beam with a few defects, from the modes of the
// intact beam.
#pragma once

#include <memory>
#include <span>

#include "fem/beam/beam.hpp"
#include "fem/beam/defect.hpp"

namespace wheeltap::fem {

/// A damaged element changes K by a matrix of rank 2, and a support by a matrix of rank 1. If the
/// columns of C span these changes, the frequencies of the beam with s defects are the roots of a
/// small secular problem
///
///   det S(λ) = 0,   S(λ) = Σ - |Γ|½ Cᵀ (K - λ M)⁻¹ C |Γ|½,   Σ = sign Γ.
///
/// The number of eigenvalues of the damaged beam below λ is the number of intact eigenvalues below
/// λ, plus the negative inertia of S(λ), minus the number of supports (Wittrick & Williams 1971;
/// Haynsworth 1968). This count brackets every root, so the method neither misses nor interchanges
/// modes.
///
/// Apart from rounding, every root has a proven relative error of at most 1e-12 (`RootSearch`);
/// `error_bound` bounds the rounding error. The only truncation error, 1e-17, is that of a
/// Chebyshev series for modes far above the requested ones. From a first-order estimate, the search
/// for a root needs on average 1.8 evaluations of S for one damaged element, and 2.4 for six.
/// Initial values from a previous call, e.g. in a Markov chain, are not used: they would save
/// little time and make results depend on earlier calls.
///
/// The object is immutable after construction. Any number of threads may share the object; each
/// thread needs a separate workspace.
class Reanalysis {
 public:
  class Workspace;

  /// Computes all modes of the intact beam once (`full_spectrum`). `modes` is the largest number of
  /// lowest frequencies that a caller can request, rigid-body modes included. Throws
  /// std::invalid_argument for an invalid beam or more modes than free degrees of freedom.
  Reanalysis(const Beam& beam, int modes);
  ~Reanalysis();
  Reanalysis(Reanalysis&&) noexcept;
  Reanalysis& operator=(Reanalysis&&) noexcept;

  /// An observed displacement: the deflection or rotation at one location.
  struct Point {
    double at;  ///< x [m] in [0, L]
    bool rotation = false;
  };

  /// Output of `solve`. `solve` computes a result only if the span for this result is not empty.
  /// Matrices are row-major, with one row per mode.
  struct Results {
    std::span<double> frequencies_hz;  ///< the n <= modes() lowest frequencies, ascending
    /// n × damages: ∂f/∂r for the reduction r of each listed damage, with the other defects fixed
    /// [Hz].
    std::span<double> damage_gradients_hz;
    /// n × elements: ∂f/∂r at r = 0 for an additional damage in each element, with all listed
    /// defects present [Hz].
    std::span<double> element_gradients_hz;
    /// n × points: mass-normalised shapes. The largest entry of a shape (the first of several equal
    /// entries) is positive.
    std::span<double> shapes;
    std::span<const Point> points;  ///< locations at which shapes are requested
    /// n × supports: ∂f/∂k for the stiffness k of each listed support, with the other defects fixed
    /// [Hz per N/m or N·m/rad]. 0 for a rigid support, and for a support at an already restrained
    /// displacement.
    std::span<double> support_gradients_hz = {};
  };

  /// Output of `location_slopes`, which computes only the results whose span is not empty. Matrices
  /// are row-major, with one row per mode.
  struct LocationSlopes {
    int modes;                        ///< n <= modes(): number of lowest modes
    std::span<double> damages_hz_m;   ///< n × damages
    std::span<double> supports_hz_m;  ///< n × supports
  };

  /// Returns an upper bound of the relative error of the frequency `frequency_hz` with these
  /// defects, with respect to exact arithmetic on the same mesh:
  ///
  ///   1e-10 + 1e-16 k/k_beam + 4e-15 (1/q + λ_1/λ).
  ///
  /// Here, k is the stiffness of the stiffest added spring, k_beam is the stiffness of the beam at
  /// this spring, and λ_1 is the lowest elastic eigenvalue of the intact beam. The most damaged
  /// element keeps the fraction q = Π (1 - r) of its stiffness. The last term of the error bound is
  /// relevant only in two cases. In the first case, added supports restrain a free beam, and the
  /// effect of hinges and soft springs on the compliance nearly cancels that of the supports. In
  /// the second case, the number of modes of the finite-element model only slightly exceeds the
  /// number of strain-displacement vectors of the damaged elements. The form of this error bound
  /// follows from an analysis of rounding errors. The factors of the bound are chosen such that the
  /// bound holds for 4000 random beams (tests/fem/random_beams_test.cpp).
  [[nodiscard]] double error_bound(std::span<const Damage> damages,
                                   std::span<const SpringSupport> supports, double frequency_hz,
                                   Workspace& workspace) const;

  [[nodiscard]] Workspace make_workspace() const;
  [[nodiscard]] int modes() const;
  [[nodiscard]] int rigid_body_modes() const;  ///< number of rigid-body modes of the intact beam
  [[nodiscard]] const Beam& beam() const;
  /// Returns the natural frequencies of the intact beam [Hz], ascending.
  [[nodiscard]] std::span<const double> intact_frequencies_hz() const;

  /// Writes the `out.size()` <= modes() lowest frequencies [Hz] of the beam with these defects,
  /// ascending. Throws std::invalid_argument for a defect outside the beam or with a value out of
  /// range.
  void frequencies_hz(std::span<const Damage> damages, std::span<const SpringSupport> supports,
                      Workspace& workspace, std::span<double> out) const;

  /// Computes natural frequencies, their gradients and mode shapes. The gradients are modal strain
  /// energies:
  ///
  ///   ∂λ/∂γ = -(Cᵀφ)² = -(Γ⁻¹ η)²,   (Γ⁻¹ - F(λ)) η = 0,   φ = Σ_j φ_j c_jᵀ η / (λ_j - λ),
  ///
  /// For a mass-normalised mode, ∂λ/∂γ = φᵀ (∂K/∂γ) φ (Fox & Kapoor 1968, AIAA Journal 6:2426,
  /// equation 5). A spring has γ = -k. The gradients take negligible additional run time. For a
  /// multiple eigenvalue, the gradients are those of one basis of its eigenspace. Throws
  /// std::invalid_argument in the same cases as `frequencies_hz`, and if a span has the wrong size.
  /// Throws std::runtime_error if a mode shape cannot be separated from other mode shapes.
  void solve(std::span<const Damage> damages, std::span<const SpringSupport> supports,
             Workspace& workspace, const Results& results) const;

  /// Computes the slope of the frequencies with respect to the location of each defect, with the
  /// other defects fixed [Hz/m]. Each slope is a difference quotient of exact frequencies at two
  /// locations. A damage covers a whole element. Frequencies are therefore piecewise constant in
  /// the location of the damage, and ∂f/∂x is zero almost everywhere. For a damage, the two
  /// locations are the midpoints of the two neighbouring elements. For an element at an end of the
  /// beam, the locations are the midpoints of this element and its neighbour. The slope is 0 for a
  /// beam of one element. A support acts at a point. The two locations are 10⁻³ element
  /// lengths on either side of the support, but not outside the beam. Throws the exceptions of
  /// `solve`.
  void location_slopes(std::span<const Damage> damages, std::span<const SpringSupport> supports,
                       Workspace& workspace, const LocationSlopes& slopes) const;

 private:
  struct Impl;
  struct Solver;
  std::unique_ptr<const Impl> impl_;
};

/// Scratch memory for the calls of one thread; move-only.
class Reanalysis::Workspace {
 public:
  Workspace(Workspace&&) noexcept;
  Workspace& operator=(Workspace&&) noexcept;
  ~Workspace();

 private:
  friend class Reanalysis;
  struct Impl;
  explicit Workspace(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace wheeltap::fem
