#include "identification/structural/damage/emulated_model.hpp"

#include <algorithm>
#include <cmath>

#include "identification/structural/forward/beam_model.hpp"

namespace wheeltap::identification {

class EmulatedModel::EmulatedSolver final : public Solver {
 public:
  explicit EmulatedSolver(const EmulatedModel& model)
      : model_(model), exact_(model.exact_->make_solver()) {}

  bool predict(std::span<const double> theta, const std::vector<PlacedDefect>& defects,
               Quantity quantity, Prediction& out) override {
    if (quantity != Quantity::frequencies) return false;
    std::vector<double>& f = out.frequencies_hz;
    out.error_variance.assign(f.size(), 0.0);
    place_in_beam(model_.kinds_, defects, placed_);
    if (!placed_.damages.empty()) {
      std::ranges::sort(placed_.damages, {}, &fem::Damage::location);
      if (model_.errs_)
        model_.emulator_->evaluate(placed_.damages, f, out.error_variance);
      else
        model_.emulator_->evaluate(placed_.damages, f);
      if (std::ranges::none_of(f, [](double one) { return std::isnan(one); })) return true;
    }
    // The exact model predicts the structure without damages, and replaces an invalid ANOVA
    // sum.
    std::ranges::fill(out.error_variance, 0.0);
    return exact_->predict(theta, defects, quantity, out);
  }

 private:
  const EmulatedModel& model_;
  std::unique_ptr<Solver> exact_;
  fem::Defects placed_;
};

std::unique_ptr<ForwardModel::Solver> EmulatedModel::make_solver() const {
  return std::make_unique<EmulatedSolver>(*this);
}

}  // namespace wheeltap::identification
