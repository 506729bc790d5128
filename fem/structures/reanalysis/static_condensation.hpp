// Partition of a structure into small parts (substructures) and the boundary between them. A load
// on one part is equivalent to displacements of the interior of the part and forces on its edge.
#pragma once

#include <array>
#include <vector>

#include "base/eigen.hpp"
#include "base/eigen_solvers.hpp"
#include "fem/structures/discretisation.hpp"

namespace wheeltap::fem {

/// A part has interior degrees of freedom I. The edge E of the part consists of the degrees of
/// freedom outside I that K or M couples with I. For any load f on a part and its edge,
///
///   l₀ = K_II⁻¹ f_I,            r₀ = f_E - K_EI l₀,
///   l_n = K_II⁻¹ M_II l_{n-1},  r_n = M_EI l_{n-1} - K_EI l_n,
///
/// so that f = K l₀ + r₀ and M l_{n-1} = K l_n + r_n exactly. The displacements l are nonzero only
/// in the interior, and the forces r act only on the edge (static condensation; Guyan 1965, AIAA J.
/// 3:380). K_II and K l are summed from the strains in extended precision.
///
/// Parts are the interiors of members: degrees of freedom that are coupled with at most two ends. A
/// part is divided in two along the member until each piece has at most `kLargest` degrees of
/// freedom, and all eigenvalues of each piece with fixed edge lie above `stiffer_than`. The
/// displacements l_n grow with the inverse of these eigenvalues, and large l_n would cause
/// cancellation. All other degrees of freedom, and the `holding_dofs` of a free structure, form the
/// boundary.
class StaticCondensation {
 public:
  static constexpr int kLargest = 36;
  /// Number of displacement vectors l_n and of force vectors r_n: n = 0 … 3.
  static constexpr int kTerms = 4;

  /// Divides a structure into parts and a boundary. `stiffer_than` [rad²/s²] must be finite.
  StaticCondensation(const Discretisation& d, double stiffer_than);

  /// Degrees of freedom of the boundary, ascending.
  [[nodiscard]] const std::vector<int>& boundary() const { return boundary_; }
  [[nodiscard]] int parts() const { return static_cast<int>(parts_.size()); }

  struct Local {
    int part = -1;                                            ///< index of the part; -1: no part,
                                                              ///< only the boundary
    std::vector<int> inside = {};                             ///< degrees of freedom of the part
    std::vector<int> edge = {};                               ///< indices into `boundary`
    Eigen::VectorXd load = {};                                ///< f_I
    std::array<Eigen::VectorXd, kTerms> motion, forces = {};  ///< l_n, r_n
  };
  /// Condenses a load on one part and its edge. Throws std::invalid_argument for any other load.
  [[nodiscard]] Local local(const SparseRow& load) const;

 private:
  using Wide = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  struct Part {
    std::vector<int> inside, edge;  // degrees of freedom; indices into the boundary
    Eigen::LDLT<Wide> stiffness;
    Wide edge_stiffness;              // edge × inside
    Eigen::MatrixXd mass, edge_mass;  // inside × inside, edge × inside
  };

  std::vector<int> boundary_;
  std::vector<int> part_of_,
      place_;  // per degree of freedom: its part or -1; its index in the part or in boundary_
  std::vector<Part> parts_;
};

}  // namespace wheeltap::fem
