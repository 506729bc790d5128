#include "identification/structural/damage/damage_plausibility.hpp"

#include <algorithm>
#include <cmath>

#include "identification/findings/prior_draws.hpp"
#include "identification/structural/structure_plausibility.hpp"

namespace wheeltap::identification {
namespace {

constexpr double kApart = 0.1;         // relative difference of frequencies
constexpr double kApartInNoise = 5.0;  // difference of frequencies, in sds
constexpr double kHidden = 0.5;        // largest effect of damage divided by noise

double median(std::vector<double> x) {
  std::ranges::sort(x);
  return x[x.size() / 2];
}

}  // namespace

std::vector<Remark> implausible(const DamageProblem& problem) {
  const DamageCase& damage_case = problem.damage_case;
  std::vector<Remark> remarks = damage_case.structure ? implausible(damage_case.structure->nominal)
                                                      : implausible(damage_case.beam);
  if (damage_case.modal())
    for (Remark& remark : implausible(damage_case.modal()->sensors))
      remarks.push_back(std::move(remark));
  const FrequencyData& data = problem.damage_case.data;
  const auto& space = problem.problem.space;
  const auto modes = static_cast<std::size_t>(data.modes());
  // An external model is expensive, so evaluate it as rarely as possible.
  StructuralPredictor predictor(
      problem, problem.program() != nullptr ? problem.predicting() : *problem.model);
  std::vector<PriorRange> predicted(modes);
  std::vector<double> f(modes);
  for (int i = 0; i < kPriorDraws; ++i) {
    const int m = i % space.size();
    predictor.solve(m, prior_draw(space, m, i), f);
    for (std::size_t mode = 0; mode < modes; ++mode) {
      if (std::isfinite(f[mode])) predicted[mode].take(f[mode]);
    }
  }
  std::vector<double> ratios, effects;
  remark::FrequenciesOutOfReach away{};
  int measured = 0;
  for (std::size_t mode = 0; mode < modes; ++mode) {
    const double observed = data.frequencies_hz[mode];
    const PriorRange& range = predicted[mode];
    if (std::isnan(observed) || !(range.high > 0.0)) continue;
    ++measured;
    const double sd = data.sd_hz.empty() ? 0.0 : data.sd_hz[mode];
    const double nearest = range.nearest(observed);
    if (std::abs(observed - nearest) > std::max(kApart * nearest, kApartInNoise * sd)) {
      if (ratios.empty()) {
        away = {.ratio = 0.0,
                .measured = observed,
                .lowest = range.low,
                .highest = range.high,
                .mode = static_cast<int>(mode) + 1};
      }
      ratios.push_back(observed / nearest);
    }
    if (sd > 0.0) effects.push_back((range.high - range.low) / sd);
  }
  if (!ratios.empty() && 2 * static_cast<int>(ratios.size()) >= measured) {
    away.ratio = median(ratios);
    remarks.push_back(away);
  }
  if (!effects.empty() && space.size() > 1) {
    const auto most = std::ranges::max_element(effects);
    if (*most < kHidden) {
      remarks.push_back(remark::NoiseHidesDamage{data.cv.value_or(std::nan("")), *most});
    }
  }
  return remarks;
}

}  // namespace wheeltap::identification
