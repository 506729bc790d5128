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
  if (!problem.states) return;
  const auto doubted = [](const ObservedState& s) { return s.data.doubt > 0.0; };
  const auto& list = problem.states->states().list;
  doubted_ = std::ranges::any_of(list, doubted);
  told_ = !doubted_ || std::ranges::all_of(list, doubted);
}

void SingleModes::pass(int model, double weight, const std::vector<double>& log_densities) {
  models_.push_back(model);
  weights_.push_back(weight);
  for (std::size_t m = 0; m < densities_.size(); ++m) densities_[m].push_back(log_densities[m]);
}

void SingleModes::pass(int model, double weight, std::span<const double> x,
                       const FrequencyPredictor& at, const ModalLikelihood::Score& score) {
  std::vector<int> with;
  const Eigen::MatrixXd c = at.covariance(x, score, with);
  ModalData data = problem_.states ? problem_.states->data() : problem_.modal->data();
  if (doubted_) data.doubt = 0.5;  // any: the matching has counted the true one
  const Eigen::VectorXd l = at.with_errors(x) ? at.single_mode_densities(x, score)
                                              : single_mode_densities(data, with, c, score);
  pass(model, weight, {l.begin(), l.end()});
  for (std::size_t m = 0; m < macs_.size(); ++m)
    if (const auto& shape = score.matches[m].shape) macs_[m].push_back(shape->mac);
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
  std::size_t chain = 0, draw = 0;
  for (std::size_t c = 0; c < posterior.chains.size(); ++c)
    for (std::size_t i = 0; i < posterior.chains[c].model.size(); ++i)
      if (posterior.chains[c].log_likelihood[i] > posterior.chains[chain].log_likelihood[draw])
        chain = c, draw = i;
  const auto width = static_cast<std::size_t>(posterior.dimension);
  const std::span<const double> x(posterior.chains[chain].theta.data() + draw * width, width);
  FrequencyPredictor predictor(problem);
  ModalLikelihood::Score score;
  if (!predictor.score(posterior.chains[chain].model[draw], x, score)) return {};
  std::vector<ShapesBeside> out;
  std::span<const ModalLikelihood::Match> left(score.matches);
  const int states = problem.states ? static_cast<int>(problem.states->states().list.size()) : 1;
  for (int s = 0; s < states; ++s) {
    const ModalLikelihood& of = problem.states ? problem.states->of(s) : *problem.modal;
    const auto modes = static_cast<std::size_t>(of.data().modes());
    if (of.data().has_shapes()) {
      out.push_back(shapes_beside(of, predictor.scored_modes(s), left.first(modes)));
      out.back().state = s;
    }
    left = left.subspan(modes);
  }
  return out;
}

}  // namespace wheeltap::identification
