#include "identification/structural/updating/update_problem.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "fem/structures/modes/structure_modes.hpp"
#include "identification/structural/structure_family.hpp"

namespace wheeltap::identification {
namespace {

/// Largest size of an eigenvalue problem that takes about as long as a step of the sampler.
constexpr int kCheapModes = 40;

/// Error bounds of computed modes: a thousandth of the smallest scatter of a frequency, a fifth of
/// the smallest scatter of a shape. Actual errors are far smaller.
struct Tolerances {
  double eigenvalue = 1e-6, shape = 1e-3;
};

Tolerances tolerances_of(const ModalLikelihood& likelihood) {
  const ModalData& data = likelihood.data();
  double cov = std::numeric_limits<double>::infinity(), sd = cov;
  for (int i = 0; i < data.modes(); ++i) {
    const double f = data.frequencies_hz[static_cast<std::size_t>(i)];
    if (!std::isnan(f) && !data.cov_prior)
      cov = std::min(cov, std::sqrt(data.covariance(i, i)) / f);
    if (likelihood.shape(i) && !data.shape_sd_prior) sd = std::min(sd, likelihood.shape(i)->sd());
  }
  // If the scatter is unknown, take a low quantile of its prior.
  if (data.cov_prior) cov = data.cov_prior->from_standard_normal(-2.0);
  if (data.shape_sd_prior) sd = data.shape_sd_prior->from_standard_normal(-2.0);
  // λ ∝ f²: the relative error of λ is twice that of f.
  return {.eigenvalue = std::clamp(2e-3 * cov, 1e-8, 1e-5),
          .shape = std::clamp(0.2 * sd, 1e-4, 1e-2)};
}

double seconds_of(const UpdateProblem& problem, const std::vector<std::vector<double>>& draws) {
  StructuralPredictor predictor(problem);
  ModeObservation::Scored scored;
  const std::size_t tried = std::min<std::size_t>(draws.size(), 50);
  std::vector<double> x;
  const auto began = std::chrono::steady_clock::now();
  for (std::size_t i = 0; i < tried; ++i) {
    x = draws[i];
    for (std::size_t p = x.size(); p < problem.problem.space.parameters().size(); ++p)
      x.push_back(problem.problem.space.parameters()[p].prior.from_standard_normal(0.0));
    static_cast<void>(predictor.score(0, x, scored));
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
  return took.count() / static_cast<double>(std::max<std::size_t>(1, tried));
}

std::shared_ptr<const fem::ParametricModes> reduced_basis(const UpdateCase& update_case,
                                                          const ModalLikelihood& likelihood,
                                                          const UpdateProblemOptions& options) {
  const StructureModel& model = *update_case.structure;
  const ModalData& data = update_case.data;
  const auto draws = prior_draws(model, options.training);
  auto structure =
      std::make_shared<const fem::ParametricStructure>(family_of(update_case.structure), draws);
  const auto available = static_cast<int>(fem::mode_count(structure->nominal()) -
                                          structure->nominal().rigid_motions.cols());
  std::vector<fem::SparseRow> motions;
  if (data.has_shapes())
    for (const Sensor& sensor : data.sensors) motions.push_back(sensor.motion);
  const Tolerances tolerances = tolerances_of(likelihood);
  // If modes may be spurious, the data may have more modes than the structure.
  const int candidates = likelihood.candidates(available);
  return std::make_shared<const fem::ParametricModes>(
      std::move(structure), draws,
      fem::ParametricModesOptions{
          .modes = data.doubt > 0.0 ? candidates : std::max(data.least_modes(), candidates),
          .motions = std::move(motions),
          .tolerance = tolerances.eigenvalue,
          .shape_tolerance = tolerances.shape,
          .progress = options.progress});
}

OutsidePredictor predictor_in_front(const UpdateCase& update_case,
                                    const UpdateProblemOptions& options) {
  const ModalData& data = update_case.data;
  const auto& unknowns = update_case.structure->parameters;
  const auto must = [](const char* what, int has, int wanted) {
    if (has != wanted)
      throw std::invalid_argument(std::string("the model has ") + std::to_string(has) + " " + what +
                                  ": must be " + std::to_string(wanted));
  };
  must("inputs", options.outside->inputs(), static_cast<int>(unknowns.size()));
  must("outputs", options.outside->outputs(), data.modes() + data.predict);
  if (data.has_shapes() || update_case.states)
    throw std::invalid_argument(
        "the model predicts frequencies only: shapes and states are not allowed");
  OutsidePredictor out{.model = options.outside};
  if (options.emulator)
    out.emulator = std::make_shared<const OutsideEmulator>(
        *options.outside, unknowns, *options.emulator, options.threads, options.progress);
  return out;
}

}  // namespace

ModalNoise UpdateProblem::noise(std::span<const double> x) const {
  ModalNoise out = modal_noise(x);
  if (const OutsidePredictor* outside = program(); outside != nullptr && outside->emulator) {
    const auto outputs = static_cast<std::size_t>(outside->model->outputs());
    std::vector<double> ignored(outputs);
    out.emulator_variance.resize(outputs);
    if (outside->emulator->contains(theta(x)))
      outside->predict(theta(x), ignored, out.emulator_variance);
  }
  return out;
}

std::unique_ptr<const UpdateProblem> make_update_problem(UpdateCase update_case,
                                                         const UpdateProblemOptions& options) {
  auto out = std::make_unique<UpdateProblem>();
  ModalData scatters = update_case.data;
  scatters.stiffness_discrepancy = {};  // applies to damage only
  const auto states = update_case.states ? std::make_shared<const StatesLikelihood>(
                                               update_case.states, std::vector<DefectKind>{})
                                         : nullptr;
  out->observed = states ? observe_states(states, UnknownScatters(scatters))
                         : observe_structure(update_case.data, UnknownScatters(scatters));
  const std::vector<inference::Parameter> structural =
      states ? update_case.states->parameters() : update_case.structure->parameters;
  if (structural.empty())
    throw std::invalid_argument("parameters is empty: must have at least one unknown");
  const std::vector<inference::Parameter> parameters =
      out->place_parameters(StructuralProblem::First::structure, structural, options.observations);
  std::vector<std::string> names;
  for (const auto& parameter : parameters) names.push_back(parameter.name);

  if (options.model)
    out->model = options.model;
  else if (options.outside)
    out->model = std::make_shared<const OutsideModes>(predictor_in_front(update_case, options));
  else if (states)
    out->model = std::make_shared<const StatesModel>(states);
  else
    out->model =
        std::make_shared<const BasisModel>(reduced_basis(update_case, out->modes().of(0), options));
  if (const fem::ParametricModes* basis = out->basis(); basis != nullptr)
    out->problem.costly = basis->training().basis > kCheapModes;
  out->update_case = std::move(update_case);
  out->problem.space =
      inference::ModelSpace::of_models(parameters, {{"the structure", 1.0, names}});
  out->problem.likelihood = likelihood_of(*out, *out->model);
  out->seconds_a_likelihood =
      states ? states->check(20).seconds_a_solution
             : seconds_of(*out, prior_draws(*out->update_case.structure,
                                            out->model->is_expensive() ? 1 : options.training));
  return out;
}

}  // namespace wheeltap::identification
