// Precomputed data of the intact beam. Internal to the reanalysis.
#pragma once

#include <vector>

#include "fem/beam/beam.hpp"
#include "fem/beam/timoshenko_element.hpp"
#include "fem/window.hpp"

namespace wheeltap::fem::detail {

struct IntactModes {
  Beam beam;
  TimoshenkoElement<double> element;
  int wanted;                       // largest number of modes that callers can request
  int modes;                        // number n of all modes of the FE model
  int rigid;                        // number of modes at λ = 0
  std::size_t stride;               // n, but at least two
  std::vector<double> eigenvalues;  // stride
  int stiff;  // first mode that bends the beam; earlier modes only deform the springs
  std::vector<double> scales;  // s_j: λ_j; for rigid-body modes, the eigenvalue of mode `stiff`
  std::vector<double>
      held_scales;  // s_j with added supports: the eigenvalue of mode `stiff` also for soft modes
  std::vector<double> compliances;   // 1 / held_scales
  std::vector<double> frequencies;   // wanted
  std::vector<double> element_rows;  // 2 elements × stride: b·φ_j, a·φ_j of each element
  std::vector<double> dof_rows;      // 2 nodes × stride: φ_j at each degree of freedom
  int self_stresses = 0;             // number of self-stress states
  std::vector<double> stress_rows;   // 2 elements × self_stresses
  std::vector<Window> windows;       // three windows: for no added support, for a few supports, and
                                     // for any number

  /// Throws the same exceptions as the constructor of `Reanalysis`.
  IntactModes(const Beam& intact_beam, int wanted_modes);

  /// Returns the near modes and the series of S for this number of added supports.
  [[nodiscard]] const Window& window(int supports) const;

  /// Computes Σ_j a_j b_j / s_j, a compliance that is finite also for a beam with rigid-body modes.
  [[nodiscard]] double compliance(const double* a, const double* b) const;

  /// Computes row[j] = N(x) · φ_j, or N_θ(x) · φ_j for a rotation. Returns the compliance at x,
  /// computed from the same terms without cancellation.
  double motion(double at, bool rotation, double* row) const;
};

}  // namespace wheeltap::fem::detail
