// Stiffness errors of parts of the structure, and the effect of these errors on modes.
#pragma once

#include <vector>

#include "base/eigen.hpp"
#include "fem/structures/defects/structure_change.hpp"
#include "fem/structures/mesh.hpp"

namespace wheeltap::identification {

/// Parts of a structure with independent stiffness errors: the quarters of each member (its ends,
/// where joints are flexible, and its middle), and each spring, tie and chain link. An element that
/// lies in two quarters belongs to both, in proportion to the lengths, so that parts are symmetric
/// and do not depend on the mesh. Members with fewer than four elements have one part per element.
/// The geometric stiffness of axial forces is not a part.
class StiffnessPieces {
 public:
  static constexpr int kOfMember = 4;

  StiffnessPieces() = default;
  /// `mesh` is the mesh of a structure with members; nullptr for a chain of masses, whose parts are
  /// its links.
  StiffnessPieces(const fem::Discretisation& d, const fem::Mesh* mesh);

  [[nodiscard]] int count() const { return count_; }
  /// Matrices φ_jᵀ K_p φ_k (modes × modes) of all parts p, from strain components. Further strain
  /// components (springs of damages) belong to no part. `shapes` is n × modes.
  [[nodiscard]] std::vector<Eigen::MatrixXd> energies(const fem::Discretisation& d,
                                                      const Eigen::MatrixXd& shapes) const;
  /// Sensitivity of φᵀ K φ to a relative error of the stiffness that defects remove from each part.
  /// If a defect reduces the stiffness of a strain component to the fraction q, the sensitivity is
  /// q (1 - q) times the energy of the component before the reduction. Reason: if the flexibility
  /// of a part is 1 + a times that of the model, the lost fraction of its stiffness is smaller by q
  /// (1 - q) a.
  [[nodiscard]] std::vector<Eigen::MatrixXd> losses(const fem::Discretisation& intact,
                                                    const fem::StructureChange& change,
                                                    const Eigen::MatrixXd& shapes) const;

 private:
  /// A part and the share of a strain component that belongs to it.
  struct Share {
    int piece;
    double of_strain;
  };
  int count_ = 0;
  std::vector<std::vector<Share>> of_strain_;
};

/// Marginalises the likelihood over stiffness errors. With stiffnesses (1 + a_p) K_p, a_p ~ N(0,
/// σ²), eigenvalues change by φ_jᵀ K_p φ_j a_p and shapes by Σ_k φ_k φ_kᵀ K_p φ_j a_p / (λ_j -
/// λ_k), to first order (Fox & Kapoor 1968, AIAA J. 6:2426). All modes of all states share the a_p,
/// so that the likelihood does not attribute stiffness errors to damage. The stiffness that
/// damage removes from a part has a separate relative error, with sd σ (`StiffnessPieces::losses`).
/// Let r be residuals in units of the noise, and X their sensitivities. ln p then increases by
///
///   ½ bᵀ (A + I/σ²)⁻¹ b - ½ ln |I + σ² A|,   A = XᵀX, b = Xᵀr
///
/// (matrix inversion lemma). A and b are sums over all added residuals r and sensitivities X.
class StiffnessErrors {
 public:
  explicit StiffnessErrors(int pieces);

  /// Adds residuals r and their sensitivities X (residuals × errors).
  void add(const Eigen::MatrixXd& sensitivities, const Eigen::VectorXd& residual);
  /// Changes due to stiffness errors with σ > 0: `log_density` is added to ln p, and `chi_square`
  /// is subtracted from χ².
  struct Gain {
    double log_density = 0.0, chi_square = 0.0;
  };
  [[nodiscard]] Gain integrated(double sigma) const;

 private:
  Eigen::MatrixXd a_;
  Eigen::VectorXd b_;
};

}  // namespace wheeltap::identification
