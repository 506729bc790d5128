// K φ = ω² M φ: natural frequencies and mode shapes of a beam, intact or with defects.
#pragma once

#include <string>
#include "base/eigen.hpp"

#include "fem/beam.hpp"
#include "fem/defect.hpp"

namespace wheeltap::fem {

/// The lowest modes, rigid-body ones first.
struct Modes {
  Eigen::VectorXd frequencies_hz;  ///< ascending; exactly 0 for rigid-body modes
  Eigen::VectorXd eigenvalues;     ///< ω² [rad²/s²]
  /// One column a mode, rows w_0 θ_0 w_1 θ_1 …: every dof of the mesh, held ones included (zero).
  /// Mass-normalised, φᵀ M φ = 1; the sign makes the largest deflection positive.
  Eigen::MatrixXd shapes;
  int rigid_body_modes = 0;
  bool certified = false;  ///< the Sturm count says that no mode below the highest one was missed
  std::string solver;      ///< "spectra" or "dense", and why where it fell back
};

struct ModalOptions {
  int modes = 10;      ///< how many of the lowest modes, rigid-body ones included
  bool dense = false;  ///< use the dense solver even where the sparse one would do
};

/// Throws std::invalid_argument for an invalid beam, defects outside it, or more modes than free
/// degrees of freedom.
[[nodiscard]] Modes modal_analysis(const Beam& beam, const Defects& defects,
                                   const ModalOptions& options);

}  // namespace wheeltap::fem
