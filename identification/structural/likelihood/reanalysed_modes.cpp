#include "identification/structural/likelihood/reanalysed_modes.hpp"

#include <algorithm>
#include <cmath>
#include <variant>

#include "base/constants.hpp"
#include "identification/structural/elastic_modes.hpp"

namespace wheeltap::identification {
namespace {

using Eigen::Index;

bool all_on_beams(const std::vector<DefectKind>& kinds) {
  return std::ranges::all_of(kinds, [](const DefectKind& kind) {
    return kind.type->place != nullptr && !kind.extent && !kind.extent_prior;
  });
}

}  // namespace

std::shared_ptr<const ReanalysedModes> ReanalysedModes::make(
    const std::shared_ptr<const StructureModel>& model, std::vector<DefectKind> kinds, int modes,
    const fem::Beam* beam, std::span<const std::vector<double>> samples) {
  if (std::holds_alternative<fem::MatrixStructure>(model->nominal)) return nullptr;
  auto scaled = fem::ScaledStructure::of(family_of(model), samples);
  // If the number of changes exceeds half the size, full solutions are as fast.
  if (!scaled || 2 * scaled->columns() > scaled->base()->size()) return nullptr;
  // The constructor is private.
  std::shared_ptr<ReanalysedModes> out(new ReanalysedModes(std::move(*scaled), std::move(kinds)));
  const AnyStructure base = model->at(out->scaled_.base_parameters());
  if (const auto* members = std::get_if<fem::Structure>(&base))
    out->mesh_ = std::make_shared<const fem::Mesh>(*members);
  out->rigid_ = static_cast<int>(out->scaled_.base()->rigid_motions.cols());
  if (beam != nullptr && out->scaled_.columns() == 0 && all_on_beams(out->kinds_))
    out->beam_.emplace(*beam, modes + out->rigid_);
  else
    out->structure_.emplace(out->scaled_.base(), modes + out->rigid_);
  return out;
}

ReanalysedModes::Workspace ReanalysedModes::make_workspace() const {
  Workspace out;
  if (beam_) out.beam.emplace(beam_->make_workspace());
  if (structure_) out.structure.emplace(structure_->make_workspace());
  return out;
}

ReanalysedModes::Outcome ReanalysedModes::solve_base(std::span<const double> values,
                                                     const std::vector<PlacedDefect>& defects,
                                                     const Scales& scales, const Wanted& wanted,
                                                     Workspace& workspace) const {
  if (beam_) {
    if (!wanted.motions.empty() || !wanted.masses.empty()) return Outcome::unsupported;
    place_in_beam(kinds_, defects, workspace.placed);
    for (fem::SpringSupport& support : workspace.placed.supports)
      support.stiffness /= scales.stiffness;
    beam_->frequencies_hz(workspace.placed.damages, workspace.placed.supports, *workspace.beam,
                          workspace.frequencies);
    return Outcome::possible;
  }
  fem::StructureChange change;
  if (!defects.empty()) change = structure_change(kinds_, defects, mesh_.get());
  if (!change.scalings.empty()) return Outcome::unsupported;
  change.masses.insert(change.masses.end(), wanted.masses.begin(), wanted.masses.end());
  const Outcome outcome = scaled_.transform(values, scales, change);
  if (outcome != Outcome::possible) return outcome;
  workspace.shapes.resize(workspace.frequencies.size() * wanted.motions.size());
  try {
    structure_->solve(change, *workspace.structure,
                      {.frequencies_hz = workspace.frequencies,
                       .shapes = workspace.shapes,
                       .motions = wanted.motions});
  } catch (const fem::ImpossibleChange&) {
    return Outcome::impossible;
  }
  return Outcome::possible;
}

// λ = s/m λ_base; φ = φ_base / √m.
ReanalysedModes::Outcome ReanalysedModes::solve(std::span<const double> values,
                                                const std::vector<PlacedDefect>& defects,
                                                const Wanted& wanted, Workspace& workspace,
                                                fem::ParametricModes::Modes& out) const {
  const auto scales = scaled_.scales(values);
  if (!scales) return Outcome::impossible;
  workspace.frequencies.resize(static_cast<std::size_t>(wanted.modes + rigid_));
  const Outcome outcome = solve_base(values, defects, *scales, wanted, workspace);
  if (outcome != Outcome::possible) return outcome;
  const std::size_t first = first_elastic(workspace.frequencies, static_cast<std::size_t>(rigid_));
  const auto modes = static_cast<Index>(wanted.modes);
  const auto sensors = static_cast<Index>(wanted.motions.size());
  out.eigenvalues.resize(modes);
  out.shapes.resize(sensors, modes);
  const double by = scales->stiffness / scales->mass, normal = 1.0 / std::sqrt(scales->mass);
  for (Index i = 0; i < modes; ++i) {
    const std::size_t mode = first + static_cast<std::size_t>(i);
    const double omega = kTwoPi * workspace.frequencies[mode];
    out.eigenvalues[i] = by * omega * omega;
    for (Index s = 0; s < sensors; ++s)
      out.shapes(s, i) =
          normal *
          workspace.shapes[mode * static_cast<std::size_t>(sensors) + static_cast<std::size_t>(s)];
  }
  return Outcome::possible;
}

}  // namespace wheeltap::identification
