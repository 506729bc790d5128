// A forward model whose frequencies an emulator predicts.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "identification/structural/damage/frequency_emulator.hpp"
#include "identification/structural/forward/forward_model.hpp"

namespace wheeltap::identification {

/// The emulator predicts frequencies and error variances (0 if `errs` is false). The model `exact`
/// replaces the emulator if the structure is intact, or if the ANOVA sum is not a valid frequency.
class EmulatedModel final : public ForwardModel {
 public:
  EmulatedModel(std::shared_ptr<const FrequencyEmulator> emulator,
                std::shared_ptr<const ForwardModel> exact, std::vector<DefectKind> kinds, bool errs)
      : emulator_(std::move(emulator)),
        exact_(std::move(exact)),
        kinds_(std::move(kinds)),
        errs_(errs) {}

  [[nodiscard]] std::unique_ptr<Solver> make_solver() const override;

 private:
  class EmulatedSolver;

  std::shared_ptr<const FrequencyEmulator> emulator_;
  std::shared_ptr<const ForwardModel> exact_;
  std::vector<DefectKind> kinds_;
  bool errs_;
};

}  // namespace wheeltap::identification
