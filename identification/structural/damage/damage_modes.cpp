#include "identification/structural/damage/damage_modes.hpp"

#include <algorithm>
#include <cmath>

#include "identification/structural/likelihood/mode_contributions.hpp"

namespace wheeltap::identification {

using inference::Posterior;

SingleModes::SingleModes(const DamageProblem& problem)
    : problem_(problem),
      densities_(static_cast<std::size_t>(problem.damage_case.data.modes())),
      macs_(densities_.size()) {
  if (problem.states() == nullptr) return;
  const auto doubted = [](const ObservedState& s) { return s.data.doubt > 0.0; };
  const auto& list = problem.states()->states().list;
  doubted_ = std::ranges::any_of(list, doubted);
  told_ = !doubted_ || std::ranges::all_of(list, doubted);
}

void SingleModes::pass(int model, double weight, const std::vector<double>& log_densities) {
  models_.push_back(model);
  weights_.push_back(weight);
  for (std::size_t m = 0; m < densities_.size(); ++m) densities_[m].push_back(log_densities[m]);
}

void SingleModes::pass(int model, double weight, std::span<const double> x,
                       const ModeObservation::Scored& scored) {
  const ModeObservation& observed = problem_.modes();
  const ModalNoise noise = problem_.modal_noise(x);
  std::vector<int> with;
  const Eigen::MatrixXd c = observed.covariance(scored, noise, with);
  ModalData data = observed.data();
  if (doubted_) data.doubt = 0.5;  // any: the matching has counted the true one
  const Eigen::VectorXd l = observed.with_errors(noise)
                                ? observed.single_mode_densities(scored, noise)
                                : single_mode_densities(data, with, c, scored.score);
  pass(model, weight, {l.begin(), l.end()});
  for (std::size_t m = 0; m < macs_.size(); ++m)
    if (const auto& shape = scored.score.matches[m].shape) macs_[m].push_back(shape->mac);
}

void SingleModes::tell(int winner, FitFinding& out) const {
  // A winner by its evidence alone: what leaving a mode out would make of it, draws cannot say.
  const bool drawn = std::ranges::find(models_, winner) != models_.end();
  for (std::size_t m = 0; m < out.modes.size(); ++m) {
    FitFinding::Mode& mode = out.modes[m];
    const bool shaped = !macs_[m].empty() && macs_[m].size() == weights_.size();
    if (shaped) mode.mac = marginal({macs_[m]}, {weights_});
    if (!told_ || !drawn || (std::isnan(mode.observed) && !shaped)) continue;
    const WithoutMode without = without_mode(densities_[m], weights_);
    mode.information = without.information;
    mode.reliable = without.reliable;
    mode.probability_without = 0.0;
    for (std::size_t s = 0; s < models_.size(); ++s)
      if (models_[s] == winner) mode.probability_without += without.weights[s];
  }
}

std::vector<ShapesBeside> best_shapes(const DamageProblem& problem, const Posterior& posterior) {
  const auto [chain, draw] = posterior.best_draw();
  const std::span<const double> x = posterior.theta(chain, draw);
  StructuralPredictor predictor(problem);
  ModeObservation::Scored scored;
  if (!predictor.score(posterior.chains[chain].model[draw], x, scored)) return {};
  std::vector<ShapesBeside> out;
  std::span<const ModalLikelihood::Match> left(scored.score.matches);
  for (int s = 0; s < problem.modes().states(); ++s) {
    const ModalLikelihood& of = problem.modes().of(s);
    const auto modes = static_cast<std::size_t>(of.data().modes());
    if (of.data().has_shapes()) {
      out.push_back(
          shapes_beside(of, scored.modes[static_cast<std::size_t>(s)], left.first(modes)));
      out.back().state = s;
    }
    left = left.subspan(modes);
  }
  return out;
}

}  // namespace wheeltap::identification
