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

class UpdateLikelihood final : public inference::Likelihood {
 public:
  explicit UpdateLikelihood(const UpdateProblem& problem)
      : problem_(problem), predictor_(problem) {}

  double log_likelihood(int model, std::span<const double> x) override {
    evaluate(-std::numeric_limits<double>::infinity(), model, x, own_);
    return own_.log_likelihood;
  }
  void evaluate(double /*floor*/, int /*model*/, std::span<const double> x,
                inference::Evaluation& out) override {
    out.clear();
    if (!predictor_.solve(x)) {
      out.prediction.assign(problem_.update_case.data.frequencies_hz.size(),
                            std::numeric_limits<double>::quiet_NaN());
      return;
    }
    const auto score = predictor_.score(x);
    for (const auto& match : score.matches) out.prediction.push_back(match.frequency_hz);
    out.log_likelihood = score.log_likelihood;
  }
  bool gradient(int /*model*/, std::span<const double> x, std::span<double> out) override {
    return predictor_.gradient(x, out);
  }

 private:
  const UpdateProblem& problem_;
  ModePredictor predictor_;
  inference::Evaluation own_;
};

/// How exactly modes are to be computed: to a thousandth of the smallest scatter of a frequency,
/// and a fifth of that of a shape, by their bounds (errors are far below them).
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
  // The lower end of what an unknown scatter may be.
  if (data.cov_prior) cov = data.cov_prior->from_standard_normal(-2.0);
  if (data.shape_sd_prior) sd = data.shape_sd_prior->from_standard_normal(-2.0);
  // λ ∝ f².
  return {.eigenvalue = std::clamp(2e-3 * cov, 1e-8, 1e-5),
          .shape = std::clamp(0.2 * sd, 1e-4, 1e-2)};
}

double seconds_of(const UpdateProblem& problem, const std::vector<std::vector<double>>& draws) {
  ModePredictor predictor(problem);
  const std::size_t tried = std::min<std::size_t>(draws.size(), 50);
  std::vector<double> x;
  const auto began = std::chrono::steady_clock::now();
  for (std::size_t i = 0; i < tried; ++i) {
    x = draws[i];
    for (std::size_t p = x.size(); p < problem.problem.space.parameters().size(); ++p)
      x.push_back(problem.problem.space.parameters()[p].prior.from_standard_normal(0.0));
    if (predictor.solve(x)) static_cast<void>(predictor.score(x));
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
  // Of modes that are doubted there may be more than the structure has.
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

std::shared_ptr<const OutsidePredictor> predictor_in_front(const UpdateCase& update_case,
                                                           const UpdateProblemOptions& options) {
  const ModalData& data = update_case.data;
  const auto& unknowns = update_case.structure->parameters;
  const auto must = [](const char* what, int has, int wanted) {
    if (has != wanted)
      throw std::invalid_argument(std::string("the model has ") + std::to_string(has) + " " + what +
                                  ", must have " + std::to_string(wanted));
  };
  must("inputs", options.outside->inputs(), static_cast<int>(unknowns.size()));
  must("outputs", options.outside->outputs(), data.modes() + data.predict);
  if (data.has_shapes() || update_case.states)
    throw std::invalid_argument(
        "the model predicts frequencies: there must be no shapes or states");
  auto out = std::make_shared<OutsidePredictor>(OutsidePredictor{.model = options.outside});
  if (options.emulator)
    out->emulator = std::make_shared<const OutsideEmulator>(
        *options.outside, unknowns, *options.emulator, options.threads, options.progress);
  return out;
}

}  // namespace

const std::vector<std::string>& scatter_names() {
  static const std::vector<std::string> names = {"cov", "shape_sd", "discrepancy",
                                                 "shape_discrepancy", "mixing"};
  return names;
}

ModalNoise UpdateProblem::noise(std::span<const double> x) const {
  ModalNoise out = scatters(x);
  if (const OutsidePredictor* outside = program(); outside != nullptr && outside->emulator) {
    const auto outputs = static_cast<std::size_t>(outside->model->outputs());
    std::vector<double> ignored(outputs);
    out.emulator_variance.resize(outputs);
    if (outside->emulator->contains(theta(x)))
      outside->predict(theta(x), ignored, out.emulator_variance);
  }
  return out;
}

ModalNoise UpdateProblem::scatters(std::span<const double> x) const {
  const ModalData& data = update_case.data;
  const auto at = [&](int place, double known) {
    return place < 0 ? known : x[static_cast<std::size_t>(place)];
  };
  return {.cov = at(cov, 0.0),
          .shape_sd = at(shape_sd, 1.0),
          .discrepancy = at(discrepancy, data.discrepancy.value),
          .shape_discrepancy = at(shape_discrepancy, data.shape_discrepancy.value),
          .mixing = at(mixing, data.mixing.value)};
}

namespace {

bool asks_each_time(const UpdateProblem& problem) {
  return problem.program() != nullptr && !problem.program()->emulator;
}

}  // namespace

std::unique_ptr<const UpdateProblem> make_update_problem(UpdateCase update_case,
                                                         const UpdateProblemOptions& options) {
  const auto states = update_case.states ? std::make_shared<const StatesLikelihood>(
                                               update_case.states, std::vector<DefectKind>{})
                                         : nullptr;
  const auto likelihood =
      states ? nullptr : std::make_shared<const ModalLikelihood>(update_case.data);

  std::vector<inference::Parameter> parameters =
      states ? update_case.states->parameters() : update_case.structure->parameters;
  if (parameters.empty())
    throw std::invalid_argument("parameters is empty: there is nothing to be learnt");
  const auto structural = static_cast<int>(parameters.size());
  std::vector<int> places;
  const ModalData& data = update_case.data;
  for (const auto& prior : {data.cov_prior, data.shape_sd_prior, data.discrepancy.prior,
                            data.shape_discrepancy.prior, data.mixing.prior}) {
    places.push_back(prior ? static_cast<int>(parameters.size()) : -1);
    const std::string& name = scatter_names()[places.size() - 1];
    if (prior) parameters.push_back({name, *prior});
  }
  std::vector<std::string> names;
  for (const auto& parameter : parameters) names.push_back(parameter.name);

  decltype(UpdateProblem::solution) solution = UpdateProblem::ByStates{states};
  if (options.outside)
    solution = UpdateProblem::ByProgram{predictor_in_front(update_case, options), likelihood};
  else if (!states)
    solution = UpdateProblem::ByBasis{reduced_basis(update_case, *likelihood, options), likelihood};
  auto out = std::make_unique<UpdateProblem>(UpdateProblem{
      .update_case = std::move(update_case),
      .solution = std::move(solution),
      .problem = {.space =
                      inference::ModelSpace::of_models(parameters, {{"the structure", 1.0, names}}),
                  .likelihood = {}},
      .structural = structural,
      .cov = places[0],
      .shape_sd = places[1],
      .discrepancy = places[2],
      .shape_discrepancy = places[3],
      .mixing = places[4]});
  out->problem.likelihood = [problem = out.get()] {
    return std::make_unique<UpdateLikelihood>(*problem);
  };
  out->seconds_a_likelihood =
      states ? states->check(20).seconds_a_solution
             : seconds_of(*out, prior_draws(*out->update_case.structure,
                                            asks_each_time(*out) ? 1 : options.training));
  return out;
}

ModePredictor::ModePredictor(const UpdateProblem& problem) : problem_(problem) {
  if (problem.basis() != nullptr) workspace_ = problem.basis()->make_workspace();
  if (problem.states() != nullptr) states_workspace_ = problem.states()->make_workspace();
}

bool ModePredictor::solve(std::span<const double> x) {
  if (problem_.program() != nullptr) return ask_outside(x);
  if (problem_.states() != nullptr) {
    if (!problem_.states()->solve(problem_.theta(x), {}, states_workspace_, of_states_))
      return false;
    modes_ = of_states_.back();
    return true;
  }
  try {
    problem_.basis()->solve(problem_.theta(x), *workspace_, modes_);
  } catch (const std::invalid_argument&) {
    return false;
  } catch (const std::runtime_error&) {
    return false;  // so near to a mechanism that the solver gives up
  }
  return modes_.eigenvalues.allFinite() && modes_.eigenvalues.minCoeff() > 0.0;
}

ModalLikelihood::Score ModePredictor::score(std::span<const double> x) const {
  if (problem_.states() != nullptr) return problem_.states()->score(of_states_, problem_.noise(x));
  ModalNoise noise = problem_.scatters(x);
  noise.emulator_variance = variance_;
  return problem_.likelihood().score(modes_, noise);
}

bool ModePredictor::ask_outside(std::span<const double> x) {
  const auto outputs = static_cast<std::size_t>(problem_.program()->model->outputs());
  frequencies_hz_.resize(outputs);
  variance_.resize(outputs);
  // The box cuts priors off: searches go beyond it far too often to ask the model itself there.
  const auto& emulator = problem_.program()->emulator;
  if (emulator && !emulator->contains(problem_.theta(x))) return false;
  problem_.program()->predict(problem_.theta(x), frequencies_hz_, variance_);
  if (!problem_.program()->emulator) variance_.clear();
  modes_.eigenvalues.resize(static_cast<Eigen::Index>(outputs));
  for (std::size_t i = 0; i < outputs; ++i) {
    if (!(frequencies_hz_[i] > 0.0)) return false;
    modes_.eigenvalues[static_cast<Eigen::Index>(i)] = eigenvalue_of(frequencies_hz_[i]);
  }
  return true;
}

bool ModePredictor::gradient(std::span<const double> x, std::span<double> out) {
  if (problem_.states() != nullptr) return false;
  const auto structural = static_cast<std::size_t>(problem_.structural);
  if (problem_.program() != nullptr) {
    if (problem_.program()->emulator || !ask_outside(x)) return false;
    const auto pull = problem_.likelihood().pulls(modes_, problem_.scatters(x));
    if (!problem_.program()->model->gradient(problem_.theta(x), pull, out.first(structural)))
      return false;
  } else {
    try {
      if (!problem_.basis()->differentiate(problem_.theta(x), *workspace_, modes_, slopes_))
        return false;
    } catch (const std::exception&) {
      return false;
    }
    if (!problem_.likelihood().slope(modes_, slopes_, problem_.scatters(x), out.first(structural)))
      return false;
  }
  // Scatters move no mode: differences cost next to nothing.
  std::vector<double> moved(x.begin(), x.end());
  for (std::size_t p = structural; p < x.size(); ++p) {
    const double step = 1e-5 * std::max(std::abs(x[p]), 1e-8);
    moved[p] = x[p] + step;
    const double above = score(moved).log_likelihood;
    moved[p] = x[p] - step;
    out[p] = (above - score(moved).log_likelihood) / (2.0 * step);
    moved[p] = x[p];
  }
  return true;
}

}  // namespace wheeltap::identification
