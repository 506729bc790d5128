// Forward models of a structure with parameters: reduced basis or external model.
#pragma once

#include <memory>
#include <utility>

#include "identification/emulation/outside_predictor.hpp"
#include "identification/structural/forward/forward_model.hpp"

namespace wheeltap::identification {

/// Modes at sensors by a reduced basis, with their gradient if the basis provides it.
class BasisModel final : public ForwardModel {
 public:
  explicit BasisModel(std::shared_ptr<const fem::ParametricModes> basis)
      : basis_(std::move(basis)) {}

  [[nodiscard]] std::unique_ptr<Solver> make_solver() const override;
  [[nodiscard]] bool differentiates_modes() const override {
    return basis_->structure().form() == fem::ParametricStructure::Form::affine;
  }
  [[nodiscard]] const fem::ParametricModes& basis() const { return *basis_; }

 private:
  std::shared_ptr<const fem::ParametricModes> basis_;
};

/// Frequencies from an external program or server, or from its emulator, with error variances.
/// Outside the emulator's box, the prediction fails: the box truncates the priors. The external
/// model is not run there, because searches for posterior modes often leave the box.
class OutsideModes final : public ForwardModel {
 public:
  explicit OutsideModes(OutsidePredictor predictor) : predictor_(std::move(predictor)) {}

  [[nodiscard]] std::unique_ptr<Solver> make_solver() const override;
  [[nodiscard]] bool is_expensive() const override { return !predictor_.emulator; }
  [[nodiscard]] const OutsidePredictor& predictor() const { return predictor_; }

 private:
  OutsidePredictor predictor_;
};

}  // namespace wheeltap::identification
