// The lowest modes of a structure whose parameters change: a reduced basis with a checked error.
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
  int modes = 1;  ///< elastic ones, the lowest
  /// What is wanted of shapes, as linear forms of the degrees of freedom.
  std::vector<SparseRow> motions = {};
  double tolerance = 1e-7;        ///< of an eigenvalue, relative
  double shape_tolerance = 1e-3;  ///< sine of the angle to the true shape, in the energy's norm
  int most_basis = 400;           ///< columns of the basis
  int complete = 60;              ///< up to so many degrees of freedom nothing is reduced
  std::function<void(double)> progress = {};  ///< of the training, 0 to 1
};

/// K(θ) φ = λ M(θ) φ by Rayleigh and Ritz on a basis V of modes at chosen θ: at each step the
/// training point with the largest error is solved in full, and its modes join the basis (greedy
/// reduced bases for eigenproblems: Horger, Wohlmuth & Dickopf 2017, section 4). What terms of low
/// rank do is in it from the start, (K₀ + σM₀)⁻¹ C.
///
/// Every answer is checked. With u a Ritz vector, uᵀ(K + σM)u = λ + σ, and r = K u - λ M u,
///
///   η = ‖r‖_(K + σM)⁻¹ / √(λ + σ)  ≤  ‖r‖_(K₀ + σM)⁻¹ / √(α (λ + σ))
///
/// bounds the error of 1/(λ + σ), relative (Weinstein; terms of low rank are added to K₀ as they
/// are); and η²/gap does (Temple and Kato), gap
/// being the relative distance to the rest of the spectrum. Of modes closer than `kCluster` the
/// bound is that of their common subspace (Mathias 1998, theorem 1): Σ η² / gap. σ = 0 unless there
/// are rigid-body motions. The sine of a shape's angle to the true one is at most η/gap. Where the
/// bounds exceed the tolerances, the structure is solved in full (structure_modes).
///
/// Bounds tell that there is a mode near each one found, not that none is missing: that is counted
/// by Sturm at every training point, when the basis is made, and not at each answer. Degrees of
/// freedom without mass need no care: V holds how they follow.
///
/// Immutable after construction; a workspace a thread.
class ParametricModes {
 public:
  class Workspace;

  /// `training`: values of θ, draws of the prior say. Throws as `structure_modes`, at θ₀.
  ParametricModes(std::shared_ptr<const ParametricStructure> structure,
                  const std::vector<std::vector<double>>& training, ParametricModesOptions options);
  ~ParametricModes();
  ParametricModes(ParametricModes&&) noexcept;
  ParametricModes& operator=(ParametricModes&&) noexcept;

  struct Modes {
    Eigen::VectorXd eigenvalues;   ///< elastic ones [rad²/s²], ascending
    Eigen::MatrixXd shapes;        ///< motions × modes: mass-normalised, of any sign
    Eigen::VectorXd bounds;        ///< of the eigenvalues' errors, relative
    Eigen::VectorXd shape_bounds;  ///< of the sines of the shapes' angles
    bool in_full = false;          ///< solved without the basis
    /// φ_jᵀ K_p φ_k of pieces of the structure, modes × modes each, then how it moves with errors
    /// of what damages took from each; empty where nobody asked.
    std::vector<Eigen::MatrixXd> pieces = {};
  };
  /// ∂λ/∂θ: modes × parameters; ∂shapes/∂θ_j: motions × modes each.
  struct Slopes {
    Eigen::MatrixXd eigenvalues;
    std::vector<Eigen::MatrixXd> shapes;
  };

  [[nodiscard]] Workspace make_workspace() const;
  /// Throws as `family.at` and `structure_modes` where there is no such structure.
  void solve(std::span<const double> theta, Workspace& workspace, Modes& out) const;
  /// The same with derivatives: of eigenvalues by ∂λ = φᵀ(∂K - λ ∂M)φ, of shapes by Nelson (1976)
  /// in the basis. False, and no slopes, where the matrices are not affine in θ, the structure had
  /// to be solved in full, or modes are closer than 1e-6.
  bool differentiate(std::span<const double> theta, Workspace& workspace, Modes& out,
                     Slopes& slopes) const;

  /// What the training came to.
  struct Training {
    int basis = 0;               ///< columns; all degrees of freedom where nothing is reduced
    bool complete = false;       ///< nothing is reduced
    int points = 0;              ///< of the training set, those that are structures
    int solved = 0;              ///< in full, for the basis
    double largest_bound = 0.0;  ///< over the training set, of an eigenvalue
    int beyond = 0;              ///< points that would be solved in full all the same
    int miscounted = 0;          ///< points where Sturm counts another number of modes
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
  [[nodiscard]] long solved() const;          ///< calls
  [[nodiscard]] long solved_in_full() const;  ///< of these, without the basis

 private:
  friend class ParametricModes;
  struct Impl;
  explicit Workspace(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace wheeltap::fem
