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
  /// One column per mode, rows w_0 θ_0 w_1 θ_1 … for every dof of the mesh; restrained dofs are
  /// zero. Mass-normalised, φᵀ M φ = 1; the largest deflection is positive.
  Eigen::MatrixXd shapes;
  int rigid_body_modes = 0;
  /// True if Sturm counts in 106 bits confirm each elastic mode i (from 0): at most i eigenvalues
  /// of the assembled problem lie below ω_i² (1 - 1e-12), and more than i below ω_i² (1 + 1e-12).
  /// Then no mode is missing, and each frequency of the mesh is correct within 5e-13 and the
  /// rounding to double. The discretisation error of the mesh is not included.
  bool certified = false;
  std::string solver;  ///< "spectra", "dense" or "bisection", with the reason
};

struct ModalOptions {
  int modes = 10;      ///< number of lowest modes, rigid-body modes included
  bool dense = false;  ///< use the dense solver even where the sparse one suffices
};

/// Shift-and-invert Lanczos (Spectra) or a dense solver finds the modes in double precision. In
/// double precision, the relative error of a low mode is about λ_max / λ times the rounding error
/// (λ_max / λ is 1e12 on meshes of 150 elements). Rayleigh quotient iteration in 106 bits therefore
/// refines the modes. If a mode is missing, bisection by Sturm counts finds all modes. Throws
/// std::invalid_argument for an invalid beam, defects outside it, or more modes than free degrees
/// of freedom.
[[nodiscard]] Modes modal_analysis(const Beam& beam, const Defects& defects,
                                   const ModalOptions& options);

}  // namespace wheeltap::fem
