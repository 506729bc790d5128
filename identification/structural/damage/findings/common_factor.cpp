#include "identification/structural/damage/findings/common_factor.hpp"

#include <algorithm>
#include <cmath>

#include "identification/structural/likelihood/mode_contributions.hpp"

namespace wheeltap::identification {
namespace {

constexpr double kFits = 0.05;  // smallest p of a fit that counts as good
constexpr int kFewest = 3;      // frequencies

double mean_cv(const UnpackedDraws& draws, const NoiseModel& noise) {
  double sum = 0.0, weights = 0.0;
  draws.for_each([&](std::size_t c, std::size_t i) {
    sum += draws.weight(c, i) * noise.cv(draws.posterior().theta(c, i));
    weights += draws.weight(c, i);
  });
  return sum / weights;
}

}  // namespace

FactorFit fit_factor(std::span<const double> observed, std::span<const double> predicted,
                     std::span<const double> sd) {
  // Minimises Σ (a - c b)² with a = f_obs / sd and b = f / sd.
  double aa = 0.0, ab = 0.0, bb = 0.0;
  FactorFit out;
  for (std::size_t mode = 0; mode < observed.size(); ++mode) {
    if (std::isnan(observed[mode])) continue;
    const double a = observed[mode] / sd[mode], b = predicted[mode] / sd[mode];
    aa += a * a;
    ab += a * b;
    bb += b * b;
    ++out.measured;
  }
  out.factor = ab / bb;
  for (std::size_t mode = 0; mode < observed.size(); ++mode) {
    if (std::isnan(observed[mode])) continue;
    out.chi_square += std::pow((observed[mode] - out.factor * predicted[mode]) / sd[mode], 2);
    out.without += std::pow((observed[mode] - predicted[mode]) / sd[mode], 2);
  }
  return out;
}

std::optional<remark::CommonFactor> common_factor(const UnpackedDraws& draws,
                                                  const std::vector<ModelFinding>& models) {
  const DamageProblem& problem = draws.problem();
  const FrequencyData& data = problem.damage_case.data;
  const NoiseModel noise = problem.noise();
  if (problem.by_modes() || problem.states() != nullptr || !problem.as_case ||
      problem.common > (data.cv_prior ? 1 : 0) || data.measured() < kFewest)
    return {};
  const auto intact = std::ranges::find_if(models, [](const ModelFinding& model) {
    return std::ranges::all_of(model.counts, [](int count) { return count == 0; });
  });
  if (intact == models.end() || intact->probability() >= 0.5) return {};

  std::vector<double> predicted(static_cast<std::size_t>(data.modes())), sd(predicted.size());
  const double cv = data.cv_prior ? mean_cv(draws, noise) : 0.0;
  const std::vector<double> x(static_cast<std::size_t>(problem.common), cv);
  StructuralPredictor(problem).solve(static_cast<int>(intact - models.begin()), x, predicted);
  for (std::size_t mode = 0; mode < sd.size(); ++mode) sd[mode] = noise.sd(mode, cv, 0.0);
  const FactorFit fit = fit_factor(data.frequencies_hz, predicted, sd);
  const double p = chi_square_tail(fit.measured - 1, fit.chi_square);
  if (!(p >= kFits) || chi_square_tail(fit.measured, fit.without) >= kFits) return {};
  return remark::CommonFactor{fit.factor, p, fit.measured};
}

}  // namespace wheeltap::identification
