#include "identification/structural/damage/baseline.hpp"

#include <cmath>

#include "base/constants.hpp"
#include "base/number.hpp"
#include "fem/structures/modes/structure_modes.hpp"
#include "identification/invalid_input.hpp"

namespace wheeltap::identification {
namespace {

constexpr double kMostFactor = 2.0;

std::vector<double> undamaged_frequencies(const DamageCase& damage_case, int modes) {
  if (!damage_case.structure) return elastic_frequencies(damage_case.beam, {}, modes);
  const fem::Discretisation d = discretise(damage_case.structure->nominal);
  const auto rigid = static_cast<int>(d.rigid_motions.cols());
  const fem::StructureModes found = fem::structure_modes(d, rigid + modes);
  return {found.frequencies_hz.begin() + rigid, found.frequencies_hz.end()};
}

}  // namespace

void compare_with_baseline(DamageCase& damage_case, const FrequencyData& baseline) {
  FrequencyData& data = damage_case.data;
  const int modes = data.modes();
  if (baseline.modes() < modes)
    throw InvalidInput(InvalidInput::Part::data,
                       "the baseline has " + std::to_string(baseline.modes()) +
                           " modes: must be at least the number of modes in the data, " +
                           std::to_string(modes));
  const std::vector<double> model = undamaged_frequencies(damage_case, modes);
  ModalData modal = damage_case.modal() ? *damage_case.modal() : ModalData{};
  damage_case.baseline = Baseline{};
  double unknown_noise = 0.0;
  int used = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(modes); ++i) {
    const double measured = baseline.frequencies_hz[i];
    const double factor = measured / model[i];
    damage_case.baseline->measured_hz.push_back(measured);
    damage_case.baseline->model_hz.push_back(model[i]);
    if (std::isnan(measured)) {
      data.frequencies_hz[i] = kNaN;
    } else if (!(factor > 1.0 / kMostFactor && factor < kMostFactor)) {
      throw InvalidInput(InvalidInput::Part::data,
                         "mode " + std::to_string(i + 1) + " has " +
                             base::significant(measured, 4) + " Hz in the baseline but " +
                             base::significant(model[i], 4) +
                             " Hz in the model: check units and mode numbers");
    }
    if (std::isnan(data.frequencies_hz[i])) {
      if (!data.sd_hz.empty()) data.sd_hz[i] = kNaN;
      continue;
    }
    const double relative = baseline.sd_hz[i] / measured;
    data.frequencies_hz[i] /= factor;
    if (data.cv_prior) {
      unknown_noise += relative * relative;
      ++used;
    } else {
      data.sd_hz[i] = std::hypot(data.sd_hz[i] / factor, relative * data.frequencies_hz[i]);
    }
  }
  // If the noise is unknown, the noise of the baseline is added as discrepancy.
  if (used > 0)
    data.discrepancy_cv = std::hypot(data.discrepancy_cv, std::sqrt(unknown_noise / used));
  if (!damage_case.modal()) return;
  modal.frequencies_hz = data.frequencies_hz;
  modal.discrepancy.value = modal.discrepancy.known() ? data.discrepancy_cv : 0.0;
  const auto n = static_cast<Eigen::Index>(modal.covariance.rows());
  const auto factor_of = [&](Eigen::Index i) {
    return baseline.frequencies_hz[static_cast<std::size_t>(i)] /
           model[static_cast<std::size_t>(i)];
  };
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) {
      const bool known = !std::isnan(modal.frequencies_hz[static_cast<std::size_t>(i)]) &&
                         !std::isnan(modal.frequencies_hz[static_cast<std::size_t>(j)]);
      if (known) modal.covariance(i, j) /= factor_of(i) * factor_of(j);
      if (known && i == j) {
        const auto k = static_cast<std::size_t>(i);
        const double relative = baseline.sd_hz[k] / baseline.frequencies_hz[k];
        modal.covariance(i, i) += std::pow(relative * modal.frequencies_hz[k], 2);
      }
    }
  damage_case.measured.set_modal(std::move(modal));
}

}  // namespace wheeltap::identification
