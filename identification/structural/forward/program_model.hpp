// Forward model of a beam by an external program or server.
#pragma once

#include "identification/emulation/outside_model.hpp"
#include "identification/structural/forward/forward_model.hpp"

namespace wheeltap::identification {

/// Obtains the elastic frequencies [Hz] from the program. Inputs: place [m] and severity (and
/// extent [m], if unknown) of each defect. Each kind has inputs for its largest count of defects:
/// first the existing defects in order of place, then zeros.
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
