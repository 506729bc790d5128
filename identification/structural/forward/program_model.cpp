#include "identification/structural/forward/program_model.hpp"

#include <algorithm>
#include <tuple>

namespace wheeltap::identification {

class ProgramModel::ProgramSolver final : public Solver {
 public:
  explicit ProgramSolver(const ProgramModel& model) : model_(model) {}

  bool predict(std::span<const double> /*theta*/, const std::vector<PlacedDefect>& defects,
               Quantity quantity, Prediction& out) override {
    if (quantity != Quantity::frequencies) return false;
    std::vector<PlacedDefect> present = defects;
    std::ranges::sort(present, [](const PlacedDefect& a, const PlacedDefect& b) {
      return std::tie(a.kind, a.location) < std::tie(b.kind, b.location);
    });
    std::vector<double> inputs;
    std::size_t next = 0;
    for (std::size_t k = 0; k < model_.kinds_.size(); ++k) {
      const DefectKind& kind = model_.kinds_[k];
      for (int c = 0; c < kind.max_count; ++c) {
        const bool is = next < present.size() && present[next].kind == static_cast<int>(k);
        const PlacedDefect one =
            is ? present[next++]
               : PlacedDefect{.kind = static_cast<int>(k), .location = 0.0, .severity = 0.0};
        const double numbers[] = {one.location, one.severity, one.extent};
        inputs.insert(inputs.end(), numbers, numbers + (kind.extent_prior ? 3 : 2));
      }
    }
    model_.model_->evaluate(inputs, out.frequencies_hz);
    return true;
  }

 private:
  const ProgramModel& model_;
};

std::unique_ptr<ForwardModel::Solver> ProgramModel::make_solver() const {
  return std::make_unique<ProgramSolver>(*this);
}

}  // namespace wheeltap::identification
