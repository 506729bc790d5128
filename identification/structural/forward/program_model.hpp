// A beam's frequencies by a model of someone else's: a program or a server.
#pragma once

#include "identification/emulation/outside_model.hpp"
#include "identification/structural/forward/forward_model.hpp"

namespace wheeltap::identification {

/// Asks for the elastic frequencies [Hz] with the place [m] and severity (and extent [m], where it
/// is unknown) of each defect: of each kind as many as there may be at the most, those that there
/// are first, in order of place, and then zeros.
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
