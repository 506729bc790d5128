// Frequencies of a beam with a few defects from the modes of the intact one, exactly.
#pragma once

#include <memory>
#include <span>

#include "fem/beam/beam.hpp"
#include "fem/beam/defect.hpp"

namespace wheeltap::fem {

/// A damaged element changes K by rank 2 and a support by rank 1. With the columns of C spanning
/// those changes, the frequencies under s defects are the roots of a small secular problem
///
///   det S(λ) = 0,   S(λ) = Σ - |Γ|½ Cᵀ (K - λ M)⁻¹ C |Γ|½,   Σ = sign Γ,
///
/// and the number of damaged eigenvalues below λ is the intact number plus the negative inertia of
/// S(λ), less the number of supports (Wittrick & Williams 1971; Haynsworth 1968). The count
/// brackets every root, so no mode is missed or swapped.
///
/// Every root is proven within 1e-12 of λ but for rounding (`RootSearch`), and rounding stays below
/// `error_bound`. Nothing is truncated but a Chebyshev series of the modes far above the wanted
/// ones, at 1e-17. A root takes 1.8 (one damage) to 2.4 (six) evaluations of S on average from a
/// first-order start, so a warm start from a chain's last state has little to gain; and the answer
/// would come to depend on what was asked before.
///
/// The object is immutable after construction: any number of threads may use one, each with a
/// workspace of its own.
class Reanalysis {
 public:
  class Workspace;

  /// Solves the intact beam for all its modes, once (`full_spectrum`). `modes` is how many of the
  /// lowest frequencies may be asked for, rigid-body ones included. Throws std::invalid_argument
  /// for an invalid beam or more modes than free degrees of freedom.
  Reanalysis(const Beam& beam, int modes);
  ~Reanalysis();
  Reanalysis(Reanalysis&&) noexcept;
  Reanalysis& operator=(Reanalysis&&) noexcept;

  /// A motion to observe: the deflection, or the rotation, at a place.
  struct Point {
    double at;  ///< x [m] in [0, L]
    bool rotation = false;
  };

  /// Where `solve` writes; what is empty is not computed. Matrices are row-major, a row a mode.
  struct Results {
    std::span<double> frequencies_hz;  ///< n <= modes() lowest, ascending
    /// n × damages: ∂f/∂r of each listed damage, the others held [Hz].
    std::span<double> damage_gradients_hz;
    /// n × elements: ∂f/∂r of a further damage, compounding with those listed, at r = 0 [Hz].
    std::span<double> element_gradients_hz;
    /// n × points: mass-normalised shapes; the sign makes the largest (of equals, the first)
    /// positive.
    std::span<double> shapes;
    std::span<const Point> points;  ///< where the shapes are wanted
    /// n × supports: ∂f/∂k of each listed support, the others held [Hz per N/m or N·m/rad]; 0 of
    /// one that is rigid, or that holds what is held already.
    std::span<double> support_gradients_hz = {};
  };

  /// Where `location_slopes` writes; what is empty is not computed. Row-major, a row a mode.
  struct LocationSlopes {
    int modes;                        ///< n <= modes(): the lowest
    std::span<double> damages_hz_m;   ///< n × damages
    std::span<double> supports_hz_m;  ///< n × supports
  };

  /// Bounds the relative error of a frequency [Hz] under these defects, against exact arithmetic on
  /// the same mesh:
  ///
  ///   1e-10 + 1e-16 k/k_beam + 4e-15 (1/q + λ_1/λ),
  ///
  /// k the stiffest added spring, k_beam the beam's own stiffness at its place, q = Π (1 - r) of
  /// the element with least left, λ_1 the intact beam's lowest elastic eigenvalue. The last term
  /// only of beams that move rigidly by themselves and are held by added supports, where the
  /// compliances of hinges and soft springs cancel against those of the supports, and of meshes
  /// with hardly more modes than damaged strains. How rounding enters is from analysis, the factors
  /// are those that 4000 random beams need (tests/fem/random_beams_test.cpp).
  [[nodiscard]] double error_bound(std::span<const Damage> damages,
                                   std::span<const SpringSupport> supports, double frequency_hz,
                                   Workspace& workspace) const;

  [[nodiscard]] Workspace make_workspace() const;
  [[nodiscard]] int modes() const;
  [[nodiscard]] int rigid_body_modes() const;  ///< of the intact beam
  [[nodiscard]] const Beam& beam() const;
  /// The intact frequencies [Hz], ascending.
  [[nodiscard]] std::span<const double> intact_frequencies_hz() const;

  /// Writes the `out.size()` <= modes() lowest frequencies [Hz] of the beam with these defects,
  /// ascending. Throws std::invalid_argument for a defect outside the beam or out of range.
  void frequencies_hz(std::span<const Damage> damages, std::span<const SpringSupport> supports,
                      Workspace& workspace, std::span<double> out) const;

  /// Frequencies with their gradients and shapes. The gradients are modal strain energies,
  ///
  ///   ∂λ/∂γ = -(Cᵀφ)² = -(Γ⁻¹ η)²,   (Γ⁻¹ - F(λ)) η = 0,   φ = Σ_j φ_j c_jᵀ η / (λ_j - λ),
  ///
  /// φᵀ (∂K/∂γ) φ of a mass-normalised mode (Fox & Kapoor 1968, AIAA Journal 6:2426, equation 5),
  /// γ being -k for a spring; nearly free once the root is known. Those of a multiple eigenvalue
  /// are of one basis of its modes. Throws std::invalid_argument as `frequencies_hz`, and where a
  /// span's size does not fit; std::runtime_error where a shape cannot be told from others.
  void solve(std::span<const Damage> damages, std::span<const SpringSupport> supports,
             Workspace& workspace, const Results& results) const;

  /// How the frequencies change along each defect's place, the others held [Hz/m], by differences
  /// of exact frequencies, two solutions a place. A damage takes a whole element, so that they are
  /// piecewise constant in its place and ∂f/∂x is zero almost everywhere; offered instead is the
  /// slope between the midpoints of the two neighbouring elements (of the element and its only
  /// neighbour at an end; 0 for a beam of one element). A support acts just where it is: the
  /// difference over ± 10⁻³ of an element, cut off at the beam's ends. Throws as `solve`.
  void location_slopes(std::span<const Damage> damages, std::span<const SpringSupport> supports,
                       Workspace& workspace, const LocationSlopes& slopes) const;

 private:
  struct Impl;
  struct Solver;
  std::unique_ptr<const Impl> impl_;
};

/// Scratch memory of one thread; move-only.
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
