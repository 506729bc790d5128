// Forward model of a beam by an external program or server.
#pragma once

#include "identification/emulation/outside_model.hpp"
#include "identification/structural/forward/forward_model.hpp"

namespace wheeltap::identification {

/// The program computes the elastic frequencies [Hz] from location [m] and severity (and extent
/// [m], if unknown) of each defect. The inputs cover the largest allowed number of defects of each
/// kind: first the existing defects, sorted by location, then zeros for the absent defects.
class ProgramModel final : public ForwardModel {
 public:
  ProgramModel(std::shared_ptr<OutsideModel> model, std::vector<DefectKind> kinds)
      : model_(std::move(model)), kinds_(std::move(kinds)) {}

  [[nodiscard]] std::unique_ptr<Solver> make_solver() const override;
  [[nodiscard]] bool is_expensive() const override { return true; }
  [[nodiscard]] OutsideModel& model() const { return *model_; }

 private:
  class ProgramSolver;

  std::shared_ptr<OutsideModel> model_;
  std::vector<DefectKind> kinds_;
};

}  // namespace wheeltap::identification
