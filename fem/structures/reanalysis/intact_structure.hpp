// What the reanalysis keeps of the intact structure. Internal.
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

/// Added springs and lost masses may raise root i as far as intact eigenvalue i + their number; up
/// to these numbers are served by a short sum over the near modes, more by the sum over all.
inline constexpr std::array kLifting = {0, 8, 16, 32, 64};
/// λ of a motion without mass, over the lowest elastic eigenvalue: it has its static part alone.
inline constexpr double kStaticOnly = 1e30;

struct IntactStructure {
  std::shared_ptr<const Discretisation> discretisation;
  int wanted;                                            // lowest modes that may be asked for
  int modes;                                             // kept, all where they are few
  int massive;                                           // of them with mass
  int rigid;                                             // of them at λ = 0
  std::size_t stride;                                    // modes, and at least two
  std::vector<double> eigenvalues, scales, compliances;  // stride
  std::vector<double> frequencies;                       // wanted
  std::vector<double> dof_rows;                          // n × stride
  std::vector<double> strain_rows;                       // strains × stride
  Eigen::MatrixXd self_stresses;                         // strains × strains; where all are kept
  bool compressed = false;      // geometric stiffness takes from that of the strains
  std::vector<Window> windows;  // for each of kLifting, and any number
  std::unique_ptr<const ResidualFlexibility> residual;  // of the modes that are not kept
  double next = 0.0;                                    // the lowest eigenvalue of those

  /// As the constructor of StructureReanalysis.
  IntactStructure(std::shared_ptr<const Discretisation> given, int wanted_modes, int kept_modes);

  /// For changes that raise root i as far as intact eigenvalue i + `lifting`.
  [[nodiscard]] const Window& window_for(int lifting) const {
    const auto at = std::ranges::lower_bound(kLifting, lifting);
    return windows[static_cast<std::size_t>(at - kLifting.begin())];
  }
  /// A motion in each mode: `stride` numbers.
  void motion(const SparseRow& row, double* out) const;

 private:
  StructureSpectrum kept_spectrum(int kept);
};

}  // namespace wheeltap::fem::detail
