// Solutions of the structures of all states, and their comparison with full solutions.
#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/constants.hpp"
#include "base/random.hpp"
#include "fem/structures/modes/structure_modes.hpp"
#include "identification/structural/likelihood/states_likelihood.hpp"

namespace wheeltap::identification {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Modes = fem::ParametricModes::Modes;

namespace {

constexpr int kFormDraws = 200;           // prior draws that test the parameters' form
constexpr double kSameEigenvalue = 1e-7;  // relative difference, reanalysis to full solution

const std::vector<PlacedDefect> kNoDefects;

}  // namespace

void StatesLikelihood::try_reanalysis(const fem::Beam* beam) {
  if (std::ranges::any_of(kinds_, [](const DefectKind& k) { return !k.type->has_low_rank; }))
    return;
  int modes = 1;
  for (const Group& group : groups_) modes = std::max(modes, group.modes);
  // The reanalysis of a beam supports neither shapes nor added masses.
  const bool as_beam = std::ranges::all_of(groups_, [&](const Group& group) {
    return group.motions.empty() &&
           states_->list[static_cast<std::size_t>(group.states[0])].masses.empty();
  });
  reanalysed_ = ReanalysedModes::make(states_->model, kinds_, modes, as_beam ? beam : nullptr,
                                      prior_draws(*states_->model, kFormDraws));
  for (const Group& group : groups_)
    for (int i = 0; i < kReanalysed && reanalysed_; ++i)
      if (!agrees_with_full(group, i)) reanalysed_ = nullptr;
}

bool StatesLikelihood::agrees_with_full(const Group& group, int i) const {
  const ObservedState& state = states_->list[static_cast<std::size_t>(group.states[0])];
  const Draw one = draw(i);
  fem::Discretisation d;
  try {
    d = structure(one.x, one.defects, state);
  } catch (const std::invalid_argument&) {
    return true;  // impossible structure
  }
  Workspace workspace = make_workspace();
  Modes found;
  const auto outcome =
      reanalyse(group, states_->values(one.x, state),
                state.damaged ? one.defects : std::vector<PlacedDefect>{}, workspace, found);
  if (outcome == ReanalysedModes::Outcome::unsupported) return true;
  if (outcome == ReanalysedModes::Outcome::impossible) return false;
  const VectorXd full =
      fem::structure_modes(d, static_cast<int>(d.rigid_motions.cols()) + group.modes)
          .eigenvalues.tail(group.modes);
  return ((found.eigenvalues - full).array().abs() <= kSameEigenvalue * full.array()).all();
}

ReanalysedModes::Outcome StatesLikelihood::reanalyse(const Group& group,
                                                     const std::vector<double>& values,
                                                     const std::vector<PlacedDefect>& defects,
                                                     Workspace& workspace, Modes& out) const {
  return reanalysed_->solve(
      values, defects,
      {.modes = group.modes,
       .motions = group.motions,
       .masses = states_->list[static_cast<std::size_t>(group.states[0])].masses},
      *workspace.reanalysed, out);
}

fem::Discretisation StatesLikelihood::structure(std::span<const double> x,
                                                const std::vector<PlacedDefect>& defects,
                                                const ObservedState& state) const {
  Workspace::Intact intact;
  assemble(states_->values(x, state), intact);
  return changed(intact, defects, state);
}

void StatesLikelihood::assemble(const std::vector<double>& values, Workspace::Intact& out) const {
  if (out.values == values) return;
  out.values.reset();  // if the next line throws, no values are stored
  out.mesh.reset();
  const AnyStructure at = states_->model->at(values);
  if (const auto* members = std::get_if<fem::Structure>(&at))
    out.discretisation = out.mesh.emplace(*members).discretisation();
  else
    out.discretisation = discretise(at);
  out.values = values;
}

fem::StructureChange StatesLikelihood::change_of(const Workspace::Intact& intact,
                                                 const std::vector<PlacedDefect>& defects,
                                                 const ObservedState& state) const {
  fem::StructureChange change;
  if (state.damaged && !defects.empty())
    change = structure_change(kinds_, defects, intact.mesh ? &*intact.mesh : nullptr);
  change.masses.insert(change.masses.end(), state.masses.begin(), state.masses.end());
  return change;
}

fem::Discretisation StatesLikelihood::changed(const Workspace::Intact& intact,
                                              const std::vector<PlacedDefect>& defects,
                                              const ObservedState& state) const {
  const fem::StructureChange change = change_of(intact, defects, state);
  return change.empty() ? intact.discretisation : fem::changed(intact.discretisation, change);
}

StatesLikelihood::Workspace StatesLikelihood::make_workspace() const {
  Workspace out;
  for (const Group& group : groups_) {
    out.intact.resize(std::max(out.intact.size(), group.intact + 1));
    out.groups.emplace_back();
    if (group.reduced) out.groups.back().reduced.emplace(group.reduced->make_workspace());
  }
  if (reanalysed_) out.reanalysed.emplace(reanalysed_->make_workspace());
  return out;
}

bool StatesLikelihood::solve_assembled(const Group& group, const std::vector<double>& values,
                                       const std::vector<PlacedDefect>& defects,
                                       Workspace& workspace, Modes& out) const {
  const ObservedState& state = states_->list[static_cast<std::size_t>(group.states[0])];
  Workspace::Intact& intact = workspace.intact[group.intact];
  assemble(values, intact);
  const fem::StructureChange change = change_of(intact, defects, state);
  std::optional<fem::Discretisation> other;
  if (!change.empty()) other = fem::changed(intact.discretisation, change);
  const fem::Discretisation& d = other ? *other : intact.discretisation;
  fem::SubspaceModes::Found found;
  if (!group.solver->solve(d, found)) return false;
  if (pieces_.count() > 0) {
    out.pieces = pieces_.energies(d, found.shapes);
    // A rigid support removes degrees of freedom, so that the rows no longer match.
    const bool same = d.size() == intact.discretisation.size();
    std::ranges::move(
        pieces_.losses(intact.discretisation, same ? change : fem::StructureChange{}, found.shapes),
        std::back_inserter(out.pieces));
  }
  out.eigenvalues = std::move(found.eigenvalues);
  out.shapes.resize(static_cast<Index>(group.motions.size()), found.shapes.cols());
  for (Index row = 0; row < out.shapes.rows(); ++row)
    for (Index m = 0; m < out.shapes.cols(); ++m)
      out.shapes(row, m) = group.motions[static_cast<std::size_t>(row)].of(found.shapes.col(m));
  return true;
}

bool StatesLikelihood::solve(const Group& group, std::span<const double> x,
                             const std::vector<PlacedDefect>& defects, Workspace& workspace,
                             Workspace::Group& own) const {
  const ObservedState& state = states_->list[static_cast<std::size_t>(group.states[0])];
  const bool damaged = state.damaged && !defects.empty();
  const std::vector<double> values = states_->values(x, state);
  if (!damaged && own.values == values) return true;
  own.values.reset();
  Modes& out = own.found;
  try {
    if (group.reduced) {
      group.reduced->solve(scales(x, damaged ? defects : kNoDefects, state), *own.reduced, out);
      if (!out.eigenvalues.allFinite() || !(out.eigenvalues.minCoeff() > 0.0)) return false;
    } else {
      using Outcome = ReanalysedModes::Outcome;
      const Outcome outcome =
          reanalysed_ ? reanalyse(group, values, damaged ? defects : kNoDefects, workspace, out)
                      : Outcome::unsupported;
      if (outcome == Outcome::impossible) return false;
      if (outcome == Outcome::unsupported &&
          !solve_assembled(group, values, defects, workspace, out))
        return false;
    }
  } catch (const std::invalid_argument&) {
    return false;  // impossible structure
  } catch (const std::runtime_error&) {
    return false;  // the solver does not converge near a mechanism
  }
  if (!damaged) own.values = values;
  return true;
}

bool StatesLikelihood::solve(std::span<const double> x, const std::vector<PlacedDefect>& defects,
                             Workspace& workspace, std::vector<Modes>& out) const {
  out.resize(likelihoods_.size());
  const double per_kelvin = states_->per_kelvin ? x[states_->unknown.size()] : 0.0;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    if (!solve(groups_[g], x, defects, workspace, workspace.groups[g])) return false;
    const Modes& found = workspace.groups[g].found;
    Index row = 0;
    for (const int s : groups_[g].states) {
      const ObservedState& state = states_->list[static_cast<std::size_t>(s)];
      const double stiffer = 1.0 + per_kelvin * state.temperature;
      if (!(stiffer > 0.0)) return false;
      Modes& modes = out[static_cast<std::size_t>(s)];
      modes.eigenvalues = stiffer * found.eigenvalues;
      modes.stiffer = stiffer;
      modes.pieces = found.pieces;
      for (MatrixXd& piece : modes.pieces) piece *= stiffer;
      const auto sensors = static_cast<Index>(state.data.sensors.size());
      modes.shapes = found.shapes.middleRows(row, sensors);
      row += sensors;
    }
  }
  return true;
}

StatesLikelihood::Draw StatesLikelihood::draw(int i) const {
  Draw out;
  const bool median = i < 0;
  base::Random random(1, 0, static_cast<std::uint64_t>(std::max(0, i)), base::Purpose::fit);
  const auto of_prior = [&](const inference::Prior& p) {
    return p.from_standard_normal(median ? 0.0 : random.normal());
  };
  for (const auto& parameter : states_->parameters()) out.x.push_back(of_prior(parameter.prior));
  for (std::size_t k = 0; k < kinds_.size() && !median && i % 4 != 0; ++k) {
    const DefectKind& kind = kinds_[k];
    const int count = kind.max_count > 0 ? 1 + i / 4 % kind.max_count : 0;
    for (int c = 0; c < count; ++c)
      out.defects.push_back({.kind = static_cast<int>(k),
                             .location = of_prior(kind.location),
                             .severity = kind.severity_prior() ? of_prior(*kind.severity_prior())
                                                               : kind.known_severity(),
                             .extent = kind.extent_prior ? of_prior(*kind.extent_prior) : 0.0});
  }
  return out;
}

std::vector<double> StatesLikelihood::frequencies_anywhere(
    const std::vector<PlacedDefect>& defects) const {
  base::Random random(3, 0, 0, base::Purpose::fit);
  std::vector<double> x, out;
  for (const auto& parameter : states_->parameters())
    x.push_back(parameter.prior.from_standard_normal(0.5 * random.normal()));
  std::vector<Modes> found;
  Workspace workspace = make_workspace();
  if (!solve(x, defects, workspace, found)) return out;
  for (const Modes& modes : found)
    for (const double lambda : modes.eigenvalues) out.push_back(std::sqrt(lambda) / kTwoPi);
  return out;
}

StatesLikelihood::Check StatesLikelihood::check(int points) const {
  Check out;
  Workspace workspace = make_workspace();
  std::vector<Modes> found;
  std::chrono::duration<double> took{};
  for (int i = 0; i < points; ++i) {
    const auto [x, defects] = draw(i);
    const auto began = std::chrono::steady_clock::now();
    const bool solved = solve(x, defects, workspace, found);
    took += std::chrono::steady_clock::now() - began;
    if (!solved) continue;
    ++out.points;
    const double per_kelvin = states_->per_kelvin ? x[states_->unknown.size()] : 0.0;
    for (const Group& group : groups_) {
      const auto s = static_cast<std::size_t>(group.states[0]);
      const fem::Discretisation d = structure(x, defects, states_->list[s]);
      const double stiffer = 1.0 + per_kelvin * states_->list[s].temperature;
      const VectorXd eigenvalues = found[s].eigenvalues / stiffer;
      const auto rigid = d.rigid_motions.cols();
      const VectorXd full = fem::structure_modes(d, static_cast<int>(rigid + eigenvalues.size()))
                                .eigenvalues.tail(eigenvalues.size());
      const auto errors = ((eigenvalues - full).array() / full.array()).abs().eval();
      out.missed += static_cast<int>((errors > 1e-3).count());
      out.largest_error = std::max(out.largest_error, 0.5 * errors.maxCoeff());
    }
  }
  out.seconds_a_solution = took.count() / std::max(1, points);
  return out;
}

}  // namespace wheeltap::identification
