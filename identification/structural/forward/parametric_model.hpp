// Forward models of a structure with unknown parameters: reduced basis or external model.
#pragma once

#include <memory>
#include <utility>

#include "identification/emulation/outside_predictor.hpp"
#include "identification/structural/forward/forward_model.hpp"

namespace wheeltap::identification {

/// Computes modes at the sensors in a reduced basis, with derivatives if the basis provides them.
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
/// Outside the emulator's training domain, the prediction fails: the domain truncates the priors.
/// Searches for posterior modes often leave the domain; the external model is not run there.
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
