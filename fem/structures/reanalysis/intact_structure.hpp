// Precomputed data of the intact structure. Internal to the reanalysis.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "base/eigen.hpp"
#include "fem/structures/discretisation.hpp"
#include "fem/structures/reanalysis/residual_flexibility.hpp"
#include "fem/structures/reanalysis/structure_spectrum.hpp"
#include "fem/window.hpp"

namespace wheeltap::fem::detail {

/// Limits of the total number n of added springs and removed masses. With these changes, root i is
/// at most intact eigenvalue i + n. If n is at most the largest limit, S is a short sum over the
/// near modes. If n is larger, S is the sum over all modes.
inline constexpr std::array kLifting = {0, 8, 16, 32, 64};
/// The eigenvalue λ assigned to a massless displacement vector ψ (M ψ = 0), divided by the lowest
/// elastic eigenvalue. The value is so large that only the static response in ψ affects results.
inline constexpr double kStaticOnly = 1e30;

struct IntactStructure {
  std::shared_ptr<const Discretisation> discretisation;
  int wanted;          // largest number of modes that a caller can request
  int modes;           // number of kept modes; all modes for a small structure
  int massive;         // number of kept modes with mass
  int rigid;           // number of modes at λ = 0
  std::size_t stride;  // `modes`, but at least two
  std::vector<double> eigenvalues, scales, compliances;  // stride
  std::vector<double> frequencies;                       // wanted
  std::vector<double> dof_rows;                          // n × stride
  std::vector<double> strain_rows;                       // strains × stride
  Eigen::MatrixXd self_stresses;  // strains × strains; only if all modes are kept
  bool compressed = false;        // true if the geometric stiffness of a compressed member reduces
                                  // K
  std::vector<Window> windows;    // one window per entry of kLifting, and one for larger numbers
  std::unique_ptr<const ResidualFlexibility> residual;  // sum over the modes that are not kept
  double next = 0.0;  // the lowest eigenvalue of the modes that are not kept

  /// Throws the exceptions of the constructor of StructureReanalysis.
  IntactStructure(std::shared_ptr<const Discretisation> given, int wanted_modes, int kept_modes);

  /// Returns the window for changes that do not raise root i above the intact eigenvalue with the
  /// index i + `lifting`.
  [[nodiscard]] const Window& window_for(int lifting) const {
    const auto at = std::ranges::lower_bound(kLifting, lifting);
    return windows[static_cast<std::size_t>(at - kLifting.begin())];
  }
  /// Writes the displacement row · φ for each mode φ to `out` (`stride` numbers).
  void motion(const SparseRow& row, double* out) const;

 private:
  StructureSpectrum kept_spectrum(int kept);
};

}  // namespace wheeltap::fem::detail
