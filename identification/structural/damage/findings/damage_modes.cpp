#include "identification/structural/damage/findings/damage_modes.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/random.hpp"
#include "identification/structural/likelihood/mode_contributions.hpp"

namespace wheeltap::identification {

using inference::Posterior;

namespace {

/// Sd [Hz] of each measured frequency about the model's frequency if the discrepancy is inferred,
/// else 0. Mean over only a few hundred draws, because each draw needs an FE solution.
std::vector<double> inferred_scatter(const DamageProblem& problem, const Posterior& posterior) {
  std::vector<double> out(static_cast<std::size_t>(problem.damage_case.data.modes()));
  const auto& modal = problem.damage_case.modal();
  if (!problem.by_modes() || !modal ||
      (modal->discrepancy.known() && modal->stiffness_discrepancy.none()))
    return out;
  constexpr std::size_t kSolved = 300;
  const auto width = static_cast<std::size_t>(posterior.dimension);
  const std::size_t chains = posterior.chains.size();
  const std::size_t draws = posterior.chains[0].model.size();
  const std::size_t stride = std::max<std::size_t>(1, chains * draws / kSolved);
  StructuralPredictor predictor(problem);
  ModeObservation::Scored scored;
  std::vector<int> with;
  double solved = 0.0;
  for (std::size_t n = 0; n < chains * draws; n += stride) {
    const inference::Chain& chain = posterior.chains[n / draws];
    const std::size_t i = n % draws;
    const std::span<const double> x(chain.theta.data() + i * width, width);
    if (!predictor.score(chain.model[i], x, scored)) continue;
    const Eigen::MatrixXd covariance =
        problem.modes().covariance(scored, problem.modal_noise(x), with);
    for (std::size_t k = 0; k < with.size(); ++k)
      out[static_cast<std::size_t>(with[k])] +=
          covariance(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(k));
    ++solved;
  }
  for (double& variance : out) variance = solved > 0.0 ? std::sqrt(variance / solved) : 0.0;
  return out;
}

}  // namespace

SingleModes::SingleModes(const DamageProblem& problem)
    : problem_(problem),
      densities_(static_cast<std::size_t>(problem.damage_case.data.modes())),
      macs_(densities_.size()) {
  if (problem.states() == nullptr) return;
  const auto may_be_spurious = [](const ObservedState& s) { return s.data.doubt > 0.0; };
  const auto& list = problem.states()->states().list;
  may_be_spurious_ = std::ranges::any_of(list, may_be_spurious);
  comparable_ = !may_be_spurious_ || std::ranges::all_of(list, may_be_spurious);
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
  if (may_be_spurious_) data.doubt = 0.5;  // any value in (0, 1): the matching used the true value
  const Eigen::VectorXd l = observed.with_errors(noise)
                                ? observed.single_mode_densities(scored, noise)
                                : single_mode_densities(data, with, c, scored.score);
  pass(model, weight, {l.begin(), l.end()});
  for (std::size_t m = 0; m < macs_.size(); ++m)
    if (const auto& shape = scored.score.matches[m].shape) macs_[m].push_back(shape->mac);
}

void SingleModes::write(int winner, FitFinding& out) const {
  // The draws have no information about the effect of a mode on a model that was not drawn.
  const bool drawn = std::ranges::find(models_, winner) != models_.end();
  for (std::size_t m = 0; m < out.modes.size(); ++m) {
    FitFinding::Mode& mode = out.modes[m];
    const bool shaped = !macs_[m].empty() && macs_[m].size() == weights_.size();
    if (shaped) mode.mac = marginal({macs_[m]}, {weights_});
    if (!comparable_ || !drawn || (std::isnan(mode.observed) && !shaped)) continue;
    const WithoutMode without = without_mode(densities_[m], weights_);
    mode.information = without.information;
    mode.reliable = without.reliable;
    mode.probability_without = 0.0;
    for (std::size_t s = 0; s < models_.size(); ++s)
      if (models_[s] == winner) mode.probability_without += without.weights[s];
  }
}

std::function<std::vector<double>(std::size_t, std::size_t)> frequency_replicates(
    const DamageProblem& problem, const Posterior& posterior, std::uint64_t seed) {
  const auto variances = std::make_shared<EmulatorVariances>(problem);
  return [&posterior, variances, noise = problem.noise(), seed,
          inferred = inferred_scatter(problem, posterior)](std::size_t c, std::size_t i) {
    const inference::Chain& from = posterior.chains[c];
    const auto width = static_cast<std::size_t>(posterior.dimension);
    const std::span<const double> x(from.theta.data() + i * width, width);
    const std::span<const double> variance = variances->next(from.model[i], x);
    base::Random random(seed, c, i, base::Purpose::prediction);
    std::vector<double> out;
    for (std::size_t m = 0; m < inferred.size(); ++m) {
      const double f = from.prediction[i * inferred.size() + m];
      const double sd =
          inferred[m] > 0.0
              ? inferred[m]
              : noise.replicate_sd(m, f, noise.cv(x), variance.empty() ? 0.0 : variance[m]);
      out.push_back(f + (std::isnan(sd) ? 0.0 : sd) * random.normal());
    }
    return out;
  };
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
