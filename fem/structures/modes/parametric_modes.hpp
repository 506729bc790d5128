// Computation of the lowest modes of a parametric structure by a reduced basis, with an error bound
// for each result.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/eigen.hpp"
#include "fem/structures/modes/parametric_structure.hpp"

namespace wheeltap::fem {

/// Method that computes the modes at one θ.
enum class ParametricSolver {
  cheaper,  ///< the cheaper of `basis` and `sparse`
  basis,    ///< reduced basis: modes at selected θ
  /// Sparse matrices if K and M are affine in θ, without rigid-body motions and with at most 2000
  /// degrees of freedom; otherwise a basis.
  sparse
};

struct ParametricModesOptions {
  int modes = 1;  ///< number of lowest elastic modes
  /// The requested components of mode shapes, as linear forms of the degrees of freedom.
  std::vector<SparseRow> motions = {};
  double tolerance = 1e-7;        ///< largest relative error of an eigenvalue
  double shape_tolerance = 1e-3;  ///< largest sine of the angle between computed and true shape,
                                  ///< in the energy norm
  int most_basis = 400;           ///< largest number of columns of the basis
  int complete = 60;              ///< up to this number of degrees of freedom, the basis is
                                  ///< complete
  ParametricSolver solver = ParametricSolver::cheaper;
  std::function<void(double)> progress = {};  ///< called with the completed fraction of the
                                              ///< training
};

/// Solves K(θ) φ = λ M(θ) φ from the sparse matrices (`SparseModes`), or by Rayleigh-Ritz on a
/// basis V of modes at selected θ. Each training step solves the full problem at the training point
/// with the largest error bound, and adds the modes of this solution to the basis (greedy reduced
/// bases for eigenproblems: Horger, Wohlmuth & Dickopf 2017, section 4). The initial basis contains
/// the responses to the low-rank terms, (K₀ + σM₀)⁻¹ C.
///
/// Every computed eigenvalue λ has an error bound. Let u be the Ritz vector, scaled so that
/// uᵀ(K + σM)u = λ + σ, and let r = K u - λ M u be the residual. Then
///
///   η = ‖r‖_(K + σM)⁻¹ / √(λ + σ)  ≤  ‖r‖_(K₀ + σM)⁻¹ / √(α (λ + σ))
///
/// is a bound of the relative error of 1/(λ + σ) (Weinstein). Low-rank terms are added to K₀
/// exactly. A second bound of this error is η²/gap (Temple and Kato), where gap is the relative
/// distance to the rest of the spectrum. Modes whose relative eigenvalue spacing is below
/// `kCluster` have the bound of their common subspace (Mathias 1998, theorem 1): Σ η² / gap. σ = 0
/// unless there are rigid-body motions. The sine of the angle between a computed and the true shape
/// is at most η/gap. If an error bound exceeds its tolerance, structure_modes solves the full
/// problem.
///
/// The error bounds prove that an exact eigenvalue lies near each result. The bounds do not prove
/// that no mode is missing. Sturm counts check for missing modes at every training point during the
/// training. After the training, solutions by the reduced basis are not checked for missing modes.
/// Every solution from sparse matrices is checked by a Sturm count. Degrees of freedom without mass
/// need no special treatment, because V includes their static response.
///
/// The object is immutable after construction; each thread needs a separate workspace.
class ParametricModes {
 public:
  class Workspace;

  /// Trains the basis. `training` holds the training points θ, for example draws from the prior
  /// distribution. Throws the exceptions of `structure_modes` at θ₀.
  ParametricModes(std::shared_ptr<const ParametricStructure> structure,
                  const std::vector<std::vector<double>>& training, ParametricModesOptions options);
  ~ParametricModes();
  ParametricModes(ParametricModes&&) noexcept;
  ParametricModes& operator=(ParametricModes&&) noexcept;

  struct Modes {
    Eigen::VectorXd eigenvalues;  ///< eigenvalues of the elastic modes [rad²/s²], ascending
    Eigen::MatrixXd shapes;       ///< motions × modes: mass-normalised; the sign of a shape is
                                  ///< arbitrary
    Eigen::VectorXd bounds;       ///< relative error bounds of the eigenvalues
    Eigen::VectorXd
        shape_bounds;      ///< bounds of the sines of the angles between computed and true shapes
    bool in_full = false;  ///< true if the full problem was solved
    /// The matrix (modes × modes) of modal stiffnesses φ_jᵀ K_p φ_k of each part p of the
    /// structure; then, for each part, the matrix of derivatives of φ_jᵀ K φ_k with respect to the
    /// relative error of the stiffness that damage removes. The caller computes these matrices.
    std::vector<Eigen::MatrixXd> pieces = {};
    double stiffer = 1.0;  ///< factor that the caller applied to the whole stiffness (temperature)
  };
  /// Derivatives ∂λ/∂θ (modes × parameters), and ∂shapes/∂θ_j (one matrix, motions × modes, per
  /// parameter).
  struct Slopes {
    Eigen::MatrixXd eigenvalues;
    std::vector<Eigen::MatrixXd> shapes;
  };

  [[nodiscard]] Workspace make_workspace() const;
  /// Computes the modes at θ. Throws the exceptions of StructureFamily::at and `structure_modes` if
  /// no valid structure exists at θ.
  void solve(std::span<const double> theta, Workspace& workspace, Modes& out) const;
  /// Computes the modes and their derivatives at θ. The derivatives of eigenvalues are ∂λ = φᵀ(∂K -
  /// λ ∂M)φ; those of shapes follow from Nelson's method (1976). For modes with a relative
  /// eigenvalue spacing below 1e-6, the derivatives of shapes exclude the indeterminate rotation
  /// within the subspace of these modes. If the full problem was solved, the reduced basis is used
  /// for the derivatives. Returns false, without derivatives, if the matrices are not affine in θ,
  /// or if the solution by the basis or by sparse matrices failed.
  bool differentiate(std::span<const double> theta, Workspace& workspace, Modes& out,
                     Slopes& slopes) const;

  /// Summary of the training of the basis.
  struct Training {
    int basis = 0;          ///< number of columns of the basis; for a complete basis, the number of
                            ///< degrees of freedom
    bool complete = false;  ///< true if the basis is complete or not used
    int points = 0;         ///< number of training points with a valid structure
    int solved = 0;         ///< number of full problems solved to build the basis
    double largest_bound = 0.0;  ///< largest error bound of an eigenvalue over the training set
    int beyond = 0;              ///< number of training points whose error bounds still exceed the
                                 ///< tolerances
    int miscounted = 0;  ///< number of training points at which a Sturm count gives a different
                         ///< number of modes
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
  [[nodiscard]] long solved() const;          ///< number of solutions
  [[nodiscard]] long solved_in_full() const;  ///< number of solutions of the full problem

 private:
  friend class ParametricModes;
  struct Impl;
  explicit Workspace(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace wheeltap::fem
