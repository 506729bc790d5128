// The lowest modes of a parametric structure: a reduced basis with an error bound for each result.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/eigen.hpp"
#include "fem/structures/modes/parametric_structure.hpp"

namespace wheeltap::fem {

struct ParametricModesOptions {
  int modes = 1;  ///< number of lowest elastic modes
  /// The requested shape components, as linear forms of the degrees of freedom.
  std::vector<SparseRow> motions = {};
  double tolerance = 1e-7;        ///< relative error of an eigenvalue
  double shape_tolerance = 1e-3;  ///< sine of the angle to the true shape, in the energy norm
  int most_basis = 400;           ///< largest number of columns of the basis
  int complete = 60;              ///< no reduction up to this number of degrees of freedom
  std::function<void(double)> progress = {};  ///< receives the share of the training, 0 to 1
};

/// Solves K(θ) φ = λ M(θ) φ by Rayleigh-Ritz on a basis V of modes at selected θ. Each step solves
/// the full problem at the training point with the largest error and adds its modes to the basis
/// (greedy reduced bases for eigenproblems: Horger, Wohlmuth & Dickopf 2017, section 4). The basis
/// contains the response to the low-rank terms, (K₀ + σM₀)⁻¹ C, from the start.
///
/// Every result has an error bound. With a Ritz vector u, uᵀ(K + σM)u = λ + σ, and r = K u - λ M u,
///
///   η = ‖r‖_(K + σM)⁻¹ / √(λ + σ)  ≤  ‖r‖_(K₀ + σM)⁻¹ / √(α (λ + σ))
///
/// bounds the relative error of 1/(λ + σ) (Weinstein; low-rank terms are added to K₀ exactly). So
/// does η²/gap (Temple and Kato), where gap is the relative distance to the rest of the spectrum.
/// Modes closer than `kCluster` share the bound of their common subspace (Mathias 1998, theorem 1):
/// Σ η² / gap. σ = 0 unless there are rigid-body motions. The sine of the angle between a shape and
/// the true one is at most η/gap. If the bounds exceed the tolerances, the full structure is solved
/// (structure_modes).
///
/// The bounds prove that a mode lies near each result, not that no mode is missing. Sturm counts
/// check that at every training point during training, not at each later call. Degrees of freedom
/// without mass need no special treatment, because V includes how they follow.
///
/// Immutable after construction; each thread needs its own workspace.
class ParametricModes {
 public:
  class Workspace;

  /// `training`: values of θ, for example draws from the prior. Throws as `structure_modes` at θ₀.
  ParametricModes(std::shared_ptr<const ParametricStructure> structure,
                  const std::vector<std::vector<double>>& training, ParametricModesOptions options);
  ~ParametricModes();
  ParametricModes(ParametricModes&&) noexcept;
  ParametricModes& operator=(ParametricModes&&) noexcept;

  struct Modes {
    Eigen::VectorXd eigenvalues;  ///< elastic ones [rad²/s²], ascending
    Eigen::MatrixXd shapes;       ///< motions × modes: mass-normalised, of any sign
    Eigen::VectorXd bounds;       ///< relative error bounds of the eigenvalues
    Eigen::VectorXd
        shape_bounds;      ///< bounds of the sines of the angles between computed and true shapes
    bool in_full = false;  ///< true if solved without the basis
    /// Modal stiffnesses φ_jᵀ K_p φ_k of the pieces p, modes × modes each, then their changes with
    /// errors of the losses by damage in each piece; empty unless requested.
    std::vector<Eigen::MatrixXd> pieces = {};
  };
  /// ∂λ/∂θ: modes × parameters; ∂shapes/∂θ_j: motions × modes each.
  struct Slopes {
    Eigen::MatrixXd eigenvalues;
    std::vector<Eigen::MatrixXd> shapes;
  };

  [[nodiscard]] Workspace make_workspace() const;
  /// Throws like `family.at` and `structure_modes` if there is no structure at θ.
  void solve(std::span<const double> theta, Workspace& workspace, Modes& out) const;
  /// Solves with derivatives: of eigenvalues by ∂λ = φᵀ(∂K - λ ∂M)φ, of shapes by Nelson (1976) in
  /// the basis. Shapes of modes closer than 1e-6 change without the rotation among them, which is
  /// not determined. Where the full structure has to be solved, the derivatives are those of the
  /// basis. Returns false without derivatives if the matrices are not affine in θ.
  bool differentiate(std::span<const double> theta, Workspace& workspace, Modes& out,
                     Slopes& slopes) const;

  /// Summary of the training.
  struct Training {
    int basis = 0;          ///< number of columns; all degrees of freedom if there is no reduction
    bool complete = false;  ///< true if there is no reduction
    int points = 0;         ///< training points at which there is a structure
    int solved = 0;         ///< full solutions for the basis
    double largest_bound = 0.0;  ///< largest error bound of an eigenvalue over the training set
    int beyond = 0;              ///< training points whose bounds still exceed the tolerances
    int miscounted = 0;  ///< training points at which Sturm counts find a different number of modes
  };
  [[nodiscard]] const Training& training() const;
  [[nodiscard]] int modes() const;
  [[nodiscard]] const ParametricStructure& structure() const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

/// Scratch memory of one thread; move-only.
class ParametricModes::Workspace {
 public:
  Workspace(Workspace&&) noexcept;
  Workspace& operator=(Workspace&&) noexcept;
  ~Workspace();
  [[nodiscard]] long solved() const;          ///< number of calls
  [[nodiscard]] long solved_in_full() const;  ///< number of calls solved without the basis

 private:
  friend class ParametricModes;
  struct Impl;
  explicit Workspace(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace wheeltap::fem
