#include "identification/structural/damage/damage_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/constants.hpp"
#include "fem/structures/modes/structure_modes.hpp"
#include "identification/invalid_input.hpp"
#include "identification/structural/damage/emulated_model.hpp"
#include "identification/structural/forward/assembled_model.hpp"
#include "identification/structural/forward/beam_model.hpp"
#include "inference/moves/between_models/split_merge.hpp"

namespace wheeltap::identification {
namespace {

using inference::Prior;

// True if the density is equal at x and L - x, tested at quantiles from the centre to the tails.
bool is_mirror_symmetric(const Prior& prior, double length) {
  for (double z = -4.0; z <= 4.0; z += 0.5) {
    const double here = prior.from_standard_normal(z);
    const double mirrored = prior.from_standard_normal(-z);
    if (std::abs(here + mirrored - length) > 1e-9 * length) return false;
  }
  return true;
}

// Finds the images that the structure's symmetry makes indistinguishable, and adds moves between
// them. The moves remain if the data distinguish the images, because with shape errors of 1 % each
// image still has some probability.
void find_images(DamageProblem& problem, bool told_apart) {
  const DamageCase& damage_case = problem.damage_case;
  const ForwardModel::AllFrequencies all_frequencies = problem.model->all_frequencies();
  if (!all_frequencies) return;
  SiteSymmetries found =
      find_symmetries(damage_case.structure->nominal, damage_case.kinds, all_frequencies);
  if (found.empty()) return;
  for (const bool whole : {true, false}) {
    problem.problem.moves.push_back({whole ? "image" : "image of one", [maps = found.maps, whole] {
                                       return std::make_unique<inference::Image>(maps, whole);
                                     }});
  }
  if (!told_apart && problem.as_case) problem.symmetries = std::move(found);
}

// All combinations of the kinds' counts, the last kind varying fastest, with products as weights.
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

/// The unknown noise parameters of measured modes; empty if modes are identified by number.
UnknownScatters scatters_of(const DamageCase& damage_case) {
  return UnknownScatters(damage_case.modal() ? *damage_case.modal() : ModalData{});
}

/// Sets up a structure, or a beam whose modes or defects require one.
void observe_assembled(DamageProblem& problem) {
  const DamageCase& damage_case = problem.damage_case;
  const AnyStructure structure = damage_case.solved_structure();
  const int rigid = damage_case.rigid_body_modes;
  if (!damage_case.modal()) {
    problem.model = std::make_shared<const AssembledModel>(structure, damage_case.kinds,
                                                           damage_case.modes() + rigid, rigid);
    return;
  }
  int elastic = static_cast<int>(fem::mode_count(discretise(structure))) - rigid;
  for (const DefectKind& kind : damage_case.kinds)
    elastic -= kind.type->may_be_known ? kind.max_count : 0;
  std::vector<fem::SparseRow> motions;
  for (const Sensor& sensor : damage_case.modal()->sensors) motions.push_back(sensor.motion);
  const auto observed = observe_structure(*damage_case.modal(), scatters_of(damage_case));
  problem.observed = observed;
  problem.model = std::make_shared<const AssembledModel>(
      structure, damage_case.kinds, rigid + observed->of(0).candidates(elastic), rigid, motions);
}

/// Sets up the forward model: states of a structure, one structure, or a beam, which is returned.
std::shared_ptr<const BeamModel> observe(DamageProblem& problem) {
  const DamageCase& damage_case = problem.damage_case;
  problem.observed = std::make_shared<const FrequencyObservation>(damage_case.data);
  if (!damage_case.states() && !damage_case.solved_as_structure()) {
    const auto beam = std::make_shared<const BeamModel>(
        damage_case.beam, damage_case.kinds, damage_case.modes(), damage_case.rigid_body_modes);
    problem.model = beam;
    return beam;
  }
  try {
    if (damage_case.states()) {
      const auto states = std::make_shared<const StatesLikelihood>(
          damage_case.states(), damage_case.kinds, damage_case.intact_beam());
      problem.observed = observe_states(states, scatters_of(damage_case));
      problem.model = std::make_shared<const StatesModel>(states);
    } else {
      observe_assembled(problem);
    }
  } catch (const fem::InvalidStructure& error) {
    throw InvalidInput(InvalidInput::Part::beam, error.what());
  } catch (const std::invalid_argument& error) {
    throw InvalidInput(damage_case.states() ? InvalidInput::Part::data : InvalidInput::Part::beam,
                       error.what());
  }
  return nullptr;
}

void add_symmetries(DamageProblem& problem, bool mirrored) {
  const DamageCase& damage_case = problem.damage_case;
  const auto& states = damage_case.states();
  const bool told_apart = (damage_case.modal() && damage_case.modal()->has_shapes()) ||
                          (states && states->has_shapes());
  problem.symmetric =
      mirrored && problem.as_case && !told_apart && !(states && states->tells_sides());
  if (mirrored)
    for (int k = 0; k < static_cast<int>(damage_case.kinds.size()); ++k)
      problem.problem.reflections.push_back({k, 0, 0.5 * damage_case.beam.length});
  if (damage_case.structure) find_images(problem, told_apart);
}

// Two damages in one element act like one damage with their combined stiffness, but the two models
// are distant in parameter space.
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
    std::rethrow_if_nested(error);  // from an external model
    throw;
  } catch (const std::invalid_argument& error) {
    throw InvalidInput(InvalidInput::Part::emulator, error.what());
  }
  if (const auto outside = problem.emulator->reaches_outside(kind))
    throw InvalidInput(outside->part, outside->message);
  problem.emulated = std::make_shared<const EmulatedModel>(problem.emulator, problem.model,
                                                           damage_case.kinds, spec.emulator_error);
}

}  // namespace

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
  auto out = std::make_unique<DamageProblem>();
  out->damage_case = damage_case;
  out->kinds = damage_case.kinds;
  const auto beam = observe(*out);
  if (options.outside) {
    if (!beam)
      throw InvalidInput(InvalidInput::Part::data,
                         "an external predictor needs a beam and its frequencies: "
                         "there must be no shapes, states or structure");
    out->model = std::make_shared<const ProgramModel>(options.outside, damage_case.kinds);
  }
  if (options.model) out->model = options.model;
  if (options.model && damage_case.emulator)
    throw InvalidInput(
        InvalidInput::Part::emulator,
        "is trained on the case's structure and cannot be combined with a model of your own");
  out->as_case = !options.outside && !options.model && options.observations.empty();
  const std::vector<inference::Parameter> common =
      out->place_parameters(StructuralProblem::First::noise,
                            damage_case.states() ? damage_case.states()->parameters()
                                                 : std::vector<inference::Parameter>{},
                            options.observations);
  out->common = static_cast<int>(common.size());
  out->problem.space = inference::ModelSpace::of_components(common, component_kinds(damage_case),
                                                            combinations(damage_case.kinds));
  bool mirrored = !damage_case.structure && fem::is_mirror_symmetric(damage_case.beam);
  for (const DefectKind& kind : damage_case.kinds)
    mirrored = mirrored && is_mirror_symmetric(kind.location, damage_case.beam.length);
  add_symmetries(*out, mirrored);
  add_split_merges(*out);
  if (damage_case.emulator) make_emulator(*out, beam->reanalysis(), options);
  out->fe_likelihood = likelihood_of(*out, *out->model);
  out->problem.likelihood = likelihood_of(*out, out->predicting());
  if (out->exact()) out->problem.screen = likelihood_of(*out, *out->emulated);
  return out;
}

}  // namespace wheeltap::identification
