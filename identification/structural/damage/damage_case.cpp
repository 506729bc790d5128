#include "identification/structural/damage/damage_case.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/number.hpp"
#include "base/random.hpp"
#include "fem/beam/modal_analysis.hpp"
#include "fem/structures/modes/structure_modes.hpp"
#include "identification/invalid_input.hpp"
#include "identification/structural/defects/placed_defect.hpp"

namespace wheeltap::identification {

int free_degrees_of_freedom(const fem::Beam& beam) {
  int n = 2 * beam.nodes();
  for (const fem::Support& s : beam.supports) {
    if (!s.stiffness) n -= (s.deflection ? 1 : 0) + (s.rotation ? 1 : 0);
  }
  return n;
}

int rigid_body_modes(const fem::Beam& beam) {
  const int free = free_degrees_of_freedom(beam);
  return fem::modal_analysis(beam, {}, {.modes = std::min(3, free)}).rigid_body_modes;
}

namespace {

void complete_beam(DamageCase& damage_case) {
  using Part = InvalidInput::Part;
  try {
    fem::validate(damage_case.beam);
  } catch (const std::invalid_argument& error) {
    throw InvalidInput(Part::beam, error.what());
  }
  if (free_degrees_of_freedom(damage_case.beam) < 1) {
    throw InvalidInput(Part::beam, "the supports leave no free degree of freedom");
  }
  damage_case.rigid_body_modes = rigid_body_modes(damage_case.beam);
  for (DefectKind& kind : damage_case.kinds) {
    if (kind.line.empty()) kind.line = SiteLine::of_beam(damage_case.beam);
  }
}

void complete_structure(DamageCase& damage_case) {
  try {
    damage_case.rigid_body_modes =
        static_cast<int>(discretise(damage_case.structure->nominal).rigid_motions.cols());
  } catch (const fem::InvalidStructure& error) {
    throw InvalidInput(InvalidInput::Part::beam, error.what());
  }
  for (std::size_t k = 0; k < damage_case.kinds.size(); ++k) {
    const DefectKind& kind = damage_case.kinds[k];
    if (kind.type != nullptr && kind.type->place_in_structure == nullptr) {
      throw InvalidInput(InvalidInput::Part::severity,
                         "\"" + std::string(kind.type->name) + "\" is for beams only",
                         static_cast<int>(k));
    }
    if (kind.line.empty()) {
      throw InvalidInput(InvalidInput::Part::location, "has no possible location",
                         static_cast<int>(k));
    }
  }
}

}  // namespace

void complete(DamageCase& damage_case) {
  using Part = InvalidInput::Part;
  if (damage_case.structure) {
    complete_structure(damage_case);
  } else {
    complete_beam(damage_case);
  }
  if (damage_case.kinds.empty()) {
    throw InvalidInput(Part::location, "has no kind of defect: needs at least one");
  }
  for (std::size_t k = 0; k < damage_case.kinds.size(); ++k) {
    DefectKind& kind = damage_case.kinds[k];
    const int index = static_cast<int>(k);
    if (kind.type == nullptr) throw InvalidInput(Part::severity, "has no type", index);
    if (kind.min_count < 0 || kind.max_count < kind.min_count) {
      throw InvalidInput(Part::location,
                         "counts from " + std::to_string(kind.min_count) + " to " +
                             std::to_string(kind.max_count) + ": must be 0 <= min <= max",
                         index);
    }
    const auto counts = static_cast<std::size_t>(kind.max_count - kind.min_count + 1);
    if (kind.weights.empty()) kind.weights.assign(counts, 1.0 / static_cast<double>(counts));
    if (kind.weights.size() != counts) {
      throw InvalidInput(Part::location,
                         std::to_string(kind.weights.size()) + " weights, must be " +
                             std::to_string(counts) + ", one per count",
                         index);
    }
    if (kind.location.lower() < 0.0 || kind.location.upper() > kind.line.length()) {
      throw InvalidInput(
          Part::location,
          "locations lie on the beam, in [0, " + base::number(kind.line.length()) + "] m", index);
    }
    for (const double weight : kind.weights) {
      if (!(weight >= 0.0)) {
        throw InvalidInput(Part::location, "a weight of " + base::number(weight) + ": must be >= 0",
                           index);
      }
    }
    if (const inference::Prior* severity = kind.severity_prior();
        severity != nullptr &&
        (severity->lower() < kind.type->lower || severity->upper() > kind.type->upper)) {
      throw InvalidInput(Part::severity,
                         "reaches from " + base::number(severity->lower()) + " to " +
                             base::number(severity->upper()) + ", but " +
                             std::string(kind.type->bounds_words),
                         index);
    }
    if (kind.extent_prior && !(kind.extent_prior->lower() >= 0.0)) {
      throw InvalidInput(Part::severity,
                         "the extent reaches down to " + base::number(kind.extent_prior->lower()) +
                             " m: must be positive",
                         index);
    }
    if (!kind.type->may_be_known && kind.severity_prior() == nullptr) {
      throw InvalidInput(Part::severity, "is missing: must be a prior", index);
    }
  }
  const FrequencyData& data = damage_case.data;
  if (data.measured() == 0 && !(damage_case.modal() && damage_case.modal()->has_shapes()))
    throw InvalidInput(Part::data, "has no frequency");
  if (!data.cv_prior && data.sd_hz.size() != data.frequencies_hz.size()) {
    throw InvalidInput(Part::data, std::to_string(data.sd_hz.size()) +
                                       " standard deviations, must be " +
                                       std::to_string(data.frequencies_hz.size()) +
                                       ", one per mode, or an unknown coefficient of variation");
  }
  for (std::size_t i = 0; i < data.frequencies_hz.size(); ++i) {
    const double f = data.frequencies_hz[i];
    if (std::isnan(f)) continue;
    const std::string mode = "mode " + std::to_string(i + 1) + ": ";
    if (!(f > 0.0 && std::isfinite(f))) {
      throw InvalidInput(Part::data, mode + base::number(f) + " Hz, must be positive");
    }
    if (!data.cv_prior && !(data.sd_hz[i] > 0.0 && std::isfinite(data.sd_hz[i]))) {
      throw InvalidInput(Part::data, mode + "a standard deviation of " +
                                         base::number(data.sd_hz[i]) + " Hz, must be positive");
    }
  }
}

fem::Defects DamageCase::true_defects() const {
  fem::Defects defects;
  for (const DefectKind& kind : kinds) {
    for (const DefectKind::True& t : kind.truth) {
      kind.type->place(kind, t.location, t.severity, defects);
    }
  }
  return defects;
}

fem::Discretisation true_structure(const DamageCase& damage_case) try {
  const AnyStructure structure = damage_case.solved_structure();
  const auto* members = std::get_if<fem::Structure>(&structure);
  const auto mesh = members ? std::make_unique<const fem::Mesh>(*members) : nullptr;
  std::vector<PlacedDefect> placed;
  for (std::size_t k = 0; k < damage_case.kinds.size(); ++k) {
    for (const DefectKind::True& t : damage_case.kinds[k].truth) {
      placed.push_back({static_cast<int>(k), t.location, t.severity, t.extent});
    }
  }
  return fem::changed(mesh ? mesh->discretisation() : discretise(structure),
                      structure_change(damage_case.kinds, placed, mesh.get()));
} catch (const fem::ImpossibleChange& error) {
  throw InvalidInput(InvalidInput::Part::truth, error.what());
} catch (const fem::InvalidStructure& error) {
  throw InvalidInput(InvalidInput::Part::beam, error.what());
}

std::vector<double> true_frequencies(const DamageCase& damage_case, int modes) try {
  const fem::Discretisation damaged = true_structure(damage_case);
  const auto rigid = static_cast<int>(damaged.rigid_motions.cols());
  const auto available = static_cast<int>(fem::mode_count(damaged));
  const fem::StructureModes found =
      fem::structure_modes(damaged, std::min(available, modes + rigid));
  return {found.frequencies_hz.begin() + rigid, found.frequencies_hz.end()};
} catch (const fem::InvalidStructure& error) {
  throw InvalidInput(InvalidInput::Part::beam, error.what());
}

Eigen::MatrixXd simulated_shapes(const DamageCase& damage_case, int modes, std::uint64_t seed) try {
  const fem::Discretisation damaged = true_structure(damage_case);
  if (std::ranges::any_of(damage_case.kinds, [](const DefectKind& kind) {
        return std::ranges::any_of(kind.truth,
                                   [](const auto& t) { return std::isinf(t.severity); });
      }))
    throw InvalidInput(
        InvalidInput::Part::truth,
        "cannot simulate shapes of a structure with a rigid support: give the support a stiffness");
  const auto rigid = static_cast<int>(damaged.rigid_motions.cols());
  const fem::StructureModes found = fem::structure_modes(damaged, modes + rigid);
  base::Random random(seed, 0, 1, base::Purpose::simulation);
  const auto& sensors = damage_case.modal()->sensors;
  Eigen::MatrixXd out(modes, static_cast<Eigen::Index>(sensors.size()));
  for (Eigen::Index i = 0; i < out.rows(); ++i) {
    for (Eigen::Index s = 0; s < out.cols(); ++s)
      out(i, s) = sensors[static_cast<std::size_t>(s)].motion.of(found.shapes.col(rigid + i));
    out.row(i) /= out.row(i).cwiseAbs().maxCoeff();
    for (double& entry : out.row(i)) entry += damage_case.simulation->shape_sd * random.normal();
  }
  return out;
} catch (const fem::InvalidStructure& error) {
  throw InvalidInput(InvalidInput::Part::beam, error.what());
}

bool DamageCase::solved_as_structure() const {
  return structure || modal() != nullptr || std::ranges::any_of(kinds, [](const DefectKind& kind) {
           return kind.type->place == nullptr || kind.extent || kind.extent_prior;
         });
}

AnyStructure DamageCase::solved_structure() const {
  return structure ? structure->nominal : AnyStructure(fem::as_structure(beam, beam_depth));
}

std::vector<double> elastic_frequencies(const fem::Beam& beam, const fem::Defects& defects,
                                        int modes) {
  const int free = free_degrees_of_freedom(beam) - static_cast<int>(defects.supports.size());
  const fem::Modes found = fem::modal_analysis(beam, defects, {.modes = std::min(free, modes + 3)});
  std::vector<double> elastic(found.frequencies_hz.begin() + found.rigid_body_modes,
                              found.frequencies_hz.end());
  elastic.resize(std::min(elastic.size(), static_cast<std::size_t>(modes)));
  return elastic;
}

FrequencyData simulate(const DamageCase& damage_case, std::uint64_t seed) {
  if (!damage_case.simulation) {
    throw InvalidInput(InvalidInput::Part::truth, "is missing: there is nothing to simulate");
  }
  const Simulation& s = *damage_case.simulation;
  if (!(s.cv > 0.0) && damage_case.data.cv_prior) {
    throw InvalidInput(InvalidInput::Part::truth,
                       "simulated noise needs a number: {\"defects\": [...], \"cov\": 0.001}");
  }
  FrequencyData data;
  data.simulated = true;
  data.origin = "simulated from the case's truth, seed " + std::to_string(seed);
  base::Random random(seed, 0, 0, base::Purpose::simulation);
  const std::vector<double> exact =
      damage_case.solved_as_structure()
          ? true_frequencies(damage_case, s.modes)
          : elastic_frequencies(damage_case.beam, damage_case.true_defects(), s.modes);
  for (const double f : exact) {
    data.frequencies_hz.push_back(f * (1.0 + s.cv * random.normal()));
    data.sd_hz.push_back(s.cv * f);
  }
  return data;
}

}  // namespace wheeltap::identification
