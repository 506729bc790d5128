// What the model leaves out of K, piece by piece, and what that does to modes.
#pragma once

#include <vector>

#include "base/eigen.hpp"
#include "fem/structures/defects/structure_change.hpp"
#include "fem/structures/mesh.hpp"

namespace wheeltap::identification {

/// Pieces of a structure that may each be stiffer or softer than the model has them: the quarters
/// of a member, about (its ends, where joints give, and its middle), and every spring, tie or link
/// by itself. They do not depend on how finely members are meshed, once that is by four elements.
/// What an axial force does (geometric stiffness) is none.
class StiffnessPieces {
 public:
  static constexpr int kOfMember = 4;

  StiffnessPieces() = default;
  /// `mesh`: of members; nullptr of a chain, whose links are its pieces.
  StiffnessPieces(const fem::Discretisation& d, const fem::Mesh* mesh);

  [[nodiscard]] int count() const { return count_; }
  /// φ_jᵀ K_p φ_k by the strains, modes × modes each, of a structure with these strains and perhaps
  /// more (springs of damages are no pieces). `shapes`: n × modes.
  [[nodiscard]] std::vector<Eigen::MatrixXd> energies(const fem::Discretisation& d,
                                                      const Eigen::MatrixXd& shapes) const;
  /// How φᵀ K φ moves with a relative error of what defects lost each piece: of a softening that
  /// leaves q of a strain, q (1 - q) times its energy before. (A piece whose flexibility is 1 + a
  /// of the model's and whose sound part is lost loses (1 - q) a less of its stiffness.)
  [[nodiscard]] std::vector<Eigen::MatrixXd> losses(const fem::Discretisation& intact,
                                                    const fem::StructureChange& change,
                                                    const Eigen::MatrixXd& shapes) const;

 private:
  int count_ = 0;
  std::vector<int> of_strain_;
};

/// With pieces' stiffnesses (1 + a_p) K_p, a_p ~ N(0, σ²), eigenvalues move by φ_jᵀ K_p φ_j a_p and
/// shapes by Σ_k φ_k φ_kᵀ K_p φ_j a_p / (λ_j - λ_k), to first order (Fox & Kapoor 1968, AIAA J.
/// 6:2426): all modes of all states by the same a_p, so that what a wrong stiffness does to a
/// structure does not pass for damage; and what a damage takes from a piece errs by as much, by an
/// error of its own (`StiffnessPieces::losses`). Integrated out: with residuals r in units of the
/// noise and their sensitivities X, ln p gains
///
///   ½ bᵀ (A + I/σ²)⁻¹ b - ½ ln |I + σ² A|,   A = XᵀX, b = Xᵀr
///
/// (the matrix inversion lemma), which is gathered from as many r and X as there are.
class StiffnessErrors {
 public:
  explicit StiffnessErrors(int pieces);

  /// X: numbers × pieces.
  void add(const Eigen::MatrixXd& sensitivities, const Eigen::VectorXd& residual);
  /// What to add to ln p, and to take from χ². σ > 0.
  struct Gain {
    double log_density = 0.0, chi_square = 0.0;
  };
  [[nodiscard]] Gain integrated(double sigma) const;

 private:
  Eigen::MatrixXd a_;
  Eigen::VectorXd b_;
};

}  // namespace wheeltap::identification
