// Partition of a structure into small parts and the boundary between them. A load on one part is
// equivalent to a local motion and forces on the part's edge.
#pragma once

#include <array>
#include <vector>

#include "base/eigen.hpp"
#include "base/eigen_solvers.hpp"
#include "fem/structures/discretisation.hpp"

namespace wheeltap::fem {

/// A part has interior degrees of freedom I; its edge E are the outside degrees of freedom that K
/// or M couples with I. For any load f on a part and its edge,
///
///   l₀ = K_II⁻¹ f_I,            r₀ = f_E - K_EI l₀,
///   l_n = K_II⁻¹ M_II l_{n-1},  r_n = M_EI l_{n-1} - K_EI l_n,
///
/// so that f = K l₀ + r₀ and M l_{n-1} = K l_n + r_n exactly, where l moves only the interior and r
/// acts only on the edge (static condensation; Guyan 1965, AIAA J. 3:380). K_II is summed from the
/// strains in extended precision, and so is K l.
///
/// Parts are the interiors of members: degrees of freedom coupled with at most two ends. They are
/// halved along the member until they have at most `kLargest` degrees of freedom and all
/// eigenvalues of the part with fixed edge lie above `stiffer_than`. l_n grows with the inverse of
/// these eigenvalues, and large l_n would cancel later. The remaining degrees of freedom form the
/// boundary, including those that hold a free structure.
class StaticCondensation {
 public:
  static constexpr int kLargest = 36;
  /// Number of l_n and r_n: n = 0 … 3.
  static constexpr int kTerms = 4;

  /// `stiffer_than` [rad²/s²], finite.
  StaticCondensation(const Discretisation& d, double stiffer_than);

  /// Dofs of the boundary, ascending.
  [[nodiscard]] const std::vector<int>& boundary() const { return boundary_; }
  [[nodiscard]] int parts() const { return static_cast<int>(parts_.size()); }

  struct Local {
    int part = -1;                                            ///< -1: acts only on the boundary
    std::vector<int> inside = {};                             ///< dofs of the part
    std::vector<int> edge = {};                               ///< indices into `boundary`
    Eigen::VectorXd load = {};                                ///< f_I
    std::array<Eigen::VectorXd, kTerms> motion, forces = {};  ///< l_n, r_n
  };
  /// Condenses a load on one part and its edge. Throws std::invalid_argument for any other load.
  [[nodiscard]] Local local(const SparseRow& load) const;

 private:
  using Wide = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  struct Part {
    std::vector<int> inside, edge;  // dofs; indices into the boundary
    Eigen::LDLT<Wide> stiffness;
    Wide edge_stiffness;              // edge × inside
    Eigen::MatrixXd mass, edge_mass;  // inside × inside, edge × inside
  };

  std::vector<int> boundary_;
  std::vector<int> part_of_,
      place_;  // one per dof: its part or -1; its index in the part or in boundary_
  std::vector<Part> parts_;
};

}  // namespace wheeltap::fem
