#include "identification/sid/sid_residuals.hpp"

#include <algorithm>
#include <string>

#include "identification/sid/sid_problem.hpp"
#include "inference/search/mode_search.hpp"

namespace wheeltap::identification {
namespace {

/// The value that the residuals of the best fit with white residuals require.
int value_of(const SidCase& sid_case, const SidModel& model, std::uint64_t seed, int threads) {
  SidCase alone = sid_case;
  alone.models = {model};
  alone.further.clear();
  alone.unite();
  const auto problem = make_sid_problem(std::move(alone));
  std::vector<double> x;
  if (problem->problem.space[0].dimension > 0) {
    const inference::ModeSearch found = inference::search_modes(
        problem->problem, 0,
        {.seed = seed, .climbs = inference::kFewestClimbs, .threads = threads});
    if (found.modes.empty()) return 0;
    for (std::size_t p = 0; p < found.modes.front().z.size(); ++p) {
      x.push_back(problem->problem.space.prior(0, static_cast<int>(p))
                      .from_standard_normal(found.modes.front().z[p]));
    }
  }
  const dynamics::Misfit& misfit = problem->misfits.front();
  const auto samples = static_cast<std::size_t>(misfit.samples());
  std::vector<double> residuals(samples * static_cast<std::size_t>(misfit.channels()));
  if (!misfit.residuals(problem->theta(0, x), residuals)) return 0;
  int value = 0;
  for (std::size_t at = 0; at < residuals.size(); at += samples) {
    value = std::max(value, model.residuals.chosen_kind->choose({residuals.data() + at, samples}));
  }
  return value;
}

}  // namespace

void add_residuals(SidCase& sid_case, SidModel& model,
                   std::shared_ptr<const ResidualModel> residuals) {
  const std::size_t responses = sid_case.responses().size();
  model.residuals.coefficients.clear();
  for (std::size_t c = 0; c < responses; ++c) {
    const std::string channel = responses > 1 ? "[" + std::to_string(c + 1) + "]" : "";
    auto& own = model.residuals.coefficients.emplace_back();
    for (ResidualParameter& p : residuals->parameters(channel)) {
      own.push_back(sid_case.parameter(p.name, std::move(p.prior)));
    }
  }
  model.residuals.model = std::move(residuals);
}

void choose_residuals(SidCase& sid_case, std::uint64_t seed, int threads) {
  for (SidModel& model : sid_case.models) {
    const ResidualKind* kind = model.residuals.chosen_kind;
    if (kind == nullptr) continue;
    const auto chosen = kind->make(value_of(sid_case, model, seed, threads));
    add_residuals(sid_case, model, chosen);
    for (SidCase& record : sid_case.further) {
      record.parameters = sid_case.parameters;
      const auto m = static_cast<std::size_t>(&model - sid_case.models.data());
      add_residuals(record, record.models[m], chosen);
      sid_case.parameters = record.parameters;
    }
  }
  sid_case.unite();
}

}  // namespace wheeltap::identification
