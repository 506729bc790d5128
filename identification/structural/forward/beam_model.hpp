// Forward model of a beam with a few defects, by exact reanalysis.
#pragma once

#include "fem/beam/reanalysis.hpp"
#include "identification/structural/forward/forward_model.hpp"

namespace wheeltap::identification {

/// fem::Reanalysis computes the derivatives of frequencies (Quantity::slopes): exact derivatives
/// with respect to severities, and difference quotients of two further solutions with respect to
/// locations. There are no derivatives if a kind of defect is not elementary (DefectType).
class BeamModel final : public ForwardModel {
 public:
  /// `modes` is the number of elastic modes. Throws the exceptions of the constructor of
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
