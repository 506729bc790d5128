// K φ = ω² M φ: natural frequencies and mode shapes of a beam, intact or with defects.
#pragma once

#include <string>

#include "base/eigen.hpp"
#include "fem/beam/beam.hpp"
#include "fem/beam/defect.hpp"

namespace wheeltap::fem {

/// The lowest modes, rigid-body ones first.
struct Modes {
  Eigen::VectorXd frequencies_hz;  ///< ascending; exactly 0 for rigid-body modes
  Eigen::VectorXd eigenvalues;     ///< ω² [rad²/s²]
  /// One column a mode, rows w_0 θ_0 w_1 θ_1 …: every dof of the mesh, held ones included (zero).
  /// Mass-normalised, φᵀ M φ = 1; the sign makes the largest deflection positive.
  Eigen::MatrixXd shapes;
  int rigid_body_modes = 0;
  /// For each mode i (from 0) that is not rigid, Sturm counts in 106 bits found at most i
  /// eigenvalues of the assembled problem below ω_i² (1 - 1e-12), and more than i below ω_i² (1 +
  /// 1e-12). So none is missing, and each frequency is that of the mesh within 5e-13 and the
  /// rounding to double; how far the mesh is from the beam it does not say.
  bool certified = false;
  std::string solver;  ///< "spectra", "dense" or "bisection", and why
};

struct ModalOptions {
  int modes = 10;      ///< how many of the lowest modes, rigid-body ones included
  bool dense = false;  ///< use the dense solver even where the sparse one would do
};

/// Shift-and-invert Lanczos (Spectra), or a dense solver, finds the modes in double; Rayleigh
/// quotient iteration in 106 bits finishes them, since double loses λ_max / λ of the low modes'
/// digits, 1e12 on meshes of 150 elements; and where a mode was missed, bisection by Sturm counts
/// finds all of them. Throws std::invalid_argument for an invalid beam, defects outside it, or more
/// modes than free degrees of freedom.
[[nodiscard]] Modes modal_analysis(const Beam& beam, const Defects& defects,
                                   const ModalOptions& options);

}  // namespace wheeltap::fem
