#include "identification/structural/likelihood/states_likelihood.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "fem/structures/modes/structure_modes.hpp"

namespace wheeltap::identification {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Modes = fem::ParametricModes::Modes;

namespace {

constexpr int kTraining = 200;      // structures on which a reduced basis is tested
constexpr int kTriedForPieces = 8;  // prior draws whose strains must be those of the medians
constexpr int kOfPieces = 8;  // additional modes for the sensitivity of shapes to stiffness errors

bool same_masses(const ObservedState& a, const ObservedState& b) {
  return std::ranges::equal(a.masses, b.masses, [](const auto& x, const auto& y) {
    return x.mass == y.mass && x.motion.dofs == y.motion.dofs &&
           x.motion.coefficients == y.motion.coefficients;
  });
}

/// Relative tolerance of eigenvalues: 2/1000 of the smallest relative scatter of a frequency.
double tolerance_of(const ObservedStates& states) {
  double cov = 1e-3;
  for (const ObservedState& s : states.list)
    for (std::size_t i = 0; i < s.data.frequencies_hz.size() && !s.data.cov_prior; ++i)
      if (const double f = s.data.frequencies_hz[i]; !std::isnan(f))
        cov = std::min(cov, std::sqrt(s.data.covariance.diagonal()[static_cast<Index>(i)]) / f);
  return std::clamp(2e-3 * cov, 1e-8, 1e-5);
}

}  // namespace

StatesLikelihood::StatesLikelihood(std::shared_ptr<const ObservedStates> states,
                                   std::vector<DefectKind> kinds, const fem::Beam* beam)
    : states_(std::move(states)), kinds_(std::move(kinds)), joined_(states_->joined()) {
  const bool matrices = std::holds_alternative<fem::MatrixStructure>(states_->model->nominal);
  if (matrices) scales_ = scales_of(*states_->model);
  const std::vector<double> theta = draw(-1).x;
  int held = 0;
  for (const DefectKind& kind : kinds_) held += kind.type->may_be_known ? kind.max_count : 0;
  const bool pieces = !joined_.stiffness_discrepancy.none();
  if (pieces && matrices)
    throw std::invalid_argument(
        "a stiffness discrepancy needs members or a chain: a structure of matrices has none");
  for (std::size_t s = 0; s < states_->list.size(); ++s) {
    const ObservedState& state = states_->list[s];
    const auto kin = std::ranges::find(states_->list, state.known, &ObservedState::known);
    family_.push_back(static_cast<int>(kin - states_->list.begin()));
    try {
      likelihoods_.emplace_back(state.data);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(state.name + ": " + error.what());
    }
    for (int m = 0; m < state.data.modes(); ++m) places_.push_back({static_cast<int>(s), m});
    const auto group = std::ranges::find_if(groups_, [&](const Group& g) {
      const ObservedState& other = states_->list[static_cast<std::size_t>(g.states[0])];
      return other.damaged == state.damaged && other.known == state.known &&
             same_masses(other, state);
    });
    if (group != groups_.end()) {
      group->states.push_back(static_cast<int>(s));
      continue;
    }
    const auto alike = std::ranges::find_if(groups_, [&](const Group& g) {
      return states_->list[static_cast<std::size_t>(g.states[0])].known == state.known;
    });
    std::size_t intact = 0;
    for (const Group& g : groups_) intact = std::max(intact, g.intact + 1);
    groups_.push_back({.states = {static_cast<int>(s)},
                       .intact = alike != groups_.end() ? alike->intact : intact});
  }
  for (Group& group : groups_) {
    const ObservedState& state = states_->list[static_cast<std::size_t>(group.states[0])];
    Workspace::Intact intact;
    assemble(states_->values(theta, state), intact);
    const fem::Discretisation d = changed(intact, {}, state);
    if (pieces && pieces_.count() == 0)
      pieces_ = StiffnessPieces(intact.discretisation, intact.mesh ? &*intact.mesh : nullptr);
    const auto available =
        static_cast<int>(fem::mode_count(d) - d.rigid_motions.cols()) - (state.damaged ? held : 0);
    int modes = 1;
    for (const int s : group.states)
      modes = std::max({modes, of(s).candidates(available), of(s).data().least_modes()});
    if (modes > available)
      throw std::invalid_argument(state.name + ": " + std::to_string(modes) +
                                  " modes: must be at most " + std::to_string(available) +
                                  ", the number of elastic modes of the structure");
    for (int i = 0; pieces && i < kTriedForPieces; ++i) {
      Workspace::Intact other;
      try {
        assemble(states_->values(draw(i).x, state), other);
      } catch (const std::invalid_argument&) {
        continue;  // impossible structure
      }
      if (other.discretisation.strains.size() != intact.discretisation.strains.size())
        throw std::invalid_argument(
            "with a stiffness discrepancy, priors of springs and axial forces must exclude 0");
    }
    if (pieces) modes = std::min(available, modes + kOfPieces);
    group.modes = modes;
    for (const int s : group.states)
      for (const Sensor& sensor : of(s).data().sensors) group.motions.push_back(sensor.motion);
    if (matrices)
      group.reduced = reduced_basis(group, modes);
    else
      group.solver = std::make_shared<const fem::SubspaceModes>(
          d, fem::SubspaceModes::Options{.modes = modes, .tolerance = tolerance_of(*states_)});
  }
  if (!pieces && !matrices) try_reanalysis(beam);
}

std::shared_ptr<const fem::ParametricModes> StatesLikelihood::reduced_basis(const Group& group,
                                                                            int modes) const {
  const ObservedState& state = states_->list[static_cast<std::size_t>(group.states[0])];
  const auto matrices = std::make_shared<const fem::MatrixStructure>(
      std::get<fem::MatrixStructure>(states_->model->nominal));
  fem::StructureFamily family;
  const Draw median = draw(-1);
  family.nominal = scales(median.x, {}, state);
  for (const auto& part : matrices->parts) family.parts.push_back(part.stiffness);
  family.scales = [](std::span<const double> q) { return std::vector<double>(q.begin(), q.end()); };
  family.at = [matrices, masses = state.masses](std::span<const double> q) {
    fem::MatrixStructure structure = *matrices;
    for (std::size_t j = 0; j < q.size(); ++j) structure.parts[j].change = q[j] - 1.0;
    const fem::Discretisation d = discretise(structure);
    return masses.empty() ? d : fem::changed(d, {.masses = masses});
  };
  std::vector<std::vector<double>> training;
  for (int i = 0; i < kTraining; ++i) {
    const Draw one = draw(i);
    training.push_back(
        scales(one.x, state.damaged ? one.defects : std::vector<PlacedDefect>{}, state));
  }
  double sd = std::numeric_limits<double>::infinity();
  for (const int s : group.states) {
    const ModalLikelihood& one = of(s);
    for (int i = 0; i < one.data().modes(); ++i)
      if (one.shape(i))
        sd = std::min(sd, one.data().shape_sd_prior
                              ? one.data().shape_sd_prior->from_standard_normal(-2.0)
                              : one.shape(i)->sd());
  }
  return std::make_shared<const fem::ParametricModes>(
      std::make_shared<const fem::ParametricStructure>(std::move(family), training), training,
      fem::ParametricModesOptions{.modes = modes,
                                  .motions = group.motions,
                                  .tolerance = tolerance_of(*states_),
                                  .shape_tolerance = std::clamp(0.2 * sd, 1e-4, 1e-2)});
}

std::vector<double> StatesLikelihood::scales(std::span<const double> x,
                                             const std::vector<PlacedDefect>& defects,
                                             const ObservedState& state) const {
  std::vector<double> out = scales_(states_->values(x, state));
  for (const auto& scaling : structure_change(kinds_, defects, nullptr).scalings)
    out[static_cast<std::size_t>(scaling.part)] *= scaling.remaining;
  return out;
}

int StatesLikelihood::measured() const {
  int sum = 0;
  for (const ModalLikelihood& l : likelihoods_) sum += l.measured();
  return sum;
}

MatrixXd StatesLikelihood::covariance(const ModalNoise& noise) const {
  MatrixXd out = MatrixXd::Zero(modes(), modes());
  Index at = 0;
  for (const ModalLikelihood& l : likelihoods_) {
    const Index m = l.data().modes();
    out.block(at, at, m, m) = l.covariance(noise);
    at += m;
  }
  return out;
}

ModalLikelihood::Score StatesLikelihood::score(const std::vector<Modes>& modes,
                                               const ModalNoise& noise) const {
  ModalLikelihood::Score out;
  // Widen the noise of the matching approximately by the effect of stiffness errors.
  ModalNoise wide = noise;
  if (pieces_.count() > 0) {
    constexpr double kOfMode = 0.25;  // mode's / part's error; about four parts affect a mode
    wide.discrepancy = std::hypot(noise.discrepancy, kOfMode * noise.stiffness_discrepancy);
    wide.shape_discrepancy =
        std::hypot(noise.shape_discrepancy, kOfMode * noise.stiffness_discrepancy);
  }
  for (std::size_t s = 0; s < likelihoods_.size(); ++s) {
    ModalLikelihood::Score one = likelihoods_[s].score(modes[s], wide);
    out.log_likelihood += one.log_likelihood;
    out.chi_square += one.chi_square;
    out.freedoms += one.freedoms;
    std::ranges::move(one.matches, std::back_inserter(out.matches));
  }
  if (with_errors(noise)) {
    Parts all = parts(modes, noise, out);
    const Joint together = joint(all, noise, -1);
    out.log_likelihood = together.log_density;
    out.chi_square = together.chi_square;
    for (std::size_t i = 0; i < out.matches.size(); ++i)
      if (all.shapes[i]) out.matches[i].shape = all.shapes[i]->without;
    return out;
  }
  if (noise.discrepancy == 0.0 || likelihoods_.size() == 1) return out;

  // Joint density of the frequencies of all states, with their common errors.
  std::vector<int> with;
  const MatrixXd c = covariance_of_noise(modes, noise, out, with);
  const auto n = static_cast<Index>(with.size());
  VectorXd r(n);
  const auto observed = [&](Index k) {
    return joined_.frequencies_hz[static_cast<std::size_t>(with[static_cast<std::size_t>(k)])];
  };
  const auto match = [&](Index k) -> const auto& {
    return out.matches[static_cast<std::size_t>(with[static_cast<std::size_t>(k)])];
  };
  for (Index k = 0; k < n; ++k) r[k] = observed(k) - match(k).frequency_hz;
  out.log_likelihood = out.chi_square = 0.0;
  for (const auto& m : out.matches)
    if (m.shape) {
      out.log_likelihood += m.shape->log_density;
      out.chi_square += m.shape->chi_square;
    }
  const Eigen::LLT<MatrixXd> llt(c);
  if (llt.info() != Eigen::Success) {
    out.log_likelihood = -std::numeric_limits<double>::infinity();
    return out;
  }
  const double chi_square = llt.matrixL().solve(r).squaredNorm();
  out.chi_square += chi_square;
  out.log_likelihood -= 0.5 * chi_square + 0.5 * static_cast<double>(n) * std::log(kTwoPi) +
                        MatrixXd(llt.matrixL()).diagonal().array().log().sum();
  return out;
}

bool StatesLikelihood::density_of_frequencies(const std::vector<Modes>& modes,
                                              const ModalNoise& noise, double& log_density,
                                              std::vector<double>& frequencies_hz) const {
  if (pieces_.count() > 0 || (noise.discrepancy != 0.0 && likelihoods_.size() > 1)) return false;
  log_density = 0.0;
  frequencies_hz.clear();
  for (std::size_t s = 0; s < likelihoods_.size(); ++s)
    if (!likelihoods_[s].add_density_of_frequencies(modes[s], noise, log_density, frequencies_hz))
      return false;
  return true;
}

MatrixXd StatesLikelihood::frequency_sensitivities(const std::vector<Modes>& modes,
                                                   const ModalLikelihood::Score& score,
                                                   const std::vector<int>& with) const {
  const auto n = static_cast<Index>(with.size());
  MatrixXd out = MatrixXd::Zero(n, static_cast<Index>(states_->list.size()) * errors());
  for (Index i = 0; i < n; ++i) {
    const int mode = with[static_cast<std::size_t>(i)];
    const auto state = static_cast<std::size_t>(place(mode).state);
    const ModalLikelihood::Match& match = score.matches[static_cast<std::size_t>(mode)];
    for (int p = 0; p < errors(); ++p) {
      const MatrixXd& energy = modes[state].pieces[static_cast<std::size_t>(p)];
      out(i, family_[state] * errors() + p) =
          energy(match.computed, match.computed) / (2.0 * kTwoPi * kTwoPi * match.frequency_hz);
    }
  }
  return out;
}

// All measured data with their sensitivities to stiffness errors; for this comparison of shapes,
// close modes are mixed instead of rotated.
StatesLikelihood::Parts StatesLikelihood::parts(const std::vector<Modes>& modes,
                                                const ModalNoise& noise,
                                                const ModalLikelihood::Score& score) const {
  Parts out;
  out.covariance = covariance_of_noise(modes, noise, score, out.with);
  out.sensitivities = frequency_sensitivities(modes, score, out.with);
  out.residual.resize(out.covariance.rows());
  for (Index k = 0; k < out.residual.size(); ++k) {
    const auto mode = static_cast<std::size_t>(out.with[static_cast<std::size_t>(k)]);
    out.residual[k] = joined_.frequencies_hz[mode] - score.matches[mode].frequency_hz;
  }
  for (std::size_t i = 0; i < score.matches.size(); ++i) {
    const auto [state, mode] = place(static_cast<int>(i));
    out.shapes.emplace_back();
    if (score.matches[i].shape)
      out.shapes.back() = of(state).shape_errors(modes[static_cast<std::size_t>(state)], mode,
                                                 score.matches[i].computed, noise);
  }
  return out;
}

StatesLikelihood::Joint StatesLikelihood::joint(const Parts& parts, const ModalNoise& noise,
                                                int without) const {
  std::vector<Index> rows;
  for (std::size_t k = 0; k < parts.with.size(); ++k)
    if (parts.with[k] != without) rows.push_back(static_cast<Index>(k));
  Joint out;
  const Eigen::LLT<MatrixXd> llt(parts.covariance(rows, rows));
  if (llt.info() != Eigen::Success) {
    out.log_density = -std::numeric_limits<double>::infinity();
    return out;
  }
  const VectorXd residual = llt.matrixL().solve(parts.residual(rows));
  out.chi_square = residual.squaredNorm();
  out.log_density = -0.5 * out.chi_square -
                    0.5 * static_cast<double>(rows.size()) * std::log(kTwoPi) -
                    llt.matrixLLT().diagonal().array().log().sum();
  for (std::size_t i = 0; i < parts.shapes.size(); ++i) {
    if (!parts.shapes[i] || static_cast<int>(i) == without) continue;
    out.log_density += parts.shapes[i]->without.log_density;
    out.chi_square += parts.shapes[i]->without.chi_square;
  }
  for (int kin = 0; kin < static_cast<int>(family_.size()); ++kin) {
    if (std::ranges::find(family_, kin) == family_.end()) continue;
    StiffnessErrors gathered(errors());
    gathered.add(llt.matrixL().solve(
                     parts.sensitivities(rows, Eigen::indexing::seqN(kin * errors(), errors()))),
                 residual);
    for (std::size_t i = 0; i < parts.shapes.size(); ++i)
      if (parts.shapes[i] && static_cast<int>(i) != without &&
          family_[static_cast<std::size_t>(place(static_cast<int>(i)).state)] == kin)
        gathered.add(parts.shapes[i]->sensitivities, parts.shapes[i]->residual);
    const StiffnessErrors::Gain gain = gathered.integrated(noise.stiffness_discrepancy);
    out.log_density += gain.log_density;
    out.chi_square -= gain.chi_square;
  }
  return out;
}

VectorXd StatesLikelihood::single_mode_densities(const std::vector<Modes>& modes,
                                                 const ModalNoise& noise,
                                                 const ModalLikelihood::Score& score) const {
  const Parts all = parts(modes, noise, score);
  const double density = joint(all, noise, -1).log_density;
  VectorXd out(this->modes());
  for (int m = 0; m < this->modes(); ++m) out[m] = density - joint(all, noise, m).log_density;
  return out;
}

MatrixXd StatesLikelihood::frequency_covariance(const std::vector<Modes>& modes,
                                                const ModalNoise& noise,
                                                const ModalLikelihood::Score& score,
                                                std::vector<int>& with) const {
  MatrixXd out = covariance_of_noise(modes, noise, score, with);
  if (!with_errors(noise)) return out;
  const MatrixXd moved = noise.stiffness_discrepancy * frequency_sensitivities(modes, score, with);
  return out + moved * moved.transpose();
}

MatrixXd StatesLikelihood::covariance_of_noise(const std::vector<Modes>& modes,
                                               const ModalNoise& noise,
                                               const ModalLikelihood::Score& score,
                                               std::vector<int>& with) const {
  with.clear();
  for (int i = 0; i < this->modes(); ++i)
    if (!std::isnan(joined_.frequencies_hz[static_cast<std::size_t>(i)])) with.push_back(i);
  MatrixXd out = covariance(noise)(with, with);
  if (noise.discrepancy > 0.0 && likelihoods_.size() > 1)
    add_common(modes, noise, score, with, out);
  return out;
}

void StatesLikelihood::add_common(const std::vector<Modes>& modes, const ModalNoise& noise,
                                  const ModalLikelihood::Score& score, const std::vector<int>& with,
                                  MatrixXd& covariance) const {
  const auto state_of = [&](Index mode) -> const ObservedState& {
    return states_->list[static_cast<std::size_t>(place(static_cast<int>(mode)).state)];
  };
  const auto match = [&](Index mode) -> const auto& {
    return score.matches[static_cast<std::size_t>(mode)];
  };
  const double common = noise.discrepancy * noise.discrepancy;
  const auto n = static_cast<Index>(with.size());
  for (Index k = 0; k < n; ++k)
    for (Index l = 0; l < k; ++l) {
      const Index a = with[static_cast<std::size_t>(k)], b = with[static_cast<std::size_t>(l)];
      if (match(a).computed != match(b).computed || state_of(a).known != state_of(b).known)
        continue;
      covariance(k, l) += common * joined_.frequencies_hz[static_cast<std::size_t>(a)] *
                          joined_.frequencies_hz[static_cast<std::size_t>(b)];
      covariance(l, k) = covariance(k, l);
    }
  if (noise.mixing == 0.0) return;
  for (const ObservedState& healthy : states_->list) {
    const auto first = std::ranges::find_if(states_->list, [&](const ObservedState& s) {
      return !s.damaged && s.known == healthy.known;
    });
    if (&*first != &healthy) continue;
    const Modes& intact = modes[static_cast<std::size_t>(first - states_->list.begin())];
    const VectorXd& before = intact.eigenvalues;
    // √|Δλ| of a mode in a damaged state at the temperature of the intact one; otherwise 0. A
    // factor on the whole stiffness does not mix modes.
    const auto change = [&](Index state, Index mode) {
      const Modes& found = modes[static_cast<std::size_t>(state)];
      if (mode >= found.eigenvalues.size()) return 0.0;
      const double after = found.eigenvalues[mode] * (intact.stiffer / found.stiffer);
      return std::sqrt(std::abs(after - before[mode]));
    };
    for (Index j = 0; j < before.size(); ++j)
      for (Index k = j + 1; k < before.size(); ++k) {
        const double tau = mixing_sd(noise, before[j], before[k]);
        VectorXd moved = VectorXd::Zero(n);
        for (Index i = 0; i < n; ++i) {
          const Index mode = with[static_cast<std::size_t>(i)];
          const ObservedState& state = state_of(mode);
          const int computed = match(mode).computed;
          if (!state.damaged || state.known != healthy.known || (computed != j && computed != k))
            continue;
          const Index at = place(static_cast<int>(mode)).state;
          moved[i] = (computed == j ? 2.0 : -2.0) * tau * change(at, j) * change(at, k) /
                     (2.0 * kTwoPi * kTwoPi * match(mode).frequency_hz);
        }
        covariance += moved * moved.transpose();
      }
  }
}

}  // namespace wheeltap::identification
