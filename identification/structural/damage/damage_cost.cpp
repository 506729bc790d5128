#include "identification/structural/damage/damage_cost.hpp"

#include <algorithm>

#include "fem/structures/reanalysis/structure_reanalysis.hpp"
#include "fem/structures/reanalysis/structure_spectrum.hpp"
#include "identification/structural/likelihood/states_likelihood.hpp"

namespace wheeltap::identification {

inference::RunCost cost_of_damages(const DamageCase& damage_case, const inference::Options& options,
                                   double most_in_memory) {
  const bool structure = damage_case.solved_as_structure();
  const auto n = structure ? static_cast<double>(discretise(damage_case.solved_structure()).size())
                           : 2.0 * damage_case.beam.elements;
  const double modes = damage_case.modes();
  const double common_ones = damage_case.data.cv_prior ? 1.0 : 0.0;
  const double kept =
      structure ? fem::StructureReanalysis::kept_modes(static_cast<int>(n), damage_case.modes())
                : n;
  // Run times measured on one core of 2.5 GHz.
  inference::ProblemSize size{
      .largest = common_ones,
      .predictions = modes,
      .explored = 10'000.0,  // 5 000 to 14 000 on the starter cases
      .seconds_a_likelihood =
          1e-6 * modes * (structure ? 1.5 + 0.01 * kept : 0.6 + 0.00125 * kept)};
  if (damage_case.states()) {
    const StatesLikelihood states(damage_case.states(), damage_case.kinds,
                                  damage_case.intact_beam());
    size.seconds_a_likelihood = states.check(8).seconds_a_solution;
    size.largest += static_cast<double>(damage_case.states()->parameters().size());
  }
  double mean = size.largest;
  for (const DefectKind& kind : damage_case.kinds) {
    const double each = kind.severity_prior() != nullptr ? 2.0 : 1.0;
    size.models *= kind.max_count - kind.min_count + 1.0;
    size.largest += each * kind.max_count;
    mean += each * 0.5 * (kind.min_count + kind.max_count);
  }
  size.dimensions = size.models * mean;
  inference::RunCost cost = cost_of_sampling(size, options, most_in_memory);
  cost.seconds_a_likelihood = size.seconds_a_likelihood;
  if (damage_case.states()) return cost;
  const double likelihoods = cost.seconds;
  if (kept < n) {
    // Run time of the lowest modes, and of four vectors per place, computed from all other modes.
    cost.seconds += 3.3e-6 * n * kept + 1.2e-6 * n * n;
    cost.bytes += 32.0 * n * kept + 2e3 * n +
                  std::min(32.0 * n * n, double{fem::StructureReanalysis::kResidualMemory});
  } else if (structure) {  // run time of all n modes of the intact structure
    cost.seconds += (n <= fem::kWideSpectrum ? 1.2e-8 : 1.35e-9) * n * n * n;
    cost.bytes += 52.0 * n * n;
  } else {
    cost.seconds += 4e-6 * n * n;
    cost.bytes += 24.0 * n * n;
  }
  cost.preparation = cost.seconds - likelihoods;
  return cost;
}

inference::RunCost cost_of_tables(const DamageCase& damage_case) {
  if (!damage_case.emulator || damage_case.emulator->sites.empty()) return {};
  const EmulatorSpec& spec = *damage_case.emulator;
  const int modes = damage_case.modes();
  inference::RunCost cost;
  for (int count = 1; count <= spec.tables(damage_case.kinds[0].max_count); ++count) {
    double runs = 1.0;
    for (int d = 0; d < count; ++d) {
      const auto list = std::min(static_cast<std::size_t>(d), spec.sites.size() - 1);
      runs *= static_cast<double>(spec.sites[list].size() * spec.reductions.size());
    }
    cost.likelihoods += runs;
    cost.bytes += 8.0 * runs * (2.0 * count + 2.0 * modes);
  }
  constexpr double kSecondsARun = 2e-5;
  cost.seconds = cost.likelihoods * kSecondsARun;
  return cost;
}

}  // namespace wheeltap::identification
