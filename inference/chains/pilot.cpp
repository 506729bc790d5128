#include "inference/chains/pilot.hpp"

#include <algorithm>
#include <cmath>

#include "base/eigen_solvers.hpp"
#include "base/parallel.hpp"
#include "inference/moves/between_models/birth_death.hpp"
#include "inference/moves/between_models/mixture_transport.hpp"
#include "inference/moves/between_models/model_switch.hpp"
#include "inference/moves/mirror.hpp"
#include "inference/moves/multiscale_walk.hpp"
#include "inference/moves/newton_walk.hpp"
#include "inference/moves/regional_walk.hpp"
#include "inference/moves/slice.hpp"
#include "inference/statistics/standard_normal.hpp"

namespace wheeltap::inference {

namespace {

constexpr double kNegligibleProbability =
    1e-15;  // probability below which a model is fitted briefly
constexpr Eigen::Index kFewSamples = 2000;
constexpr int kMostComponents = 240;
constexpr int kFewComponents = 4;

template <typename M, typename... Arguments>
void add_move(KernelMixture& kernels, double weight, const std::string& name,
              Arguments&&... arguments) {
  kernels.add(weight, std::make_unique<MetropolisHastings>(
                          name, std::make_unique<M>(std::forward<Arguments>(arguments)...)));
}

bool is_list(const ModelSpace& space) {
  return space.kinds().empty();
}

// Adds the kernels of both stages, with weights scaled by `share`. The caller adds random walks.
// `pilot` may be null.
void add_component_moves(KernelMixture& kernels, const Problem& problem, const Options& options,
                         const Atlases& atlases, double share,
                         const std::shared_ptr<const PilotFit>& pilot) {
  const ModelSpace& space = problem.space;
  const auto kinds = static_cast<double>(std::max<std::size_t>(space.kinds().size(), 1));
  for (std::size_t j = 0; j < space.kinds().size(); ++j) {
    const int kind = static_cast<int>(j);
    if (options.moves.birth_death) {
      // Without a table, births from the prior replace informed births, and relocations from the
      // prior are rarely accepted.
      add_move<BirthDeath>(kernels, share * (atlases[j] ? 0.3 : 0.9) / kinds, "birth and death",
                           kind, std::make_unique<PriorProposal>(), pilot);
    }
    if (atlases[j] && options.moves.informed_birth) {
      kernels.add(share * 0.4 / kinds,
                  std::make_unique<MetropolisHastings>(
                      "informed birth and death",
                      std::make_unique<BirthDeath>(
                          kind, std::make_unique<InformedProposal>(atlases[j], space, kind)),
                      atlases[j]->work()));
    }
    if (options.moves.relocation) {
      std::unique_ptr<ComponentProposal> proposal = std::make_unique<PriorProposal>();
      if (atlases[j]) proposal = std::make_unique<InformedProposal>(atlases[j], space, kind);
      kernels.add(share * (atlases[j] ? 0.3 : 0.1) / kinds,
                  std::make_unique<MetropolisHastings>(
                      "relocation", std::make_unique<Relocation>(kind, std::move(proposal)),
                      atlases[j] ? 2.0 * atlases[j]->work() : 0.0));
    }
  }
  if (options.moves.birth_death && is_list(space) && space.size() > 1) {
    add_move<ModelSwitch>(kernels, share, "model switch");
  }
  for (const NamedMove& extra : problem.moves) {
    kernels.add(share / static_cast<double>(problem.moves.size()),
                std::make_unique<MetropolisHastings>(extra.name, extra.make()), extra.most);
  }
  if (options.moves.reflection && !problem.reflections.empty()) {
    add_move<Mirror>(kernels, share * 0.25, "mirror", problem.reflections, true);
    add_move<Mirror>(kernels, share * 0.15, "mirror of one", problem.reflections, false);
  }
}

}  // namespace

Atlases make_atlases(const Problem& problem, const Options& options, long& evaluations) {
  Atlases atlases(problem.space.kinds().size());
  if (options.prior_only || !options.moves.informed_birth) return atlases;
  Target target(problem, false);
  for (std::size_t j = 0; j < atlases.size(); ++j)
    atlases[j] = make_atlas(target, static_cast<int>(j));
  evaluations += target.evaluations();
  return atlases;
}

std::unique_ptr<KernelMixture> exploration_kernels(const Problem& problem, const Options& options,
                                                   const Atlases& atlases) {
  auto kernels = std::make_unique<KernelMixture>();
  if (options.moves.random_walk) {
    add_move<RandomWalk>(*kernels, 0.5, "random walk", RandomWalk::initial_scales(problem.space));
  }
  add_component_moves(*kernels, problem, options, atlases, 0.5, nullptr);
  return kernels;
}

PilotSamples::PilotSamples(const ModelSpace& space)
    : models_(static_cast<std::size_t>(space.size())), visits_(models_.size(), 0) {
  for (int m = 0; m < space.size(); ++m) {
    models_[static_cast<std::size_t>(m)].dimension = static_cast<std::size_t>(space[m].dimension);
  }
}

void PilotSamples::add(const State& state) {
  const auto m = static_cast<std::size_t>(state.model);
  OfModel& model = models_[m];
  if (visits_[m]++ % model.stride != 0 || model.dimension == 0) return;
  model.values.insert(model.values.end(), state.z.begin(), state.z.end());
  if (model.values.size() >= 2 * kKeep * model.dimension) {
    // Deletes every second stored state. From now on, only every second state is added.
    const auto d = static_cast<std::ptrdiff_t>(model.dimension);
    for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(kKeep); ++i) {
      std::copy_n(model.values.begin() + 2 * i * d, d, model.values.begin() + i * d);
    }
    model.values.resize(kKeep * model.dimension);
    model.stride *= 2;
  }
}

void PilotSamples::append(const PilotSamples& other) {
  for (std::size_t m = 0; m < models_.size(); ++m) {
    const std::vector<double>& more = other.models_[m].values;
    models_[m].values.insert(models_[m].values.end(), more.begin(), more.end());
    visits_[m] += other.visits_[m];
  }
}

long PilotSamples::total() const {
  long sum = 0;
  for (const long n : visits_) sum += n;
  return sum;
}

Eigen::MatrixXd PilotSamples::states(int model) const {
  const OfModel& of = models_[static_cast<std::size_t>(model)];
  if (of.dimension == 0) return {};
  return Eigen::Map<const Eigen::MatrixXd>(
      of.values.data(), static_cast<Eigen::Index>(of.dimension),
      static_cast<Eigen::Index>(of.values.size() / of.dimension));
}

namespace {

// The coldest samples of a model, and warmer samples until the number is sufficient; thinned to at
// most `most` samples.
Eigen::MatrixXd coldest_states(const std::vector<PilotSamples>& by_rung, int model, Eigen::Index d,
                               Eigen::Index most) {
  Eigen::MatrixXd states(d, 0);
  for (auto rung = by_rung.rbegin(); rung != by_rung.rend() && states.cols() < 40 * (d + 1);
       ++rung) {
    const Eigen::MatrixXd more = rung->states(model);
    if (more.cols() == 0) continue;
    Eigen::MatrixXd both(d, states.cols() + more.cols());
    both << states, more;
    states = std::move(both);
  }
  if (states.cols() <= most) return states;
  Eigen::MatrixXd thinned(d, most);
  for (Eigen::Index i = 0; i < most; ++i) thinned.col(i) = states.col(i * states.cols() / most);
  return thinned;
}

void fit_scales(const Eigen::MatrixXd& states, std::vector<RandomWalk::Block>& blocks) {
  for (RandomWalk::Block& block : blocks) {
    const Eigen::MatrixXd part = states.middleRows(block.first, block.factor.rows());
    const Eigen::MatrixXd centred = part.colwise() - part.rowwise().mean();
    Eigen::MatrixXd covariance =
        centred * centred.transpose() / static_cast<double>(states.cols() - 1);
    // Gives a constant parameter a positive width.
    covariance.diagonal() *= 1.0 + 1e-10;
    covariance.diagonal().array() += 1e-30;
    const Eigen::LLT<Eigen::MatrixXd> llt(covariance);
    if (llt.info() != Eigen::Success) continue;
    block.factor =
        2.38 / std::sqrt(static_cast<double>(part.rows())) * Eigen::MatrixXd(llt.matrixL());
  }
}

// Adds the modes at whose maxima the mixture density is far below the density of their normals.
void cover(const std::vector<NormalMixture::Component>& modes, NormalMixture& mixture) {
  constexpr double kThin = 5.0;    // in ln density
  constexpr double kShare = 0.05;  // weight of all added modes in the mixture
  std::vector<NormalMixture::Component> missing;
  double weight = 0.0;
  for (const NormalMixture::Component& mode : modes) {
    const double own = std::log(mode.weight) - mode.factor.diagonal().array().log().sum() -
                       kLogSqrt2Pi * static_cast<double>(mode.mean.size());
    const std::span<const double> top(mode.mean.data(), static_cast<std::size_t>(mode.mean.size()));
    if (mixture.log_density(top) > own - kThin) continue;
    missing.push_back(mode);
    weight += mode.weight;
  }
  if (missing.empty()) return;
  std::vector<NormalMixture::Component> all;
  for (int k = 0; k < mixture.size(); ++k) {
    all.push_back(mixture[k]);
    all.back().weight *= 1.0 - kShare;
  }
  for (NormalMixture::Component& mode : missing) {
    mode.weight *= kShare / weight;
    all.push_back(std::move(mode));
  }
  mixture = NormalMixture(std::move(all));
}

}  // namespace

Pilot fit_pilot(const ModelSpace& space, const std::vector<PilotSamples>& by_rung,
                const PilotOptions& options) {
  const auto models = static_cast<std::size_t>(space.size());
  auto fit = std::make_shared<PilotFit>();
  auto archive = std::make_shared<Archive>(models);
  Pilot pilot;
  pilot.scales = RandomWalk::initial_scales(space);
  fit->density.resize(models);

  // Share of the visits at β = 1, with a lower limit so that the model is still proposed.
  const PilotSamples& cold = by_rung.back();
  double visits = 0.0;
  for (std::size_t m = 0; m < models; ++m) {
    fit->weight.push_back(options.probability.empty()
                              ? static_cast<double>(cold.visits(static_cast<int>(m))) + 1.0
                              : options.probability[m]);
    visits += fit->weight.back();
  }
  double total = 0.0;
  for (double& weight : fit->weight) {
    weight = std::max(weight / visits, 0.01 / space.size());
    total += weight;
  }
  for (double& weight : fit->weight) weight /= total;

  base::parallel_for(space.size(), options.threads, [&](int m) {
    const auto at = static_cast<std::size_t>(m);
    const Eigen::Index d = space[m].dimension;
    if (d == 0) return;
    Eigen::MatrixXd& states = (*archive)[at] = coldest_states(by_rung, m, d, options.most_samples);
    if (at < options.besides.size() && options.besides[at].cols() > 0) {
      const Eigen::Index met = states.cols();
      states.conservativeResize(d, met + options.besides[at].cols());
      states.rightCols(options.besides[at].cols()) = options.besides[at];
    }
    if (states.cols() < 4 * (d + 1)) {
      fit->density[at] =
          std::make_unique<NormalMixture>(NormalMixture::standard(static_cast<int>(d)));
      if (at < options.modes.size()) cover(options.modes[at], *fit->density[at]);
      return;
    }
    base::Random random(options.seed, at, static_cast<std::uint64_t>(options.round),
                        base::Purpose::fit);
    // The fit of a model that no chain will visit serves only for its evidence. (Models of
    // component sets use each other's fits.)
    const bool negligible = is_list(space) && !options.probability.empty() &&
                            options.probability[at] < kNegligibleProbability;
    const Eigen::Index used = negligible ? std::min(states.cols(), kFewSamples) : states.cols();
    Eigen::MatrixXd fitted(d, used);
    for (Eigen::Index i = 0; i < used; ++i) fitted.col(i) = states.col(i * states.cols() / used);
    // Uses as many components as the samples require; a curved ridge requires hundreds.
    int most = negligible ? kFewComponents : options.most_components;
    while (true) {
      fit->density[at] = std::make_unique<NormalMixture>(NormalMixture::fit(
          fitted.transpose(), {.max_components = most, .tolerance = options.tolerance}, random));
      if (negligible || fit->density[at]->size() < most || 3 * most > kMostComponents) break;
      most *= 3;
    }
    if (at < options.modes.size()) cover(options.modes[at], *fit->density[at]);
    fit_scales(states, pilot.scales[at]);
  });

  for (std::size_t j = 0; j < space.kinds().size(); ++j) {
    pilot.conditionals.push_back(
        std::make_shared<const ConditionalMixtures>(space, *fit, static_cast<int>(j)));
  }
  pilot.fit = std::move(fit);
  pilot.archive = std::move(archive);
  return pilot;
}

std::vector<double> equal_visits_bias(const std::vector<double>& probability, double least) {
  std::vector<double> bias;
  for (const double p : probability) bias.push_back(-std::log(std::max(p, least)));
  return bias;
}

std::unique_ptr<KernelMixture> sampling_kernels(const Problem& problem, const Options& options,
                                                const Atlases& atlases, const Pilot& pilot,
                                                Reach reach) {
  const ModelSpace& space = problem.space;
  auto kernels = std::make_unique<KernelMixture>();
  const bool exploring = reach != Reach::fitted;
  if (options.moves.random_walk) {
    // While the mixture does not fit the posterior, steps of all lengths and along its components
    // must find the missing regions. For the draws, they replace most of the random walk.
    add_move<RandomWalk>(*kernels, exploring ? 0.1 : 0.02, "random walk", pilot.scales);
    add_move<MultiscaleWalk>(*kernels, exploring ? 0.3 : 0.05, "multiscale walk", pilot.scales);
    add_move<RegionalWalk>(*kernels, exploring ? 0.2 : 0.03, "regional walk", pilot.fit);
    add_move<DifferentialEvolution>(*kernels, 0.05, "differential evolution", pilot.archive);
  }
  // An expensive likelihood is worth the derivatives of each proposal.
  if (options.moves.random_walk && problem.costly && is_list(space))
    add_move<NewtonWalk>(*kernels, exploring ? 0.5 : 0.3, "Newton walk");
  // Without tables, only births from the prior or the pilot change the count: more such steps.
  const bool blind = std::none_of(atlases.begin(), atlases.end(), [](const auto& a) { return a; });
  add_component_moves(*kernels, problem, options, atlases, blind && !is_list(space) ? 0.6 : 0.3,
                      options.moves.independence ? pilot.fit : nullptr);
  if (options.moves.independence) {
    if (space.size() > 1) {
      add_move<MixtureJump>(*kernels, 0.4, "mixture jump", pilot.fit, true);
      add_move<MixtureTransport>(*kernels, 0.05, "mixture transport", pilot.fit);
    }
    add_move<MixtureJump>(*kernels, 0.1, "mixture renewal", pilot.fit, false);
    for (std::size_t j = 0; j < space.kinds().size(); ++j) {
      const int kind = static_cast<int>(j);
      const double share = 1.0 / static_cast<double>(space.kinds().size());
      const auto propose = [&] {
        return std::make_unique<ConditionalProposal>(pilot.conditionals[j], space, kind);
      };
      add_move<BirthDeath>(*kernels, 0.2 * share, "pilot birth and death", kind, propose(),
                           pilot.fit);
      add_move<Relocation>(*kernels, 0.05 * share, "pilot relocation", kind, propose());
    }
  }
  if (pilot.efficiencies.size() == static_cast<std::size_t>(kernels->size()))
    kernels->reweigh(pilot.efficiencies);
  if (reach == Reach::beyond && options.moves.random_walk)
    kernels->add(0.3, std::make_unique<Slice>(0.3));
  return kernels;
}

}  // namespace wheeltap::inference
