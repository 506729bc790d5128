#include "identification/structural/damage/damage_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/constants.hpp"
#include "fem/structures/modes/structure_modes.hpp"
#include "identification/invalid_input.hpp"
#include "identification/structural/forward/assembled_model.hpp"
#include "identification/structural/forward/beam_model.hpp"
#include "inference/moves/between_models/split_merge.hpp"

namespace wheeltap::identification {
namespace {

using inference::Prior;

class FrequencyLikelihood final : public inference::Likelihood {
 public:
  /// `emulated`: predicted by the problem's emulator where there are damages.
  FrequencyLikelihood(const DamageProblem& problem, bool emulated)
      : problem_(problem),
        emulated_(emulated),
        data_(problem.damage_case.data),
        noise_(data_),
        predictor_(problem),
        variance_(data_.frequencies_hz.size()),
        gradient_prediction_(data_.frequencies_hz.size()) {}

  double log_likelihood(int model, std::span<const double> x) override {
    evaluate(-std::numeric_limits<double>::infinity(), model, x, own_);
    return own_.log_likelihood;
  }

  void evaluate(double /*floor*/, int model, std::span<const double> x,
                inference::Evaluation& out) override {
    out.clear();
    out.prediction.resize(data_.frequencies_hz.size());
    if (problem_.by_modes()) return of_modes(model, x, out);
    const double cv = data_.cv_prior ? x[0] : 0.0;
    out.noise_scale = data_.cv_prior ? cv : 1.0;
    if (emulated_) {
      predictor_.emulate(model, x, out.prediction, variance_);
    } else {
      predictor_.solve(model, x, out.prediction);
    }
    out.log_likelihood = noise_.log_likelihood(
        out.prediction, emulated_ ? std::span<const double>(variance_) : std::span<const double>(),
        cv, out.residuals);
  }

  // With r = (f_obs - f) / sd:  ∂ ln p/∂f = r / sd,  ∂ ln p/∂cv = (r² - 1) cv f_obs² / sd².
  bool gradient(int model, std::span<const double> x, std::span<double> out) override {
    if (emulated_) return false;
    const std::size_t d = x.size();
    jacobian_.resize(gradient_prediction_.size() * d);
    if (!predictor_.differentiate(model, x, gradient_prediction_, jacobian_)) return false;
    const double cv = data_.cv_prior ? x[0] : 0.0;
    std::ranges::fill(out, 0.0);
    for (std::size_t i = 0; i < gradient_prediction_.size(); ++i) {
      const double observed = data_.frequencies_hz[i];
      if (std::isnan(observed)) continue;
      const double sd = noise_.sd(i, cv, 0.0);
      const double residual = (observed - gradient_prediction_[i]) / sd;
      for (std::size_t j = 0; j < d; ++j) out[j] += residual / sd * jacobian_[i * d + j];
      if (data_.cv_prior)
        out[0] += (residual * residual - 1.0) * cv * (observed / sd) * (observed / sd);
    }
    return true;
  }

 private:
  void of_modes(int model, std::span<const double> x, inference::Evaluation& out) {
    if (!predictor_.score(model, x, scored_)) {
      std::ranges::fill(out.prediction, std::numeric_limits<double>::infinity());
      return;
    }
    for (std::size_t i = 0; i < out.prediction.size(); ++i)
      out.prediction[i] = scored_.score.matches[i].frequency_hz;
    out.log_likelihood = scored_.score.log_likelihood;
  }

  const DamageProblem& problem_;
  ModeObservation::Scored scored_;
  bool emulated_;
  const FrequencyData& data_;
  NoiseModel noise_;
  FrequencyPredictor predictor_;
  inference::Evaluation own_;
  std::vector<double> variance_, gradient_prediction_, jacobian_;
};

// Same density at x and L - x, tried at quantiles from the bulk to the tails.
bool is_mirror_symmetric(const Prior& prior, double length) {
  for (double z = -4.0; z <= 4.0; z += 0.5) {
    const double here = prior.from_standard_normal(z);
    const double mirrored = prior.from_standard_normal(-z);
    if (std::abs(here + mirrored - length) > 1e-9 * length) return false;
  }
  return true;
}

// What the intact structure's symmetry cannot tell apart, and the moves from one to the other.
// Where the data tell the images apart the moves remain: shapes of 1 % leave each image its share.
void find_images(DamageProblem& problem, bool told_apart) {
  const DamageCase& damage_case = problem.damage_case;
  SiteSymmetries found = find_symmetries(
      damage_case.structure->nominal, damage_case.kinds,
      problem.by_modes() ? problem.modes().all_frequencies() : problem.forward().all_frequencies());
  if (found.empty()) return;
  for (const bool whole : {true, false}) {
    problem.problem.moves.push_back({whole ? "image" : "image of one", [maps = found.maps, whole] {
                                       return std::make_unique<inference::Image>(maps, whole);
                                     }});
  }
  if (!told_apart) problem.symmetries = std::move(found);
}

// Every combination of the kinds' counts, the last kind running fastest, with product weights.
std::vector<inference::ModelSpace::Counts> combinations(const std::vector<DefectKind>& kinds) {
  std::vector<inference::ModelSpace::Counts> list = {{{}, 1.0}};
  for (const DefectKind& kind : kinds) {
    std::vector<inference::ModelSpace::Counts> longer;
    for (const auto& head : list) {
      for (int n = kind.min_count; n <= kind.max_count; ++n) {
        auto next = head;
        next.counts.push_back(n);
        next.weight *= kind.weights[static_cast<std::size_t>(n - kind.min_count)];
        longer.push_back(std::move(next));
      }
    }
    list = std::move(longer);
  }
  // A model with no prior weight is no candidate.
  std::erase_if(list, [](const auto& entry) { return !(entry.weight > 0.0); });
  return list;
}

std::vector<inference::ComponentKind> component_kinds(const DamageCase& damage_case) {
  std::vector<inference::ComponentKind> kinds;
  for (const DefectKind& kind : damage_case.kinds) {
    inference::ComponentKind component{kind.name, kind.plural, {{"location", kind.location}}};
    if (const Prior* severity = kind.severity_prior())
      component.parameters.push_back({kind.severity_name(), *severity});
    if (kind.extent_prior) component.parameters.push_back({"extent", *kind.extent_prior});
    kinds.push_back(std::move(component));
  }
  return kinds;
}

std::vector<inference::Parameter> scatter_parameters(const DamageCase& damage_case) {
  std::vector<inference::Parameter> scatters;
  const auto add = [&](const char* name, const std::optional<Prior>& prior) {
    if (prior) scatters.push_back({name, *prior});
  };
  add("cov", damage_case.data.cv_prior);
  if (damage_case.modal) {  // in the order of `modal_noise`
    const ModalData& data = *damage_case.modal;
    add("shape_sd", data.shape_sd_prior);
    add("discrepancy", data.discrepancy.prior);
    add("shape_discrepancy", data.shape_discrepancy.prior);
    add("mixing", data.mixing.prior);
    add("stiffness_discrepancy", data.stiffness_discrepancy.prior);
  }
  return scatters;
}

/// A structure, or a beam whose modes or defects need one.
void observe_assembled(DamageProblem& problem) {
  const DamageCase& damage_case = problem.damage_case;
  const AnyStructure structure = damage_case.solved_structure();
  const int rigid = damage_case.rigid_body_modes;
  if (!damage_case.modal) {
    problem.observed = std::make_shared<const AssembledModel>(structure, damage_case.kinds,
                                                              damage_case.modes() + rigid, rigid);
    return;
  }
  int elastic = static_cast<int>(fem::mode_count(discretise(structure))) - rigid;
  for (const DefectKind& kind : damage_case.kinds)
    elastic -= kind.type->may_be_known ? kind.max_count : 0;
  std::vector<fem::SparseRow> motions;
  for (const Sensor& sensor : damage_case.modal->sensors) motions.push_back(sensor.motion);
  problem.observed = observe_structure(
      std::make_shared<const AssembledModel>(
          structure, damage_case.kinds,
          rigid + ModalLikelihood(*damage_case.modal).candidates(elastic), rigid, motions),
      *damage_case.modal);
}

/// What predicts: states of a structure, one structure, or a beam, which is returned.
std::shared_ptr<const BeamModel> observe(DamageProblem& problem) {
  const DamageCase& damage_case = problem.damage_case;
  if (!damage_case.states && !damage_case.solved_as_structure()) {
    const auto beam = std::make_shared<const BeamModel>(
        damage_case.beam, damage_case.kinds, damage_case.modes(), damage_case.rigid_body_modes);
    problem.observed = beam;
    return beam;
  }
  try {
    if (damage_case.states)
      problem.observed = observe_states(damage_case.states, damage_case.kinds);
    else
      observe_assembled(problem);
  } catch (const fem::InvalidStructure& error) {
    throw InvalidInput(InvalidInput::Part::beam, error.what());
  } catch (const std::invalid_argument& error) {
    throw InvalidInput(damage_case.states ? InvalidInput::Part::data : InvalidInput::Part::beam,
                       error.what());
  }
  return nullptr;
}

void add_symmetries(DamageProblem& problem, bool mirrored) {
  const DamageCase& damage_case = problem.damage_case;
  const auto& states = damage_case.states;
  const bool told_apart =
      (damage_case.modal && damage_case.modal->has_shapes()) || (states && states->has_shapes());
  problem.symmetric =
      mirrored && problem.program() == nullptr && !told_apart && !(states && states->tells_sides());
  if (mirrored)
    for (int k = 0; k < static_cast<int>(damage_case.kinds.size()); ++k)
      problem.problem.reflections.push_back({k, 0, 0.5 * damage_case.beam.length});
  if (damage_case.structure) find_images(problem, told_apart);
}

// Two damages in one element are hard to tell from one that compounds them, but far from it.
void add_split_merges(DamageProblem& problem) {
  using inference::SplitMerge;
  for (int k = 0; k < static_cast<int>(problem.damage_case.kinds.size()); ++k) {
    const DefectKind& kind = problem.damage_case.kinds[static_cast<std::size_t>(k)];
    if (!kind.type->compounds || kind.max_count < 2) continue;
    const double h = kind.line.length() / static_cast<double>(kind.line.cells());
    problem.problem.moves.push_back({"split and merge", [k, h] {
                                       return std::make_unique<SplitMerge>(
                                           k, h, SplitMerge::Keeps::product_of_complements);
                                     }});
  }
}

void make_emulator(DamageProblem& problem, const fem::Reanalysis& reanalysis,
                   const DamageProblemOptions& options) {
  const DamageCase& damage_case = problem.damage_case;
  const EmulatorSpec& spec = *damage_case.emulator;
  const DefectKind& kind = damage_case.kinds[0];
  const int modes = damage_case.modes();
  try {
    problem.emulator = std::make_shared<const FrequencyEmulator>(
        spec.table ? FrequencyEmulator::load(*spec.table, damage_case.beam, kind.max_count, modes)
                   : FrequencyEmulator::train(
                         reanalysis, spec, kind, modes,
                         {.threads = options.threads,
                          .progress = options.table_progress,
                          .model = options.outside ? outside_model(*options.outside, kind.max_count)
                                                   : emulator::ModelFactory()}));
  } catch (const emulator::RunError& error) {
    std::rethrow_if_nested(error);  // of a model of someone else's
    throw;
  } catch (const std::invalid_argument& error) {
    throw InvalidInput(InvalidInput::Part::emulator, error.what());
  }
  if (const auto outside = problem.emulator->reaches_outside(kind))
    throw InvalidInput(outside->part, outside->message);
}

inference::LikelihoodFactory likelihood_of(const DamageProblem& problem, bool emulated) {
  return [&problem, emulated] { return std::make_unique<FrequencyLikelihood>(problem, emulated); };
}

}  // namespace

FrequencyPredictor::FrequencyPredictor(const DamageProblem& problem) : problem_(problem) {
  if (problem.by_modes())
    mode_solver_ = problem.modes().make_solver();
  else
    solver_ = problem.forward().make_solver();
}

void FrequencyPredictor::place(int model, std::span<const double> x) {
  problem_.components(model, x, defects_);
}

void FrequencyPredictor::solve_placed(std::span<double> out) {
  // The likelihood of what is no structure is 0.
  if (!solver_->frequencies(defects_, out))
    std::ranges::fill(out, std::numeric_limits<double>::infinity());
}

void FrequencyPredictor::solve(int model, std::span<const double> x, std::span<double> out) {
  if (problem_.by_modes()) {
    ModeObservation::Scored found;
    if (!score(model, x, found)) {
      std::ranges::fill(out, std::numeric_limits<double>::infinity());
      return;
    }
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = found.score.matches[i].frequency_hz;
    return;
  }
  place(model, x);
  solve_placed(out);
}

bool FrequencyPredictor::score(int model, std::span<const double> x, ModeObservation::Scored& out) {
  place(model, x);
  const auto theta = x.subspan(static_cast<std::size_t>(problem_.scatters));
  return mode_solver_->score(theta, defects_, problem_.modal_noise(x), out);
}

bool FrequencyPredictor::differentiate(int model, std::span<const double> x, std::span<double> out,
                                       std::span<double> jacobian) {
  if (problem_.by_modes()) return false;
  place(model, x);
  if (!solver_->differentiate(defects_, out, slopes_)) return false;
  std::ranges::fill(jacobian, 0.0);
  const inference::Model& m = problem_.problem.space[model];
  std::size_t defect = 0;
  for (std::size_t k = 0; k < problem_.damage_case.kinds.size(); ++k) {
    const auto width = static_cast<std::size_t>(problem_.damage_case.kinds[k].parameters());
    for (int c = 0; c < m.counts[k]; ++c, ++defect) {
      const auto at = static_cast<std::size_t>(m.offsets[k]) + width * static_cast<std::size_t>(c);
      for (std::size_t i = 0; i < out.size(); ++i) {
        const std::size_t of = i * defects_.size() + defect;
        jacobian[i * x.size() + at] = slopes_.by_location[of];
        if (width == 2) jacobian[i * x.size() + at + 1] = slopes_.by_severity[of];
      }
    }
  }
  return true;
}

void FrequencyPredictor::emulate(int model, std::span<const double> x, std::span<double> out,
                                 std::span<double> variance) {
  place(model, x);
  place_in_beam(problem_.damage_case.kinds, defects_, placed_);
  if (!placed_.damages.empty()) {
    std::ranges::sort(placed_.damages, {}, &fem::Damage::location);
    const bool wanted = problem_.damage_case.emulator->emulator_error;
    if (wanted) {
      problem_.emulator->evaluate(placed_.damages, out, variance);
    } else {
      problem_.emulator->evaluate(placed_.damages, out);
      std::ranges::fill(variance, 0.0);
    }
    if (std::ranges::none_of(out, [](double f) { return std::isnan(f); })) return;
  }
  // No damage needs no emulator; nor does a sum of ANOVA that is no frequency have one.
  solve_placed(out);
  std::ranges::fill(variance, 0.0);
}

ModalNoise DamageProblem::modal_noise(std::span<const double> x) const {
  const ModalData& data = *damage_case.modal;
  std::size_t next = 0;
  const auto at = [&](bool inferred, double known) { return inferred ? x[next++] : known; };
  ModalNoise noise;
  noise.cov = at(data.cov_prior.has_value(), 0.0);
  noise.shape_sd = at(data.shape_sd_prior.has_value(), 1.0);
  noise.discrepancy = at(!data.discrepancy.known(), data.discrepancy.value);
  noise.shape_discrepancy = at(!data.shape_discrepancy.known(), data.shape_discrepancy.value);
  noise.mixing = at(!data.mixing.known(), data.mixing.value);
  noise.stiffness_discrepancy =
      at(!data.stiffness_discrepancy.known(), data.stiffness_discrepancy.value);
  return noise;
}

std::vector<DamageProblem::Component> DamageProblem::components(int model,
                                                                std::span<const double> x) const {
  std::vector<Component> list;
  components(model, x, list);
  return list;
}

void DamageProblem::components(int model, std::span<const double> x,
                               std::vector<Component>& to) const {
  to.clear();
  const inference::Model& m = problem.space[model];
  for (std::size_t k = 0; k < damage_case.kinds.size(); ++k) {
    const DefectKind& kind = damage_case.kinds[k];
    const auto width = static_cast<std::size_t>(kind.parameters());
    for (int c = 0; c < m.counts[k]; ++c) {
      const auto at = static_cast<std::size_t>(m.offsets[k]) + width * static_cast<std::size_t>(c);
      to.push_back({.kind = static_cast<int>(k),
                    .location = x[at],
                    .severity = kind.severity_prior() ? x[at + 1] : kind.known_severity(),
                    .extent = kind.extent_prior ? x[at + width - 1] : 0.0});
    }
  }
}

std::vector<std::string> outside_inputs(const DamageCase& damage_case) {
  std::vector<std::string> names;
  for (const DefectKind& kind : damage_case.kinds) {
    const std::string prefix = damage_case.kinds.size() > 1 ? kind.name + " " : "";
    for (int c = 1; c <= kind.max_count; ++c) {
      std::vector<std::string> own = {"location", kind.severity_name()};
      if (kind.extent_prior) own.emplace_back("extent");
      for (const std::string& name : own)
        names.push_back(prefix + name + "[" + std::to_string(c) + "]");
    }
  }
  return names;
}

std::unique_ptr<const DamageProblem> make_damage_problem(DamageCase damage_case,
                                                         const DamageProblemOptions& options) {
  complete(damage_case);
  std::vector<inference::Parameter> common = scatter_parameters(damage_case);
  const auto scatters = static_cast<int>(common.size());
  if (damage_case.states)
    for (auto& parameter : damage_case.states->parameters()) common.push_back(parameter);

  auto out = std::make_unique<DamageProblem>(DamageProblem{
      .damage_case = damage_case,
      .problem = {.space = inference::ModelSpace::of_components(
                      common, component_kinds(damage_case), combinations(damage_case.kinds)),
                  .likelihood = {}},
      .fe_likelihood = nullptr,
      .common = static_cast<int>(common.size()),
      .scatters = scatters});
  const auto beam = observe(*out);
  if (options.outside) {
    if (!beam)
      throw InvalidInput(InvalidInput::Part::data,
                         "a predictor of one's own goes with a beam and its frequencies: "
                         "there must be no shapes, states or structure");
    out->observed = std::make_shared<const ProgramModel>(options.outside, damage_case.kinds);
  }
  bool mirrored = !damage_case.structure && fem::is_mirror_symmetric(damage_case.beam);
  for (const DefectKind& kind : damage_case.kinds)
    mirrored = mirrored && is_mirror_symmetric(kind.location, damage_case.beam.length);
  add_symmetries(*out, mirrored);
  add_split_merges(*out);
  if (damage_case.emulator) make_emulator(*out, beam->reanalysis(), options);
  out->fe_likelihood = likelihood_of(*out, false);
  out->problem.likelihood = likelihood_of(*out, out->emulator && !out->exact());
  if (out->exact()) out->problem.screen = likelihood_of(*out, true);
  return out;
}

}  // namespace wheeltap::identification
