#include "inference/exploration/model_exploration.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <memory>
#include <numeric>
#include <utility>

#include "base/constants.hpp"
#include "base/eigen_solvers.hpp"
#include "base/random.hpp"
#include "inference/diagnosis/convergence.hpp"
#include "inference/evidence/multiple_importance_sampling.hpp"
#include "inference/evidence/tmcmc.hpp"
#include "inference/mixtures/normal_mixture.hpp"

namespace wheeltap::inference {
namespace {

constexpr int kExplorations = 4;             // replicates of SMC
constexpr int kClimbsFromDraws = 8;          // climbs from SMC draws
constexpr std::size_t kClimbsOnTheWay = 24;  // climbs from draws of an incomplete SMC run
constexpr std::size_t kLaplace = 40;         // largest number of modes in the mixture
constexpr double kDefensive = 0.05;          // weight of the prior in the mixture
constexpr double kWider = 1.5;  // factor on the variances of the modes' normals in a proposal
// If the effective sample size exceeds this fraction of the draws, no further round follows.
constexpr double kGoodShare = 0.5;
// The same for a costly likelihood, for this number of effective draws per dimension.
constexpr double kGoodNumber = 80.0;
constexpr double kFewestDraws = 500.0;  // effective draws of a trusted importance sample
constexpr Eigen::Index kPopulation = 4000;
constexpr Eigen::Index kFitted = 2000;  // number of draws in the fit of a proposal
// Number of components of the fit in the first and the second attempt.
constexpr std::array<int, 2> kComponents{8, 20};
// If a larger share of the SMC draws is outside all proposals, the proposals have missed a part of
// the posterior, such as a curved ridge. The next round then uses more components.
constexpr double kLacking = 0.003;
constexpr int kOfRidges = 80;
constexpr int kMoreRounds = 4;
constexpr double kOneMode = 0.99;     // share of a single dominant mode
constexpr int kBriefParticles = 200;  // SMC samples per replicate if one mode dominates
constexpr long kBriefCalls = 20'000;
constexpr double kFar = 8.0;  // a draw of no known mode: standard deviations of χ² above the mean

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;
using Components = std::vector<NormalMixture::Component>;

std::vector<double> row(const Matrix& draws, Eigen::Index i) {
  return {draws.row(i).begin(), draws.row(i).end()};
}

void append(const Matrix& more, Matrix& draws) {
  const Eigen::Index had = draws.rows();
  draws.conservativeResize(had + more.rows(), more.cols());
  draws.bottomRows(more.rows()) = more;
}

Matrix cholesky(const Matrix& covariance) {
  return Eigen::LLT<Matrix>(covariance).matrixL();
}

// Weights of the modes by Laplace's method, each at least a tenth of an equal share.
std::vector<double> mode_weights(const std::vector<Mode>& modes, std::size_t n) {
  std::vector<double> weights;
  double sum = 0.0;
  for (std::size_t k = 0; k < n; ++k)
    sum += weights.emplace_back(std::exp(modes[k].log_mass - modes.front().log_mass));
  for (double& w : weights) w = std::max(w / sum, 0.1 / static_cast<double>(n));
  return weights;
}

void add_modes(const std::vector<Mode>& modes, double share, Components& components) {
  const std::size_t n = std::min(modes.size(), kLaplace);
  if (n == 0) return;
  const std::vector<double> weights = mode_weights(modes, n);
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (std::size_t k = 0; k < n; ++k) {
    components.push_back(
        {share * weights[k] / sum,
         Eigen::Map<const Vector>(modes[k].z.data(), static_cast<Eigen::Index>(modes[k].z.size())),
         cholesky(kWider * modes[k].covariance)});
  }
}

// Adds a fit of at most `most` components. More than kFitted draws do not improve a proposal.
void add_fit(const Matrix& draws, int most, double share, base::Random& random,
             Components& components) {
  if (draws.rows() < 4 * (draws.cols() + 1)) return;
  const Eigen::Index n = std::min(draws.rows(), kFitted);
  Matrix used(n, draws.cols());
  for (Eigen::Index i = 0; i < n; ++i) used.row(i) = draws.row(i * draws.rows() / n);
  const NormalMixture fit = NormalMixture::fit(
      used, {.max_components = most, .defensive_weight = 0.0, .tolerance = 1e-5}, random);
  for (int k = 0; k < fit.size(); ++k) {
    components.push_back(fit[k]);
    components.back().weight *= share;
  }
}

// Fallback if importance sampling fails: the SMC draws, and draws of the normals about modes
// without SMC draws.
Matrix draws_and_modes(const Matrix& draws, const std::vector<Mode>& modes, base::Random& random,
                       double about_modes = 1000.0) {
  const auto precisions = precisions_of(modes);
  std::vector<long> counts(modes.size(), 0);
  for (Eigen::Index i = 0; i < draws.rows(); ++i) {
    const int k = nearest_mode(modes, precisions, row(draws, i));
    if (k >= 0) ++counts[static_cast<std::size_t>(k)];
  }
  const std::size_t n = std::min(modes.size(), kLaplace);
  const std::vector<double> weights = mode_weights(modes, n);
  Matrix out = draws;
  for (std::size_t k = 0; k < n; ++k) {
    if (counts[k] > 0) continue;
    const auto m = static_cast<Eigen::Index>(std::ceil(about_modes * weights[k]));
    const Matrix factor = cholesky(modes[k].covariance);
    const auto d = static_cast<Eigen::Index>(modes[k].z.size());
    const Eigen::Index had = out.rows();
    out.conservativeResize(had + m, d);
    Vector u(d);
    for (Eigen::Index i = 0; i < m; ++i) {
      for (double& v : u) v = random.normal();
      out.row(had + i) = (Eigen::Map<const Vector>(modes[k].z.data(), d) + factor * u).transpose();
    }
  }
  return out;
}

// The share of the probability of each mode: from the importance sample if this sample is reliable
// and contains more than a few draws of the mode, otherwise by Laplace's method.
std::vector<double> shares(const ModelExploration& found, const MultipleImportanceSampler& sampler,
                           bool trusted) {
  constexpr double kFew = 5.0;  // effective draws
  const std::size_t n = found.modes.size();
  std::vector<double> sum(n, 0.0), squares(n, 0.0), laplace(n, 0.0);
  double all = 0.0;
  for (std::size_t k = 0; k < n; ++k)
    all += laplace[k] = std::exp(found.modes[k].log_mass - found.modes.front().log_mass);
  for (double& share : laplace) share /= all;
  if (!trusted) return laplace;
  const auto precisions = precisions_of(found.modes);
  for (std::size_t i = 0; i < sampler.weights().size(); ++i) {
    const double w = sampler.weights()[i];
    const int k = w > 0.0 ? nearest_mode(found.modes, precisions, sampler.z(i)) : -1;
    if (k < 0) continue;
    sum[static_cast<std::size_t>(k)] += w;
    squares[static_cast<std::size_t>(k)] += w * w;
  }
  for (std::size_t k = 0; k < n; ++k) {
    const double effective = squares[k] > 0.0 ? sum[k] * sum[k] / squares[k] : 0.0;
    if (effective < kFew) sum[k] = std::min(sum[k], laplace[k]);
  }
  return sum;
}

}  // namespace

double ModelExploration::log_evidence() const {
  if (std::isfinite(sampled.log_evidence) && effective_draws > 20.0) return sampled.log_evidence;
  double best = std::isfinite(annealed.log_evidence) ? annealed.log_evidence : -kInfinity;
  if (!modes.empty()) best = std::max(best, modes.front().log_mass);
  return best;
}

std::vector<Matrix> precisions_of(const std::vector<Mode>& modes) {
  std::vector<Matrix> out;
  for (const Mode& mode : modes) {
    const Eigen::Index d = mode.covariance.rows();
    out.push_back(Eigen::LLT<Matrix>(mode.covariance).solve(Matrix::Identity(d, d)));
  }
  return out;
}

int nearest_mode(const std::vector<Mode>& modes, const std::vector<Matrix>& precisions,
                 std::span<const double> z) {
  int nearest = -1;
  double least = kInfinity;
  const Eigen::Map<const Vector> at(z.data(), static_cast<Eigen::Index>(z.size()));
  for (std::size_t k = 0; k < modes.size(); ++k) {
    const Vector e = at - Eigen::Map<const Vector>(modes[k].z.data(), at.size());
    const double distance = e.dot(precisions[k] * e);
    if (distance < least) least = distance, nearest = static_cast<int>(k);
  }
  return nearest;
}

bool ModelExploration::settled() const {
  return !shares.empty() && efficiency > kGoodShare &&
         *std::ranges::max_element(shares) > kOneMode && std::isfinite(sampled.log_evidence);
}

namespace {

// Reports progress to the caller, and stores whether the caller wants to continue.
class Reporter {
 public:
  explicit Reporter(const ExplorationOptions& options) : options_(options) {}
  bool operator()(double done) {
    if (options_.progress && !options_.progress(done - reported_)) stopped_ = true;
    reported_ = done;
    return !stopped_;
  }
  [[nodiscard]] bool stopped() const { return stopped_ || (options_.stop && options_.stop()); }

 private:
  const ExplorationOptions& options_;
  double reported_ = 0.0;
  bool stopped_ = false;
};

// Draws of another method, with ln π at each.
class OtherDraws {
 public:
  OtherDraws(const Problem& problem, int model, const Matrix& draws,
             const std::function<bool()>& stop)
      : draws_(draws) {
    ModelPosterior posterior(problem, model);
    for (Eigen::Index i = 0; i < draws.rows() && !(stop && stop()); ++i)
      log_posterior_.push_back(posterior(row(draws, i)).log_posterior());
    evaluations_ = posterior.evaluations();
  }
  [[nodiscard]] long evaluations() const { return evaluations_; }
  /// The draws outside the mixture of all proposals of `sampler`, as in the diagnosis.
  [[nodiscard]] Matrix beyond(const MultipleImportanceSampler& sampler) const {
    const double level = sampler.evidence().log_evidence + std::log(kLimits.beyond_mixture);
    std::vector<Eigen::Index> rows;
    for (Eigen::Index i = 0; i < draws_.rows(); ++i) {
      const double log_posterior = log_posterior_[static_cast<std::size_t>(i)];
      if (log_posterior - sampler.log_proposal(row(draws_, i)) > level) rows.push_back(i);
    }
    return draws_(rows, Eigen::indexing::all);
  }

 private:
  const Matrix& draws_;
  std::vector<double> log_posterior_;
  long evaluations_ = 0;
};

// Computes evidence, shares and population by importance sampling from all findings. Returns false
// if stopped; `found` is then unchanged.
bool weigh_model(const Problem& problem, int model, const ExplorationOptions& options,
                 const Matrix& draws, ModelExploration& found) {
  const Eigen::Index d = problem.space[model].dimension;
  base::Random random(options.seed, static_cast<std::uint64_t>(model),
                      found.calls.weigh > 0 ? 2 : 0, base::Purpose::fit);
  MultipleImportanceSampler sampler(problem, model, options.seed, options.threads, options.stop);
  Components components;
  add_modes(found.modes, 0.5, components);
  add_fit(draws, kComponents[0], 0.5, random, components);
  const int n = static_cast<int>(std::clamp<Eigen::Index>(200 * d, 1000, 4000));
  const OtherDraws others(problem, model, draws, options.stop);
  if (options.stop && options.stop()) return false;
  Matrix beyond(0, d);
  const auto lacks = [&] {
    return static_cast<double>(beyond.rows()) > kLacking * static_cast<double>(draws.rows());
  };
  for (int round = 0; round < options.rounds + (lacks() ? kMoreRounds : 0) && !components.empty();
       ++round) {
    components.push_back({kDefensive, Vector::Zero(d), Matrix::Identity(d, d)});
    sampler.add(NormalMixture(std::move(components)), n);
    if (options.stop && options.stop()) return false;
    components.clear();
    beyond = others.beyond(sampler);
    const int most = lacks() ? kOfRidges : kComponents[round < 2 ? 0 : 1];
    const bool good =
        sampler.efficiency() > kGoodShare ||
        (problem.costly &&
         sampler.effective_draws() > std::max(kFewestDraws, kGoodNumber * static_cast<double>(d)));
    if (round > 0 && good && !lacks()) break;
    if (sampler.effective_draws() < 8.0 * static_cast<double>(d + 1)) {
      // With too few draws for a fit, repeats the same proposal.
      add_modes(found.modes, 0.5, components);
      add_fit(draws, most, 0.5, random, components);
      continue;
    }
    const double share =
        lacks() ? static_cast<double>(beyond.rows()) / static_cast<double>(draws.rows()) : 0.0;
    add_modes(found.modes, 0.1, components);
    if (share < 1.0)
      add_fit(sampler.resampled(kFitted, random), most, 0.9 * (1.0 - share), random, components);
    if (share > 0.0) add_fit(beyond, most, 0.9 * share, random, components);
  }
  found.calls.weigh += sampler.evaluations() + others.evaluations();
  found.sampled = sampler.evidence();
  std::vector<double> log_weights;
  for (const double w : sampler.weights()) log_weights.push_back(std::log(w));
  found.pareto = pareto_tail(log_weights);
  found.effective_draws = sampler.effective_draws();
  found.efficiency = sampler.efficiency();
  const bool trusted =
      found.effective_draws >= std::max(kFewestDraws, 50.0 * static_cast<double>(d));
  Matrix population = trusted ? sampler.resampled(kPopulation, random)
                              : draws_and_modes(draws, found.modes, random);
  if (trusted && beyond.rows() > 0) append(beyond, population);
  found.population = population.transpose();
  found.shares = shares(found, sampler, trusted);
  if (!trusted) found.efficiency = 0.0;
  return true;
}

// Results without importance sampling: evidence by Laplace's method, with an assumed error of one
// nat, and draws from the normals at the modes.
void take_laplace(int model, const ExplorationOptions& options, ModelExploration& found) {
  if (found.modes.empty() || !found.shares.empty()) return;
  base::Random random(options.seed, static_cast<std::uint64_t>(model), 0, base::Purpose::fit);
  double sum = 0.0;
  for (const Mode& mode : found.modes)
    sum += std::exp(mode.log_mass - found.modes.front().log_mass);
  found.annealed.log_evidence = found.modes.front().log_mass + std::log(sum);
  found.annealed.standard_error = 1.0;
  for (const Mode& mode : found.modes)
    found.shares.push_back(std::exp(mode.log_mass - found.modes.front().log_mass) / sum);
  const auto d = static_cast<Eigen::Index>(found.modes.front().z.size());
  found.population = draws_and_modes(Matrix(0, d), found.modes, random, 100.0).transpose();
}

// Starting points of climbs, evenly spaced in the list of draws.
std::vector<std::vector<double>> some_of(const Matrix& draws, int most = kClimbsFromDraws) {
  std::vector<std::vector<double>> starts;
  for (Eigen::Index k = 0; draws.rows() > 0 && k < most; ++k)
    starts.push_back(row(draws, k * draws.rows() / most));
  return starts;
}

// Selects draws in turn. Each is the draw farthest from all earlier selected draws, in standard
// deviations of the draws, so that a small separate group is represented.
std::vector<std::vector<double>> far_apart(Matrix draws) {
  std::vector<std::vector<double>> starts;
  if (draws.rows() == 0) return starts;
  const Matrix given = draws;
  draws.rowwise() -= draws.colwise().mean().eval();
  for (Eigen::Index j = 0; j < draws.cols(); ++j)
    if (const double size = draws.col(j).norm(); size > 0.0) draws.col(j) /= size;
  Vector nearest = Vector::Constant(draws.rows(), kInfinity);
  Eigen::Index next = 0;
  while (starts.size() < kClimbsOnTheWay && nearest[next] > 0.0) {
    starts.push_back(row(given, next));
    nearest = nearest.cwiseMin((draws.rowwise() - draws.row(next).eval()).rowwise().squaredNorm());
    nearest.maxCoeff(&next);
  }
  return starts;
}

// Draws that are improbable under the normals at the known modes.
Matrix outlying(const Matrix& draws, const std::vector<Mode>& modes) {
  const auto precisions = precisions_of(modes);
  const auto d = static_cast<double>(draws.cols());
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = 0; i < draws.rows(); ++i) {
    const int k = nearest_mode(modes, precisions, row(draws, i));
    if (k < 0) continue;
    const auto at = static_cast<std::size_t>(k);
    const Vector e =
        draws.row(i).transpose() - Eigen::Map<const Vector>(modes[at].z.data(), draws.cols());
    if (e.dot(precisions[at] * e) > d + kFar * (1.0 + std::sqrt(2.0 * d))) rows.push_back(i);
  }
  return draws(rows, Eigen::indexing::all);
}

bool are_equal(const std::vector<Mode>& a, const std::vector<Mode>& b) {
  return std::ranges::equal(a, b, {}, &Mode::z, &Mode::z);
}

// Climbs from `starts`. Returns true if the climbs lead to a new mode.
bool climb_from(const Problem& problem, int model, const ExplorationOptions& options,
                std::vector<std::vector<double>> starts, ModelExploration& found) {
  ModeSearch known{.modes = found.modes, .climbs = found.climbs, .likelihood_evaluations = 0};
  extend_search(problem, model,
                {.seed = options.seed,
                 .starts = std::move(starts),
                 .fine = options.from_starts,
                 .threads = options.threads,
                 .stop = options.stop},
                known);
  found.calls.search += known.likelihood_evaluations;
  const bool more = known.modes.size() > found.modes.size();
  found.modes = std::move(known.modes);
  return more;
}

// Climbs from the prior, and from the given starts.
void search_from_prior(const Problem& problem, int model, const ExplorationOptions& options,
                       Reporter& report, ModelExploration& out) {
  std::vector<std::vector<double>> starts = options.starts;
  std::ranges::move(some_of(options.draws, options.climbs_from_draws), std::back_inserter(starts));
  ModeSearch found = search_modes(problem, model,
                                  {.seed = options.seed,
                                   .climbs = options.climbs,
                                   .budget = options.budget,
                                   .effort = options.effort,
                                   .starts = std::move(starts),
                                   .fine = !options.starts.empty(),
                                   .threads = options.threads,
                                   .progress = [&](double done) { return report(0.8 * done); },
                                   .stop = options.stop});
  out.modes = std::move(found.modes);
  out.climbs = found.climbs;
  out.spacing = found.spacing;
  out.left_out = found.left_out;
  out.left_out_share = found.left_out_share;
  out.calls.search += found.likelihood_evaluations;
}

struct Annealed {
  Matrix draws;
  bool cut = false;  // true if the draws come from tempered posteriors
};

// ln likelihood by the normal approximations at the modes, up to a constant. At each z, the highest
// approximation counts:
//
//   max_k [ln π(m_k) - ½ (z - m_k)ᵀ C_k⁻¹ (z - m_k)] + ½ zᵀz.
LogApproximation normal_approximation(const std::vector<Mode>& modes) {
  constexpr std::size_t kMost = 8;
  struct Normals {
    std::vector<Vector> means;
    std::vector<Matrix> precisions;
    std::vector<double> heights;
  };
  auto of = std::make_shared<Normals>();
  const std::vector<Mode> used(
      modes.begin(), modes.begin() + static_cast<std::ptrdiff_t>(std::min(modes.size(), kMost)));
  of->precisions = precisions_of(used);
  for (const Mode& mode : used) {
    of->means.push_back(
        Eigen::Map<const Vector>(mode.z.data(), static_cast<Eigen::Index>(mode.z.size())));
    of->heights.push_back(mode.log_posterior);
  }
  return [of = std::shared_ptr<const Normals>(std::move(of))](std::span<const double> z) {
    const Eigen::Map<const Vector> at(z.data(), static_cast<Eigen::Index>(z.size()));
    double top = -kInfinity;
    for (std::size_t k = 0; k < of->means.size(); ++k) {
      const Vector e = at - of->means[k];
      top = std::max(top, of->heights[k] - 0.5 * e.dot(of->precisions[k] * e));
    }
    return top + 0.5 * at.squaredNorm();
  };
}

// Runs SMC from the prior. Returns no draws if SMC fails.
Annealed anneal(const Problem& problem, int model, const ExplorationOptions& options, bool brief,
                Reporter& report, ModelExploration& found) {
  const int d = problem.space[model].dimension;
  const int particles =
      brief ? std::min(kBriefParticles, options.particles) : scaled_particles(options.particles, d);
  const bool worthwhile = (problem.costly || d > kFewDimensions) && !found.modes.empty();
  double done = 0.0;
  try {
    Tmcmc annealed =
        tmcmc(problem, model,
              {.seed = options.seed,
               .replicates = kExplorations,
               .samples = std::max(particles / kExplorations, 50),
               // Sufficient for an exploration; a requested evidence needs less.
               .weight_cov = 1.0,
               .acceptances = brief ? 1.0 : 4.0,
               .path = brief ? TmcmcPath::growing : TmcmcPath::better,
               .approximation = worthwhile ? normal_approximation(found.modes) : nullptr,
               .most_evaluations = brief ? kBriefCalls : 0,
               .threads = options.threads,
               .progress =
                   [&](double share) {
                     done += share;
                     return report(brief ? 0.2 * done : 0.2 + 0.7 * done);
                   },
               .stop = options.stop});
    found.annealed = annealed.evidence;
    found.calls.anneal += annealed.evidence.likelihood_evaluations;
    if (!annealed.cut) {
      found.annealed_draws = annealed.z.transpose();
      found.annealed_log_posterior = std::move(annealed.log_posterior);
    }
    return {.draws = std::move(annealed.z), .cut = annealed.cut};
  } catch (const LikelihoodError&) {  // the results of the climbs may suffice
    return {.draws = Matrix(0, problem.space[model].dimension)};
  }
}

// True if SMC found no more probability mass than the mixture has, by the rule of the diagnosis.
// For an incomplete SMC run, climbs from its draws decide.
bool confirmed(const Annealed& annealed, bool another, const ModelExploration& found) {
  if (annealed.cut) return !another;
  if (!std::isfinite(found.annealed.log_evidence)) return false;
  const double error = std::hypot(found.annealed.standard_error, found.sampled.standard_error);
  return found.annealed.log_evidence <=
         found.sampled.log_evidence + kLimits.sigmas * error + kLimits.slack_nats;
}

}  // namespace

ModelExploration survey_model(const Problem& problem, int model,
                              const ExplorationOptions& options) {
  ModelExploration out;
  const Eigen::Index d = problem.space[model].dimension;
  if (d == 0) {
    ModelPosterior posterior(problem, model);
    out.sampled.log_evidence = posterior({}).log_posterior();
    out.sampled.standard_error = 0.0;
    out.annealed = out.sampled;
    out.effective_draws = kInfinity;
    out.calls.weigh = posterior.evaluations();
    return out;
  }
  Reporter report(options);
  if (options.from_starts) climb_from(problem, model, options, options.starts, out);
  if (out.modes.empty()) search_from_prior(problem, model, options, report, out);
  out.glanced = options.climbs_only;
  if (options.climbs_only || report.stopped()) {
    take_laplace(model, options, out);
    return out;
  }
  if (out.modes.empty() && options.draws.rows() == 0) return out;
  if (!weigh_model(problem, model, options, options.draws, out)) take_laplace(model, options, out);
  report(1.0);
  return out;
}

void anneal_model(const Problem& problem, int model, const ExplorationOptions& options,
                  Annealing how, ModelExploration& found) {
  if (problem.space[model].dimension == 0) return;
  Reporter report(options);
  Matrix draws = options.draws;
  // With a cheap likelihood, SMC runs fully, because it may find modes that the climbs missed.
  const bool settled = problem.shortened && found.settled();
  if (settled || how == Annealing::brief) {
    const Annealed brief = anneal(problem, model, options, true, report, found);
    if (report.stopped()) return;
    const Matrix starts = outlying(brief.draws, found.modes);
    const bool another =
        climb_from(problem, model, options, brief.cut ? far_apart(starts) : some_of(starts), found);
    if (report.stopped()) return;
    if (another || !settled) {
      append(brief.draws, draws);
      if (!weigh_model(problem, model, options, draws, found)) return;
    }
    if ((problem.shortened && found.settled() && confirmed(brief, another, found)) ||
        how == Annealing::brief) {
      report(1.0);
      return;
    }
  }
  const Annealed full = anneal(problem, model, options, false, report, found);
  append(full.draws, draws);
  if (report.stopped()) return;
  const std::vector<Mode> before = found.modes;
  const bool another = climb_from(problem, model, options, some_of(draws), found);
  if (report.stopped() || (found.modes.empty() && draws.rows() == 0)) return;
  // With an expensive likelihood, the importance sample of the survey remains if SMC found no
  // further probability mass, and the climbs found and removed no mode.
  const Eigen::Index outside = outlying(full.draws, found.modes).rows();
  if (problem.costly && found.efficiency > 0.0 && confirmed(full, another, found) &&
      are_equal(before, found.modes) &&
      static_cast<double>(outside) <= kLacking * static_cast<double>(full.draws.rows())) {
    report(1.0);
    return;
  }
  if (weigh_model(problem, model, options, draws, found)) report(1.0);
}

ModelExploration explore_model(const Problem& problem, int model,
                               const ExplorationOptions& options) {
  ModelExploration found = survey_model(problem, model, options);
  if (options.anneal && !options.climbs_only)
    anneal_model(problem, model, options, Annealing::as_needed, found);
  return found;
}

}  // namespace wheeltap::inference
