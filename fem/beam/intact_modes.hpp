// What the reanalysis keeps of the intact beam. Internal.
#pragma once

#include <vector>

#include "fem/beam/beam.hpp"
#include "fem/beam/timoshenko_element.hpp"
#include "fem/window.hpp"

namespace wheeltap::fem::detail {

struct IntactModes {
  Beam beam;
  TimoshenkoElement<double> element;
  int wanted;                       // lowest modes that may be asked for
  int modes;                        // all modes of the mesh, n
  int rigid;                        // of them at λ = 0
  std::size_t stride;               // n, and at least two
  std::vector<double> eigenvalues;  // stride
  int stiff;                        // first mode that bends the beam; those before move its springs
  std::vector<double> scales;       // s_j: λ_j, or that of `stiff` for rigid-body modes
  std::vector<double> held_scales;  // with added supports: that of `stiff` for soft modes, too
  std::vector<double> compliances;  // 1 / held_scales
  std::vector<double> frequencies;  // wanted
  std::vector<double> element_rows;  // 2 elements × stride: b·φ_j, a·φ_j of each element
  std::vector<double> dof_rows;      // 2 nodes × stride: φ_j at each degree of freedom
  int self_stresses = 0;             // how many
  std::vector<double> stress_rows;   // 2 elements × self_stresses
  std::vector<Window> windows;       // for no, few, and any number of supports

  /// Throws std::invalid_argument as `Reanalysis`.
  IntactModes(const Beam& intact_beam, int wanted_modes);

  /// How S is summed under so many added supports.
  [[nodiscard]] const Window& window(int supports) const;

  /// Σ_j a_j b_j / s_j: a compliance that exists for free beams too.
  [[nodiscard]] double compliance(const double* a, const double* b) const;

  /// row[j] = N(x) · φ_j, or N_θ(x) · φ_j; returns the compliance of its terms, had they not
  /// cancelled.
  double motion(double at, bool rotation, double* row) const;
};

}  // namespace wheeltap::fem::detail
