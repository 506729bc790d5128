// Forward model of a beam, by exact reanalysis of a few defects.
#pragma once

#include "fem/beam/reanalysis.hpp"
#include "identification/structural/forward/forward_model.hpp"

namespace wheeltap::identification {

/// Slopes are those of fem::Reanalysis: exact derivatives for reductions and stiffnesses, and
/// differences of two further solutions for locations. There are no slopes if a kind of defect is
/// not elementary (DefectType).
class BeamModel final : public ForwardModel {
 public:
  /// `modes`: number of elastic modes. Throws std::invalid_argument under the conditions of
  /// fem::Reanalysis.
  BeamModel(const fem::Beam& beam, std::vector<DefectKind> kinds, int modes, int rigid_body_modes);

  [[nodiscard]] std::unique_ptr<Solver> make_solver() const override;
  [[nodiscard]] const fem::Reanalysis& reanalysis() const { return reanalysis_; }

 private:
  class BeamSolver;

  fem::Reanalysis reanalysis_;
  std::vector<DefectKind> kinds_;
  std::size_t modes_, rigid_;
};

}  // namespace wheeltap::identification
