// One structure with parameters, whose modes a reduced basis or a model of someone else's predicts.
#pragma once

#include <memory>
#include <utility>

#include "identification/emulation/outside_predictor.hpp"
#include "identification/structural/forward/forward_model.hpp"

namespace wheeltap::identification {

/// Modes at sensors by a reduced basis, with their gradient where it has one.
class BasisModel final : public ForwardModel {
 public:
  explicit BasisModel(std::shared_ptr<const fem::ParametricModes> basis)
      : basis_(std::move(basis)) {}

  [[nodiscard]] std::unique_ptr<Solver> make_solver() const override;
  [[nodiscard]] const fem::ParametricModes& basis() const { return *basis_; }

 private:
  std::shared_ptr<const fem::ParametricModes> basis_;
};

/// Modes without shapes by a program or a server, or by the emulator in front of it, with the
/// variance of its error. No structure beyond the emulator's box: it cuts priors off, and searches
/// go beyond it far too often to ask the model itself there.
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
