// Natural frequencies and mode shapes of a beam, intact or with defects, from K φ = ω² M φ.
#pragma once

#include <string>

#include "base/eigen.hpp"
#include "fem/beam/beam.hpp"
#include "fem/beam/defect.hpp"

namespace wheeltap::fem {

/// The lowest modes of a beam, rigid-body modes first.
struct Modes {
  Eigen::VectorXd frequencies_hz;  ///< ascending; exactly 0 for rigid-body modes
  Eigen::VectorXd eigenvalues;     ///< ω² [rad²/s²]
  /// Mode shapes, one column per mode. The rows are w_0, θ_0, w_1, θ_1, … for all degrees of
  /// freedom of the mesh; restrained degrees of freedom are zero. Shapes are mass-normalised, φᵀ M
  /// φ = 1, and the largest deflection is positive.
  Eigen::MatrixXd shapes;
  int rigid_body_modes = 0;
  /// True if 106-bit Sturm counts confirm each elastic mode i (from 0): at most i eigenvalues
  /// of the assembled problem lie below ω_i² (1 - 1e-12), and more than i below ω_i² (1 +
  /// 1e-12). If all modes are confirmed, none is missing, and the relative error of each frequency
  /// is at most 5e-13 plus the rounding error of double precision. This error bound excludes the
  /// discretisation error.
  bool certified = false;
  std::string solver;  ///< "spectra", "dense" or "bisection", with the reason for the choice
};

struct ModalOptions {
  int modes = 10;      ///< number of lowest modes, rigid-body modes included
  bool dense = false;  ///< true: use the dense solver even if the sparse solver suffices
};

/// Computes the lowest modes. Shift-and-invert Lanczos (Spectra) or a dense solver finds
/// approximate modes in double precision. The relative error of these low eigenvalues is about
/// λ_max / λ times the unit round-off (λ_max / λ is 1e12 on a mesh of 150 elements). Rayleigh
/// quotient iteration in 106-bit arithmetic therefore refines the modes. If a mode is missing,
/// bisection by Sturm counts finds all modes. Throws std::invalid_argument for an invalid beam,
/// defects outside the beam, or more modes than free degrees of freedom.
[[nodiscard]] Modes modal_analysis(const Beam& beam, const Defects& defects,
                                   const ModalOptions& options);

}  // namespace wheeltap::fem
