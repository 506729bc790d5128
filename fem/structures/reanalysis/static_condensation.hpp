// A structure cut into small parts and the boundary between them, so that a load on one part is met
// by a local motion and forces on its edge.
#pragma once

#include <array>
#include <vector>

#include "base/eigen.hpp"
#include "base/eigen_solvers.hpp"
#include "fem/structures/discretisation.hpp"

namespace wheeltap::fem {

/// Degrees of freedom I of a part and E of its edge, those outside that K or M couple it with. With
/// f any load on a part and its edge,
///
///   l₀ = K_II⁻¹ f_I,            r₀ = f_E - K_EI l₀,
///   l_n = K_II⁻¹ M_II l_{n-1},  r_n = M_EI l_{n-1} - K_EI l_n,
///
/// so that exactly f = K l₀ + r₀ and M l_{n-1} = K l_n + r_n, l moving nothing but the part's
/// inside and r acting on its edge alone (static condensation; Guyan 1965, AIAA J. 3:380). K_II is
/// summed from the strains in extended precision, as K l is of them.
///
/// Parts are the insides of members: degrees of freedom that are coupled with two ends at most,
/// halved along the member until there are no more than `kLargest` and all eigenvalues of a part
/// alone, its edge held, lie above `stiffer_than`. For l_n grows by their inverse, and what is then
/// taken out of sums with it cancels. What is left is the boundary, the degrees of freedom that
/// hold a free structure among it.
class StaticCondensation {
 public:
  static constexpr int kLargest = 36;
  /// n of l_n and r_n: 0 … 3.
  static constexpr int kTerms = 4;

  /// `stiffer_than` [rad²/s²], finite.
  StaticCondensation(const Discretisation& d, double stiffer_than);

  /// Dofs of the boundary, ascending.
  [[nodiscard]] const std::vector<int>& boundary() const { return boundary_; }
  [[nodiscard]] int parts() const { return static_cast<int>(parts_.size()); }

  struct Local {
    int part = -1;                                            ///< -1: acts on the boundary alone
    std::vector<int> inside = {};                             ///< dofs of the part
    std::vector<int> edge = {};                               ///< places in `boundary`
    Eigen::VectorXd load = {};                                ///< f_I
    std::array<Eigen::VectorXd, kTerms> motion, forces = {};  ///< l_n, r_n
  };
  /// Of a load on one part and its edge. Throws std::invalid_argument for any other.
  [[nodiscard]] Local local(const SparseRow& load) const;

 private:
  using Wide = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  struct Part {
    std::vector<int> inside, edge;  // dofs; places in the boundary
    Eigen::LDLT<Wide> stiffness;
    Wide edge_stiffness;              // edge × inside
    Eigen::MatrixXd mass, edge_mass;  // inside × inside, edge × inside
  };

  std::vector<int> boundary_;
  std::vector<int> part_of_, place_;  // of each dof: its part or -1, its place in that or boundary_
  std::vector<Part> parts_;
};

}  // namespace wheeltap::fem
