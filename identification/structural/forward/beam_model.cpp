#include "identification/structural/forward/beam_model.hpp"

#include <algorithm>

#include "identification/structural/elastic_modes.hpp"

namespace wheeltap::identification {

class BeamModel::BeamSolver final : public Solver {
 public:
  explicit BeamSolver(const BeamModel& model)
      : model_(model),
        workspace_(model.reanalysis_.make_workspace()),
        all_(model.modes_ + model.rigid_) {}

  bool predict(std::span<const double> /*theta*/, const std::vector<PlacedDefect>& defects,
               Quantity quantity, Prediction& out) override {
    if (quantity == Quantity::modes) return false;
    if (quantity == Quantity::slopes) return differentiate(defects, out);
    place_in_beam(model_.kinds_, defects, placed_);
    model_.reanalysis_.frequencies_hz(placed_.damages, placed_.supports, workspace_, all_);
    copy_elastic(out.frequencies_hz);
    return true;
  }

 private:
  bool differentiate(const std::vector<PlacedDefect>& defects, Prediction& out) {
    for (const DefectKind& kind : model_.kinds_)
      if (!kind.type->is_elementary) return false;
    place_in_beam(model_.kinds_, defects, placed_);
    const std::size_t n = all_.size(), damages = placed_.damages.size(),
                      supports = placed_.supports.size();
    by_reduction_.resize(n * damages);
    along_damages_.resize(n * damages);
    by_stiffness_.resize(n * supports);
    along_supports_.resize(n * supports);
    model_.reanalysis_.solve(placed_.damages, placed_.supports, workspace_,
                             {.frequencies_hz = all_,
                              .damage_gradients_hz = by_reduction_,
                              .element_gradients_hz = {},
                              .shapes = {},
                              .points = {},
                              .support_gradients_hz = by_stiffness_});
    model_.reanalysis_.location_slopes(placed_.damages, placed_.supports, workspace_,
                                       {.modes = static_cast<int>(n),
                                        .damages_hz_m = along_damages_,
                                        .supports_hz_m = along_supports_});
    const std::size_t first = copy_elastic(out.frequencies_hz), wanted = out.frequencies_hz.size();
    out.by_location.resize(wanted * defects.size());
    out.by_severity.resize(wanted * defects.size());
    std::size_t damage = 0, support = 0;
    for (std::size_t d = 0; d < defects.size(); ++d) {
      const DefectKind& kind = model_.kinds_[static_cast<std::size_t>(defects[d].kind)];
      fem::Defects one;
      kind.type->place(kind, 0.0, 0.0, one);
      const bool is_damage = one.supports.empty();
      const std::size_t at = is_damage ? damage++ : support++, of = is_damage ? damages : supports;
      const std::vector<double>& along = is_damage ? along_damages_ : along_supports_;
      const std::vector<double>& by = is_damage ? by_reduction_ : by_stiffness_;
      for (std::size_t i = 0; i < wanted; ++i) {
        out.by_location[i * defects.size() + d] = along[(first + i) * of + at];
        out.by_severity[i * defects.size() + d] = by[(first + i) * of + at];
      }
    }
    return true;
  }

  std::size_t copy_elastic(std::span<double> out) const {
    const std::size_t first = first_elastic(all_, model_.rigid_);
    std::copy_n(all_.begin() + static_cast<std::ptrdiff_t>(first), out.size(), out.begin());
    return first;
  }

  const BeamModel& model_;
  fem::Reanalysis::Workspace workspace_;
  fem::Defects placed_;
  std::vector<double> all_, by_reduction_, by_stiffness_, along_damages_, along_supports_;
};

BeamModel::BeamModel(const fem::Beam& beam, std::vector<DefectKind> kinds, int modes,
                     int rigid_body_modes)
    : reanalysis_(beam, modes + rigid_body_modes),
      kinds_(std::move(kinds)),
      modes_(static_cast<std::size_t>(modes)),
      rigid_(static_cast<std::size_t>(rigid_body_modes)) {}

std::unique_ptr<ForwardModel::Solver> BeamModel::make_solver() const {
  return std::make_unique<BeamSolver>(*this);
}

}  // namespace wheeltap::identification
