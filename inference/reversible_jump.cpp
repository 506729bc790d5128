#include "inference/reversible_jump.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <numeric>

#include "base/parallel.hpp"
#include "inference/diagnostics.hpp"
#include "inference/evidence/bridge_sampling.hpp"
#include "inference/evidence/comparison.hpp"
#include "inference/evidence/importance_sampling.hpp"
#include "inference/kept_draws.hpp"
#include "inference/model_exploration.hpp"
#include "inference/pilot.hpp"
#include "inference/reporter.hpp"
#include "inference/standard_normal.hpp"
#include "inference/starting_points.hpp"
#include "inference/verdict.hpp"

namespace wheeltap::inference {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

constexpr int kExplorationRungs = 10;
constexpr int kMaxRungs = 30;
constexpr int kExplorationScans = 1260;  // 20 + 40 + … + 640
constexpr int kFewestScans = 620;
constexpr int kLadderScans = 620;  // where the proposals have been fitted before
constexpr int kFirstScans = 20;
constexpr int kStepsAScan = 3;
constexpr std::array<int, 3> kTuning{4000, 8000, 20000};  // steps before each refit
// The last round of tuning is one of this length more where its effective draws of the model index
// were fewer than kEnoughModelDraws: the run is to have some 15 000 of them (a probability of ½
// known to 0.004), and mixtures fitted to few are slow to give them.
constexpr int kLongTuning = 80000;
constexpr double kEnoughModelDraws = 4000.0;
constexpr int kSettling = 500;  // iterations at the posterior itself, after the last bias is gone
constexpr Eigen::Index kFirstPopulation = 1000;  // draws of an exploration that a fit takes in
constexpr Eigen::Index kLastPopulation = 4000;   // the last one
constexpr int kManyPeaks = 80;       // components of the mixtures of posteriors with many modes
constexpr long kLongRecord = 20000;  // samples: exploring from the prior costs more than it finds
constexpr int kDefaultDraws = 25000;
constexpr int kMaxDraws = 200000;
constexpr std::size_t kMaxPredictions = 64;  // longer ones are not recorded draw by draw

constexpr int kFewModels = 40;       // each of them is explored by itself
constexpr int kManyModels = 3000;    // glanced at
constexpr long kGlances = 2;         // climbs in each of those
constexpr int kBalancedModels = 64;  // tempered with weights that are learnt
constexpr int kReachedModels = 12;   // of many: those explored by themselves when they are reached
constexpr double kReached = 0.01;    // share of the visits
constexpr long kSearchBudget = 300000;  // likelihood calls for climbs, all models together
constexpr long kRecordBudget = 120000;  // where a record grows: modes are then followed besides
constexpr long kLeastBudget = 3000;     // a model's
constexpr int kEvidenceDraws = 4000;    // of each model's mixture
constexpr long kLadderVisits = 50;      // of each chain, of a model that others are compared with
constexpr double kTrustedDraws = 50.0;  // effective ones of an importance sample
constexpr double kLive = 30.0;          // ln: chains start in models this far below the best
// Models below this probability are visited less than the others while tuning: none of their visits
// is to be expected among the draws.
constexpr double kLeastTuned = 1e-4;

// One chain through all the stages.
struct Runner {
  std::unique_ptr<Target> target;
  std::unique_ptr<TemperedChain> tempered;
  std::unique_ptr<KernelMixture> kernels;
  State state;
  long iteration = 0;
  std::vector<PilotSamples> by_rung;
  std::vector<int> models;            ///< visited in the last round of tuning
  std::vector<KernelRecord> records;  ///< of each kernel, in the last round of tuning
  std::unique_ptr<KeptDraws> kept;
  std::vector<std::vector<long>> at_mode;  ///< draws nearest to each mode of each model
  std::vector<MoveStatistics> moves;
  std::vector<std::vector<long>> proposed, accepted;
};

class Engine {
 public:
  Engine(const Problem& problem, const Options& options)
      : problem_(problem), options_(options), reporter_(options, problem.space.size()) {}

  Posterior run() {
    const auto began = std::chrono::steady_clock::now();
    {
      Target target(problem_, options_.prior_only);
      check_models(target, options_.seed);
      shared_evaluations_ += target.evaluations();
    }
    atlases_ = make_atlases(problem_, options_, shared_evaluations_);
    runners_.resize(static_cast<std::size_t>(options_.chains));
    posterior_.space = &problem_.space;
    posterior_.chains.resize(runners_.size());
    posterior_.thin = options_.thin > 0 ? options_.thin : 4;
    posterior_.dimension = problem_.space.max_dimension();
    each_chain([&](int, Runner& runner) {
      runner.target = std::make_unique<Target>(problem_, options_.prior_only);
      runner.by_rung.assign(1, PilotSamples(problem_.space));
    });

    explore();
    if (!reporter_.stopped()) tune();
    posterior_.warmup_evaluations = evaluations() + shared_evaluations_;
    if (!reporter_.stopped()) sample();

    posterior_.likelihood_evaluations = evaluations() + shared_evaluations_;
    for (const Runner& runner : runners_) {
      posterior_.full_evaluations += runner.target->full_evaluations();
      posterior_.impossible += runner.target->impossible();
    }
    posterior_.stopped_early = reporter_.stopped();
    posterior_.wall_seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    return std::move(posterior_);
  }

 private:
  [[nodiscard]] std::size_t models() const {
    return static_cast<std::size_t>(problem_.space.size());
  }
  [[nodiscard]] long evaluations() const {
    long sum = 0;
    for (const Runner& runner : runners_) sum += runner.target->evaluations();
    return sum;
  }

  template <typename Job>
  void each_chain(Job&& job) {
    base::parallel_for(options_.chains, options_.threads,
                       [&](int c) { job(c, runners_[static_cast<std::size_t>(c)]); });
  }

  // ---- exploring ----

  // Where the posterior is, model by model: what tuning starts from.
  void explore() {
    explorations_.resize(models());
    log_probability_.assign(models(), kNaN);
    const bool list = problem_.space.kinds().empty();
    if (options_.prior_only) {
      temper(kExplorationScans, false);
      if (reporter_.stopped()) return;
      pool();
      for (std::size_t m = 0; m < models(); ++m)
        log_probability_[m] = std::max(-700.0, problem_.space[static_cast<int>(m)].log_prior);
      normalise_probabilities();
      return fit(0);
    }
    if (list && problem_.samples >= kLongRecord && problem_.shortened) {
      explore_growing();
    } else if (list && problem_.space.size() <= kFewModels) {
      explore_each(every_model(), true);
    } else if (list && problem_.space.size() <= kManyModels) {
      explore_many();
    } else {
      temper(kExplorationScans, problem_.space.size() <= kBalancedModels);
      if (reporter_.stopped()) return;
      pool();
      explore_each(reached(), false);
    }
    if (reporter_.stopped()) return;
    estimate_probabilities();
    start_chains();
    fit(0);
  }

  // Parallel tempering over all models, every chain on its own: from the prior, or, once proposals
  // have been fitted, as a ladder to draw with.
  void temper(int full_scans, bool balanced, bool fitted = false) {
    const bool chosen = options_.warmup == 0 && !fitted;  // how long, by the engine
    const int scans = options_.warmup > 0
                          ? std::max(60, options_.warmup / (2 * kExplorationRungs * kStepsAScan))
                          : full_scans;
    reporter_.begin(fitted ? "setting up the ladder" : "exploring",
                    static_cast<double>(scans) * options_.chains);
    std::vector<double> barriers(runners_.size(), 0.0);
    each_chain([&](int c, Runner& runner) {
      const int rungs = options_.moves.tempering ? kExplorationRungs : 1;
      runner.tempered = std::make_unique<TemperedChain>(
          *runner.target, rungs > 1 ? geometric_ladder(rungs) : std::vector<double>{1.0},
          [&] {
            return fitted ? sampling_kernels(problem_, options_, atlases_, pilot_)
                          : exploration_kernels(problem_, options_, atlases_);
          },
          options_.seed, c);
      runner.tempered->start();
      if (fitted) runner.tempered->set_cold(runner.state);
      if (balanced) runner.tempered->balance_models();
      int done = 0;
      for (int round = kFirstScans; done < scans; round *= 2) {
        const int n = std::min(round, scans - done);
        runner.by_rung.assign(static_cast<std::size_t>(runner.tempered->rungs()),
                              PilotSamples(problem_.space));
        for (int i = 0; i < n; ++i) {
          const long before = runner.target->evaluations();
          runner.tempered->scan(kStepsAScan, true, base::Purpose::exploration);
          for (int r = 0; r < runner.tempered->rungs(); ++r) {
            runner.by_rung[static_cast<std::size_t>(r)].add(runner.tempered->state(r));
          }
          reporter_.evaluated(runner.target->evaluations() - before);
          if (!reporter_.advance(1.0)) return;
        }
        done += n;
        if (c == 0) posterior_.warmup += n * kStepsAScan;
        const double barrier = barriers[static_cast<std::size_t>(c)] = runner.tempered->barrier();
        // A round trip takes some 2 + 2 Λ scans (ibid., section 3.5): a hundred of them will do.
        if (chosen && done >= kFewestScans && done >= 100.0 * (2.0 + 2.0 * barrier)) break;
        // Two neighbours a unit of the barrier (Syed et al. 2022, section 4.3), while there is time
        // left.
        if (runner.tempered->rungs() > 1 && done < scans) {
          runner.tempered->adapt_ladder(std::clamp(
              static_cast<int>(std::ceil(2.0 * runner.tempered->barrier())) + 2, 6, kMaxRungs));
        }
      }
      runner.state = runner.tempered->cold();
      runner.target->set_model_bias(std::vector<double>(models(), 0.0));
    });
    posterior_.barrier = *std::ranges::max_element(barriers);
  }

  // Ladders differ between chains: their samples are pooled by rank from the cold end.
  void pool() {
    std::size_t rungs = 0;
    for (const Runner& runner : runners_) rungs = std::max(rungs, runner.by_rung.size());
    hot_.assign(rungs, PilotSamples(problem_.space));
    for (const Runner& runner : runners_) {
      for (std::size_t r = 0; r < runner.by_rung.size(); ++r) {
        hot_[rungs - 1 - r].append(runner.by_rung[runner.by_rung.size() - 1 - r]);
      }
    }
  }

  // Of many models, those that matter as far as tempering can tell.
  [[nodiscard]] std::vector<int> reached() const {
    std::vector<int> list = every_model();
    if (problem_.space.size() <= kFewModels) return list;
    const PilotSamples& cold = hot_.back();
    std::ranges::stable_sort(list, std::ranges::greater{}, [&](int m) { return cold.visits(m); });
    std::erase_if(list, [&](int m) {
      return static_cast<double>(cold.visits(m)) < kReached * static_cast<double>(cold.total());
    });
    if (list.size() > kReachedModels) list.resize(kReachedModels);
    return list;
  }

  [[nodiscard]] std::vector<int> every_model() const {
    std::vector<int> all(models());
    std::iota(all.begin(), all.end(), 0);
    return all;
  }

  // A glance at each of very many models, and a look at those that this makes probable.
  void explore_many() {
    reporter_.begin("searching", static_cast<double>(models()));
    for (const int m : every_model()) {
      if (!std::isfinite(problem_.space[m].log_prior)) continue;
      ModelExploration& found = explorations_[static_cast<std::size_t>(m)] =
          explore_model(problem_, m,
                        {.seed = options_.seed,
                         .climbs = options_.searches > 0 ? options_.searches : kGlances,
                         .anneal = false,
                         .glance = true,
                         .threads = options_.threads});
      shared_evaluations_ += found.likelihood_evaluations;
      reporter_.evaluated(found.likelihood_evaluations);
      if (!reporter_.advance(1.0)) return;
    }
    estimate_probabilities();
    std::vector<int> probable = every_model();
    std::ranges::stable_sort(probable, std::ranges::greater{},
                             [&](int m) { return probability_[static_cast<std::size_t>(m)]; });
    probable.resize(kReachedModels);
    std::erase_if(probable,
                  [&](int m) { return probability_[static_cast<std::size_t>(m)] < kReached; });
    explore_each(probable, false);
  }

  // Each model by itself.
  void explore_each(const std::vector<int>& list, bool anneal) {
    const auto with_parameters =
        std::ranges::count_if(list, [&](int m) { return problem_.space[m].dimension > 0; });
    if (with_parameters == 0 && !anneal) return;
    const double brief =
        options_.warmup > 0 ? std::min(1.0, static_cast<double>(options_.warmup) / 20000.0) : 1.0;
    const long budget = std::max(
        kLeastBudget,
        static_cast<long>(brief *
                          static_cast<double>(problem_.shortened ? kRecordBudget : kSearchBudget) /
                          static_cast<double>(std::max<long>(1, with_parameters))));
    reporter_.begin("searching", static_cast<double>(std::max<long>(1, with_parameters)));
    for (const int m : list) {
      if (!std::isfinite(problem_.space[m].log_prior)) continue;
      ExplorationOptions how{
          .seed = options_.seed,
          .climbs = options_.searches,
          .budget = problem_.space.size() > kFewModels ? kLeastBudget : budget,
          .anneal = anneal,
          .particles = static_cast<int>(std::clamp(
              brief * 12000.0 / static_cast<double>(with_parameters + 1), 400.0, 1200.0)),
          .threads = options_.threads,
          .progress = [&](double share) { return reporter_.advance(share); }};
      if (!hot_.empty()) how.draws = hot_.back().states(m).transpose();
      ModelExploration& found = explorations_[static_cast<std::size_t>(m)] =
          explore_model(problem_, m, how);
      shared_evaluations_ += found.likelihood_evaluations;
      reporter_.evaluated(found.likelihood_evaluations);
      if (reporter_.stopped()) return;
    }
  }

  // Where a long record makes exploring from the prior cost more than it finds.
  void explore_growing() {
    const std::vector<Laplace> modes = climb_with_record(problem_, options_, reporter_);
    if (reporter_.stopped()) return;
    bool any = false;
    for (std::size_t m = 0; m < models(); ++m) {
      const Laplace& mode = modes[m];
      shared_evaluations_ += mode.evidence.likelihood_evaluations;
      if (!std::isfinite(mode.evidence.log_evidence)) continue;
      any = true;
      ModelExploration& found = explorations_[m];
      if (problem_.space[static_cast<int>(m)].dimension == 0) {
        found.sampled = mode.evidence;
        found.effective_draws = kInfinity;
        continue;
      }
      found.modes.push_back({.z = mode.z,
                             .log_posterior = kNaN,
                             .covariance = mode.covariance,
                             .log_mass = mode.evidence.log_evidence,
                             .climbs = 1});
      found.shares = {1.0};
      found.climbs = 1;
      const Eigen::MatrixXd factor = Eigen::LLT<Eigen::MatrixXd>(mode.covariance).matrixL();
      base::Random random(options_.seed, m, 0, base::Purpose::search);
      constexpr Eigen::Index kDraws = 2000;
      found.population.resize(factor.rows(), kDraws);
      Eigen::VectorXd u(factor.rows());
      for (Eigen::Index i = 0; i < kDraws; ++i) {
        for (double& v : u) v = random.normal();
        found.population.col(i) =
            Eigen::Map<const Eigen::VectorXd>(mode.z.data(), factor.rows()) + factor * u;
      }
    }
    if (!any) throw LikelihoodError("no model has a mode that a search on growing records finds");
    posterior_.notes.push_back(
        "The record is long, so the chains were started near modes that were found on its first "
        "samples and followed as it grew.");
  }

  // ln P of each model, as well as the explorations know it.
  void estimate_probabilities() {
    std::vector<double> by_ladder(models(), kNaN), by_evidence(models(), kNaN);
    for (std::size_t m = 0; m < models(); ++m) {
      const double evidence = explorations_[m].log_evidence();
      if (std::isfinite(evidence))
        by_evidence[m] = problem_.space[static_cast<int>(m)].log_prior + evidence;
    }
    if (!hot_.empty()) {
      // Visits over what the learnt weights made of them.
      for (std::size_t m = 0; m < models(); ++m) {
        double sum = -kInfinity;
        for (const Runner& runner : runners_) {
          const auto visits =
              static_cast<double>(runner.by_rung.back().visits(static_cast<int>(m)));
          if (visits > 0.0)
            sum = log_sum_exp(sum, std::log(visits) - runner.tempered->cold_weights()[m]);
        }
        by_ladder[m] = sum;
      }
    }
    // The two are brought to one scale by the models that both know well. Where importance sampling
    // has failed, the ladder knows better than Laplace.
    double shift = 0.0, known = 0.0;
    const auto sampled_well = [&](std::size_t m) {
      return explorations_[m].effective_draws > kTrustedDraws && std::isfinite(by_evidence[m]);
    };
    for (std::size_t m = 0; m < models(); ++m) {
      if (!std::isfinite(by_ladder[m]) || !sampled_well(m)) continue;
      shift += by_evidence[m] - by_ladder[m];
      known += 1.0;
    }
    if (known > 0.0) shift /= known;
    if (!hot_.empty()) anneal_by_ladder();
    double top = -kInfinity;
    for (std::size_t m = 0; m < models(); ++m) {
      const bool by_its_own = !std::isfinite(by_ladder[m]) || (known > 0.0 && sampled_well(m));
      double& p = log_probability_[m] = by_its_own ? by_evidence[m] : by_ladder[m] + shift;
      if (std::isnan(p)) p = -kInfinity;
      top = std::max(top, p);
    }
    for (double& p : log_probability_) p = std::max(p - top, -700.0);
    normalise_probabilities();
  }

  // ln Z of each model along the ladder, beside that of a model which importance sampling knows
  // well: chains have each their own weights and visits, and their scatter is the standard error.
  void anneal_by_ladder() {
    std::size_t anchor = models();
    for (std::size_t m = 0; m < models(); ++m) {
      if (!(explorations_[m].effective_draws > kTrustedDraws)) continue;
      if (std::ranges::any_of(runners_, [&](const Runner& runner) {
            return runner.by_rung.back().visits(static_cast<int>(m)) < kLadderVisits;
          }))
        continue;
      if (anchor == models() ||
          explorations_[m].effective_draws > explorations_[anchor].effective_draws)
        anchor = m;
    }
    const auto chains = static_cast<double>(runners_.size());
    if (anchor == models() || runners_.size() < 4) return;
    const auto log_mass = [&](const Runner& runner, std::size_t m) {
      return std::log(static_cast<double>(runner.by_rung.back().visits(static_cast<int>(m)))) -
             runner.tempered->cold_weights()[m] - problem_.space[static_cast<int>(m)].log_prior;
    };
    for (std::size_t m = 0; m < models(); ++m) {
      if (m == anchor || std::isfinite(explorations_[m].annealed.log_evidence)) continue;
      double sum = 0.0, squares = 0.0;
      for (const Runner& runner : runners_) {
        const double difference = log_mass(runner, m) - log_mass(runner, anchor);
        sum += difference;
        squares += difference * difference;
      }
      const double mean = sum / chains;
      if (!std::isfinite(mean)) continue;  // some chain was never there
      const double variance = std::max(0.0, squares / chains - mean * mean) / (chains - 1.0);
      Evidence& annealed = explorations_[m].annealed;
      annealed.log_evidence = explorations_[anchor].sampled.log_evidence + mean;
      // Student's t, as for TMCMC's replicates (tmcmc.hpp)
      annealed.standard_error = std::sqrt(variance * (chains - 1.0) / (chains - 3.0));
    }
  }

  void normalise_probabilities() {
    probability_.assign(models(), 0.0);
    double sum = 0.0;
    for (std::size_t m = 0; m < models(); ++m)
      sum += probability_[m] = std::exp(log_probability_[m]);
    for (double& p : probability_) p /= sum;
  }

  // Chains start in different models where several are possible, at draws of the populations.
  void start_chains() {
    std::vector<int> live;
    double best = -kInfinity;
    for (const double p : log_probability_) best = std::max(best, p);
    for (std::size_t m = 0; m < models(); ++m)
      if (log_probability_[m] > best - kLive) live.push_back(static_cast<int>(m));
    each_chain([&](int c, Runner& runner) {
      base::Random random(options_.seed, static_cast<std::uint64_t>(c), 1, base::Purpose::start);
      for (std::size_t attempt = 0; attempt < 20 * live.size(); ++attempt) {
        State state;
        state.model = live[(static_cast<std::size_t>(c) + attempt) % live.size()];
        const auto m = static_cast<std::size_t>(state.model);
        const Eigen::MatrixXd& population = explorations_[m].population;
        if (problem_.space[state.model].dimension > 0) {
          if (population.cols() > 0) {
            const auto column = population.col(random.index(static_cast<int>(population.cols())));
            state.z.assign(column.begin(), column.end());
          } else if (!hot_.empty() && hot_.back().visits(state.model) > 0) {
            const Eigen::MatrixXd states = hot_.back().states(state.model);
            const auto column = states.col(random.index(static_cast<int>(states.cols())));
            state.z.assign(column.begin(), column.end());
          } else {
            continue;
          }
        }
        runner.target->sort_components(state);
        runner.target->evaluate(state);
        if (!std::isfinite(state.log_likelihood)) continue;
        runner.state = std::move(state);
        return;
      }
      runner.state = start_from_prior(*runner.target, random);
    });
  }

  // Pools what the chains have seen and freezes the proposals that follow from it.
  void fit(int round) {
    std::vector<PilotSamples> pooled = hot_;
    if (round > 0 || pooled.empty()) {
      pooled.emplace_back(problem_.space);
      if (round > 0)
        for (const Runner& runner : runners_) pooled.back().append(runner.by_rung.back());
    }
    if (round > 0) learn_probabilities(pooled.back());
    // The last fit is the one that is used; the first two only have to lead there.
    const bool last = round >= static_cast<int>(kTuning.size());
    PilotOptions how{.seed = options_.seed,
                     .round = round,
                     .threads = options_.threads,
                     .most_samples = last ? 12000 : 3000,
                     .most_components = 20,
                     .besides = {},
                     .probability = probability_,
                     .modes = {}};
    if (!explorations_.empty()) {
      for (const ModelExploration& found : explorations_) {
        Eigen::Index most = last ? kLastPopulation : kFirstPopulation;
        if (options_.warmup > 0)
          most = std::min<Eigen::Index>(most, std::max(options_.warmup, 400));
        how.besides.push_back(thinned(found.population, most));
        how.modes.emplace_back();
        for (std::size_t k = 0; k < found.modes.size() && k < 40; ++k) {
          const Mode& mode = found.modes[k];
          how.modes.back().push_back({std::max(found.shares[k], 1e-3),
                                      Eigen::Map<const Eigen::VectorXd>(
                                          mode.z.data(), static_cast<Eigen::Index>(mode.z.size())),
                                      Eigen::LLT<Eigen::MatrixXd>(mode.covariance).matrixL()});
        }
        const auto weighty =
            std::ranges::count_if(found.shares, [](double share) { return share > 0.005; });
        if (last && weighty > 10) how.most_components = kManyPeaks;
      }
    }
    const std::vector<double> earned = round > 0 ? earnings() : std::vector<double>{};
    pilot_ = fit_pilot(problem_.space, pooled, how);
    pilot_.earnings = earned;
  }

  static Eigen::MatrixXd thinned(const Eigen::MatrixXd& columns, Eigen::Index most) {
    if (columns.cols() <= most) return columns;
    Eigen::MatrixXd out(columns.rows(), most);
    for (Eigen::Index i = 0; i < most; ++i) out.col(i) = columns.col(i * columns.cols() / most);
    return out;
  }

  // What each kernel brought in the last round of tuning, over all chains.
  [[nodiscard]] std::vector<double> earnings() const {
    std::vector<KernelRecord> sums(runners_.front().records.size());
    for (const Runner& runner : runners_)
      for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += runner.records[k];
    return kernel_earnings(*runners_.front().kernels, sums);
  }

  // From the last round's visits, of the models that had enough of them, or should have had; the
  // others keep their place beside those.
  void learn_probabilities(const PilotSamples& cold) {
    constexpr double kEnough = 30.0;
    if (bias_.empty()) return;
    double visited = -kInfinity, before = -kInfinity, all = -kInfinity;
    for (std::size_t m = 0; m < models(); ++m)
      all = log_sum_exp(all, log_probability_[m] + bias_[m]);
    std::vector<double> by_visits(models(), kNaN);
    for (std::size_t m = 0; m < models(); ++m) {
      const auto visits = static_cast<double>(cold.visits(static_cast<int>(m)));
      const double expected =
          std::exp(log_probability_[m] + bias_[m] - all) * static_cast<double>(cold.total());
      if (visits < kEnough && expected < kEnough) continue;
      by_visits[m] = std::log(visits + 0.5) - bias_[m];
      visited = log_sum_exp(visited, by_visits[m]);
      before = log_sum_exp(before, log_probability_[m]);
    }
    if (!std::isfinite(before)) before = visited;
    for (std::size_t m = 0; m < models(); ++m)
      log_probability_[m] =
          std::isfinite(by_visits[m]) ? by_visits[m] - visited : log_probability_[m] - before;
    const double top = *std::ranges::max_element(log_probability_);
    for (double& p : log_probability_) p = std::isfinite(p) ? std::max(p - top, -700.0) : -700.0;
    normalise_probabilities();
  }

  // ---- tuning ----

  // At the target itself, with all the moves, adapting; each round ends in a fit to better samples.
  // The models are visited about equally, so that each has its share of those.
  void tune() {
    int total = 0;
    for (const int steps : kTuning) total += steps;
    reporter_.begin("tuning", static_cast<double>(total) * options_.chains);
    int done = 0;
    for (std::size_t round = 0; round < kTuning.size() && !reporter_.stopped(); ++round) {
      const int steps =
          options_.warmup > 0
              ? static_cast<int>(static_cast<double>(options_.warmup) / 2 * kTuning[round] / total)
              : kTuning[round];
      done += tune_once(done, steps);
      if (!reporter_.stopped()) fit(static_cast<int>(round) + 1);
    }
    if (!reporter_.stopped() && options_.warmup == 0) {
      const int thin = posterior_.thin;
      const int longest =
          options_.draws > 0 ? std::min(kLongTuning / thin, options_.draws) * thin : kLongTuning;
      if (longest > kTuning.back() && tuned_model_draws() < kEnoughModelDraws) {
        reporter_.begin("tuning on", static_cast<double>(longest) * options_.chains);
        done += tune_once(done, longest);
        if (!reporter_.stopped()) fit(static_cast<int>(kTuning.size()) + 1);
      }
    }
    // The draws' own bias: none, or, where models are to be drawn evenly, what makes them even.
    sampling_bias_ = options_.balance ? equal_visits_bias(probability_, 1e-12)
                                      : std::vector<double>(models(), 0.0);
    if (options_.balance) {
      for (const double b : sampling_bias_) posterior_.log_weight.push_back(-b);
    }
    for (Runner& runner : runners_) runner.target->set_model_bias(sampling_bias_);
    posterior_.warmup += done;
  }

  int tune_once(int done, int steps) {
    bias_ = equal_visits_bias(probability_, kLeastTuned);
    each_chain([&](int c, Runner& runner) {
      runner.target->set_model_bias(bias_);
      runner.kernels = sampling_kernels(problem_, options_, atlases_, pilot_);
      runner.by_rung.assign(1, PilotSamples(problem_.space));
      runner.models.clear();
      runner.records.assign(static_cast<std::size_t>(runner.kernels->size()), {});
      long before = runner.target->evaluations();
      for (int i = 0; i < steps; ++i) {
        base::Random random(options_.seed, static_cast<std::uint64_t>(c),
                            static_cast<std::uint64_t>(done + i), base::Purpose::adaptation);
        Kernel::Outcome outcome;
        const int from = runner.state.model;
        const int kernel =
            runner.kernels->step(runner.state, {*runner.target, random, 1.0, true}, outcome);
        if (kernel >= 0)
          runner.records[static_cast<std::size_t>(kernel)].add(outcome, outcome.to_model != from);
        runner.by_rung[0].add(runner.state);
        runner.models.push_back(runner.state.model);
        if (i % 64 == 63) {
          reporter_.evaluated(runner.target->evaluations() - before);
          before = runner.target->evaluations();
          if (!reporter_.advance(64.0)) return;
        }
      }
    });
    return steps;
  }

  // Effective draws of the least certain model's indicator in the last round of tuning; infinite
  // where one model has all the probability.
  [[nodiscard]] double tuned_model_draws() const {
    double least = kInfinity;
    for (int m = 0; m < problem_.space.size(); ++m) {
      const double p = pilot_.fit->weight[static_cast<std::size_t>(m)];
      if (p < 0.02 || p > 0.98) continue;
      ChainsOf chains;
      for (const Runner& runner : runners_) {
        std::vector<double>& values = chains.emplace_back();
        for (const int model : runner.models) values.push_back(model == m ? 1.0 : 0.0);
      }
      least = std::min(least, ess_mean(chains));
    }
    return least;
  }

  // ---- drawing ----

  void sample() {
    posterior_.tempered_draws = options_.tempered_draws;
    if (posterior_.tempered_draws && !runners_.front().tempered) set_up_ladder();
    prepare_sampling();
    const int first = options_.draws > 0 ? options_.draws : kDefaultDraws;
    reporter_.begin("sampling", static_cast<double>(first) * options_.chains);
    draw(first);
    collect();
    weigh();
    if (options_.draws == 0) {
      while (!reporter_.stopped() && posterior_.draws < kMaxDraws && !converged()) {
        if (!posterior_.tempered_draws && options_.moves.tempering && !options_.prior_only &&
            !chains_agree()) {
          restart_tempered();
          continue;
        }
        const int more = std::min(posterior_.draws, kMaxDraws - posterior_.draws);
        reporter_.begin("sampling on", static_cast<double>(more) * options_.chains);
        draw(more);
        collect();
        weigh();
      }
    }
  }

  void set_up_ladder() {
    temper(kLadderScans, problem_.space.size() <= kBalancedModels, true);
    for (Runner& runner : runners_) runner.target->set_model_bias(sampling_bias_);
  }

  // Chains that disagree have not seen the same modes: what they drew becomes warm-up, and a
  // ladder is in use from here on.
  void restart_tempered() {
    posterior_.tempered_draws = true;
    posterior_.notes.push_back(
        "The chains disagreed, so they were restarted with parallel tempering throughout.");
    posterior_.warmup += posterior_.draws * posterior_.thin;
    set_up_ladder();
    posterior_.warmup_evaluations = evaluations() + shared_evaluations_;
    posterior_.draws = 0;
    if (options_.thin == 0) posterior_.thin = 1;  // a scan is a step of every rung already
    for (Chain& chain : posterior_.chains) chain = Chain{};
    prepare_sampling();
    reporter_.begin("sampling with tempering",
                    static_cast<double>(kDefaultDraws) * options_.chains);
    draw(kDefaultDraws);
    collect();
    weigh();
  }

  // The modes whose shares the draws are counted for, where a model has several.
  struct WeightyModes {
    std::vector<Mode> modes;
    std::vector<Eigen::MatrixXd> precisions;
    std::vector<double> shares;
  };

  void choose_modes() {
    constexpr double kLeast = 1e-3;  // of a model's probability
    weighty_modes_.assign(models(), {});
    for (std::size_t m = 0; m < models(); ++m) {
      const ModelExploration& found = explorations_[m];
      WeightyModes& of = weighty_modes_[m];
      for (std::size_t k = 0; k < found.modes.size(); ++k) {
        if (k > 0 && found.shares[k] < kLeast) continue;
        of.modes.push_back(found.modes[k]);
        of.shares.push_back(found.shares[k]);
      }
      of.precisions = precisions_of(of.modes);
    }
  }

  void prepare_sampling() {
    choose_modes();
    each_chain([&](int c, Runner& runner) {
      const auto make = [&] { return sampling_kernels(problem_, options_, atlases_, pilot_); };
      runner.kernels = make();
      runner.kept = std::make_unique<KeptDraws>(problem_.space);
      runner.at_mode.clear();
      for (const WeightyModes& of : weighty_modes_) runner.at_mode.emplace_back(of.modes.size());
      if (posterior_.tempered_draws) {
        runner.tempered->set_kernels(make);
        runner.tempered->set_cold_weights(sampling_bias_);
        runner.tempered->set_cold(runner.state);
        runner.tempered->reset_round_trips();
      }
      runner.moves.clear();
      for (int i = 0; i < runner.kernels->size(); ++i) {
        runner.moves.push_back({.name = (*runner.kernels)[i].name()});
      }
      // The chains come from a distribution over models that was biased: they settle before they
      // count.
      const int settling = options_.warmup > 0 ? std::min(kSettling, options_.warmup) : kSettling;
      for (int i = 0; i < settling; ++i) {
        if (posterior_.tempered_draws) {
          if (i % kStepsAScan == 0) runner.tempered->scan(1, false, base::Purpose::settling);
          continue;
        }
        base::Random random(options_.seed, static_cast<std::uint64_t>(c),
                            static_cast<std::uint64_t>(i), base::Purpose::settling);
        Kernel::Outcome outcome;
        runner.kernels->step(runner.state, {*runner.target, random, 1.0, false}, outcome);
      }
      runner.proposed.assign(models(), std::vector<long>(models()));
      runner.accepted = runner.proposed;
    });
    posterior_.warmup += kSettling;
  }

  // `thin` iterations; returns the last move and whether it was accepted.
  std::pair<int, bool> advance(int c, Runner& runner) {
    int move = -1;
    bool accepted = false;
    const auto observe = [&](int kernel, const Kernel::Outcome& outcome, int from_model) {
      move = kernel;
      accepted = outcome.accepted;
      if (!outcome.proposed) return;  // and so kernel >= 0
      MoveStatistics& statistics = runner.moves[static_cast<std::size_t>(kernel)];
      ++statistics.proposed;
      statistics.accepted += outcome.accepted ? 1 : 0;
      const auto from = static_cast<std::size_t>(from_model);
      const auto to = static_cast<std::size_t>(outcome.to_model);
      ++runner.proposed[from][to];
      runner.accepted[from][to] += outcome.accepted ? 1 : 0;
    };
    if (posterior_.tempered_draws) {
      runner.tempered->scan(posterior_.thin, false, base::Purpose::sampling, observe);
      runner.state = runner.tempered->cold();
      return {move, accepted};
    }
    for (int t = 0; t < posterior_.thin; ++t) {
      base::Random random(options_.seed, static_cast<std::uint64_t>(c),
                          static_cast<std::uint64_t>(runner.iteration++), base::Purpose::sampling);
      Kernel::Outcome outcome;
      const int from = runner.state.model;
      const int kernel =
          runner.kernels->step(runner.state, {*runner.target, random, 1.0, false}, outcome);
      observe(kernel, outcome, from);
    }
    return {move, accepted};
  }

  void draw(int draws) {
    each_chain([&](int c, Runner& runner) {
      Chain& chain = posterior_.chains[static_cast<std::size_t>(c)];
      std::vector<long> visits(static_cast<std::size_t>(problem_.space.size()), 0);
      long before = runner.target->evaluations();
      for (int i = 0; i < draws; ++i) {
        const auto [move, accepted] = advance(c, runner);
        record(runner, chain, move, accepted);
        ++visits[static_cast<std::size_t>(runner.state.model)];
        if (i % 256 == 255) {
          reporter_.evaluated(runner.target->evaluations() - before);
          before = runner.target->evaluations();
          reporter_.visited(visits);
          std::fill(visits.begin(), visits.end(), 0);
          if (!reporter_.advance(256.0)) break;
        }
      }
    });
    // A run that was stopped keeps what every chain has.
    std::size_t common = posterior_.chains.front().model.size();
    for (const Chain& chain : posterior_.chains) common = std::min(common, chain.model.size());
    for (Chain& chain : posterior_.chains) truncate(chain, common);
    posterior_.draws = static_cast<int>(common);
  }

  void record(Runner& runner, Chain& chain, int move, bool accepted) const {
    const State& state = runner.state;
    chain.model.push_back(state.model);
    chain.theta.insert(chain.theta.end(), state.x.begin(), state.x.end());
    chain.theta.resize(chain.model.size() * static_cast<std::size_t>(posterior_.dimension),
                       std::numeric_limits<double>::quiet_NaN());
    chain.log_prior.push_back(runner.target->log_prior_physical(state));
    chain.log_likelihood.push_back(state.log_likelihood);
    chain.move.push_back(static_cast<std::int16_t>(move));
    chain.accepted.push_back(accepted ? 1 : 0);
    const auto m = static_cast<std::size_t>(state.model);
    if (const int k = nearest_mode(weighty_modes_[m].modes, weighty_modes_[m].precisions, state.z);
        k >= 0) {
      ++runner.at_mode[m][static_cast<std::size_t>(k)];
    }
    runner.kept->add(state, runner.target->log_prior(state) + state.log_likelihood -
                                problem_.space[state.model].log_prior - sampling_bias_[m]);
    if (state.prediction.size() <= kMaxPredictions) {
      for (const double value : state.prediction)
        chain.prediction.push_back(static_cast<float>(value));
    }
  }

  void truncate(Chain& chain, std::size_t draws) const {
    const std::size_t predictions =
        chain.prediction.size() / std::max<std::size_t>(chain.model.size(), 1);
    chain.model.resize(draws);
    chain.theta.resize(draws * static_cast<std::size_t>(posterior_.dimension));
    chain.log_prior.resize(draws);
    chain.log_likelihood.resize(draws);
    chain.move.resize(draws);
    chain.accepted.resize(draws);
    chain.prediction.resize(draws * predictions);
  }

  [[nodiscard]] ChainsOf indicator(int model) const {
    ChainsOf chains;
    for (const Chain& chain : posterior_.chains) {
      std::vector<double>& values = chains.emplace_back();
      for (const int m : chain.model) values.push_back(m == model ? 1.0 : 0.0);
    }
    return chains;
  }
  [[nodiscard]] double share(int model) const {
    double n = 0.0;
    for (const Chain& chain : posterior_.chains) {
      n += static_cast<double>(std::count(chain.model.begin(), chain.model.end(), model));
    }
    return n / (static_cast<double>(posterior_.draws) * options_.chains);
  }
  [[nodiscard]] ChainsOf log_posterior() const {
    ChainsOf chains;
    for (const Chain& chain : posterior_.chains) {
      std::vector<double>& values = chains.emplace_back(chain.log_likelihood);
      for (std::size_t i = 0; i < values.size(); ++i) values[i] += chain.log_prior[i];
    }
    return chains;
  }

  // Good enough to stop: nothing that the verdict misses, and every model probability known to
  // 0.004, to 0.001 of the draws where those are balanced.
  [[nodiscard]] bool converged() const {
    const double enough = options_.balance ? 0.001 : 0.004;
    for (int m = 0; m < problem_.space.size(); ++m) {
      const double p = share(m);
      if (p > 0.001 && p < 0.999 && !(mcse_mean(indicator(m)) <= enough)) return false;
    }
    return judge(posterior_).converged;
  }

  // Whether longer chains would do: an R-hat far from 1 says that they are in different places.
  [[nodiscard]] bool chains_agree() const {
    for (int m = 0; m < problem_.space.size(); ++m) {
      const double p = share(m);
      if (p > 0.001 && p < 0.999 && !(rhat(indicator(m)) < 1.05)) return false;
    }
    return rhat(log_posterior()) < 1.05;
  }

  // Evidence of every model that was explored, from its draws and its mixture's; and how the draws
  // are shared among its modes.
  void weigh() {
    if (options_.prior_only) return;
    posterior_.found.assign(models(), {});
    at_mixture_.resize(models());
    for (int m = 0; m < problem_.space.size(); ++m) {
      const auto at = static_cast<std::size_t>(m);
      const ModelExploration& explored = explorations_[at];
      ModelFindings& found = posterior_.found[at];
      found.annealed = explored.annealed;
      found.climbs = explored.climbs;
      describe_modes(m, found);
      if (problem_.space[m].dimension == 0) {
        found.sampled = explored.sampled;
        found.bridged = explored.sampled;
        continue;
      }
      const bool matters = explored.population.cols() > 0 || problem_.space.size() <= kFewModels;
      if (!matters || !pilot_.fit->density[at] || reporter_.stopped()) continue;
      std::vector<double>& at_mixture = at_mixture_[at];
      if (at_mixture.empty()) {
        long calls = 0;
        at_mixture = log_importance_ratios(problem_, m, *pilot_.fit->density[at], kEvidenceDraws,
                                           options_.seed, options_.threads, calls);
        shared_evaluations_ += calls;
        evidence_evaluations_ += calls;
        reporter_.evaluated(calls);
      }
      found.sampled = by_importance(at_mixture);
      // The exploration's own sample may be the better one.
      if (std::isfinite(explored.sampled.standard_error) &&
          !(found.sampled.standard_error < explored.sampled.standard_error))
        found.sampled = explored.sampled;
      found.bridged = by_bridge(m, at_mixture);
    }
  }

  [[nodiscard]] static Evidence by_importance(const std::vector<double>& log_ratios) {
    Evidence evidence = kNoEvidence;
    const double top = *std::ranges::max_element(log_ratios);
    if (top == -kInfinity) return evidence;
    double sum = 0.0, squares = 0.0;
    for (const double r : log_ratios) {
      const double w = std::exp(r - top);
      sum += w;
      squares += w * w;
    }
    const auto n = static_cast<double>(log_ratios.size());
    evidence.log_evidence = top + std::log(sum / n);
    evidence.standard_error = std::sqrt(std::max(0.0, (n * squares / (sum * sum) - 1.0) / (n - 1)));
    return evidence;
  }

  [[nodiscard]] Evidence by_bridge(int model, const std::vector<double>& at_mixture) const {
    constexpr std::size_t kLeast = 100;  // draws of a chain
    Evidence evidence = kNoEvidence;
    std::size_t least = std::numeric_limits<std::size_t>::max();
    for (const Runner& runner : runners_) {
      if (runner.kept->of(model).size() >= kLeast)
        least = std::min(least, runner.kept->of(model).size());
    }
    if (least == std::numeric_limits<std::size_t>::max()) return evidence;
    ChainsOf at_draws;
    const NormalMixture& mixture = *pilot_.fit->density[static_cast<std::size_t>(model)];
    for (const Runner& runner : runners_) {
      const KeptDraws::OfModel& kept = runner.kept->of(model);
      if (kept.size() < kLeast) continue;
      std::vector<double>& ratios = at_draws.emplace_back();
      for (std::size_t i = 0; i < least; ++i) {
        const std::size_t row = i * kept.size() / least;
        ratios.push_back(kept.log_posterior[row] - mixture.log_density(kept.row(row)));
      }
    }
    const Bridge bridged = bridge(at_draws, at_mixture);
    if (!bridged.settled || !std::isfinite(bridged.log_evidence)) return evidence;
    evidence.log_evidence = bridged.log_evidence;
    evidence.standard_error = bridged.standard_error;
    return evidence;
  }

  void describe_modes(int model, ModelFindings& found) const {
    const auto at = static_cast<std::size_t>(model);
    const WeightyModes& of = weighty_modes_[at];
    Target target(problem_, true);
    for (std::size_t k = 0; k < of.modes.size(); ++k) {
      State state;
      state.model = model;
      state.z = of.modes[k].z;
      target.evaluate(state);
      FoundMode& mode = found.modes.emplace_back();
      mode.x = state.x;
      mode.log_posterior = of.modes[k].log_posterior;
      mode.climbs = of.modes[k].climbs;
      mode.share = of.shares[k];
      for (const Runner& runner : runners_) {
        const long visits = runner.kept->of(model).visits;
        mode.drawn.push_back(visits == 0 ? kNaN
                                         : static_cast<double>(runner.at_mode[at][k]) /
                                               static_cast<double>(visits));
      }
    }
  }

  // What the chains have counted so far.
  void collect() {
    posterior_.moves.clear();
    posterior_.ladder_round_trips = 0;
    for (Runner& runner : runners_) {
      if (posterior_.tempered_draws) {
        posterior_.ladder_round_trips += runner.tempered->round_trips();
      }
      if (posterior_.moves.empty()) {
        posterior_.moves = runner.moves;
        posterior_.jumps_proposed = runner.proposed;
        posterior_.jumps_accepted = runner.accepted;
        continue;
      }
      for (std::size_t i = 0; i < runner.moves.size(); ++i) {
        posterior_.moves[i].proposed += runner.moves[i].proposed;
        posterior_.moves[i].accepted += runner.moves[i].accepted;
      }
      for (std::size_t a = 0; a < runner.proposed.size(); ++a) {
        for (std::size_t b = 0; b < runner.proposed.size(); ++b) {
          posterior_.jumps_proposed[a][b] += runner.proposed[a][b];
          posterior_.jumps_accepted[a][b] += runner.accepted[a][b];
        }
      }
    }
    const Chain& any = posterior_.chains.front();
    posterior_.predictions =
        any.model.empty() ? 0 : static_cast<int>(any.prediction.size() / any.model.size());
  }

  const Problem& problem_;
  const Options& options_;
  Reporter reporter_;
  Atlases atlases_;
  std::vector<Runner> runners_;
  std::vector<ModelExploration> explorations_;  ///< one a model
  std::vector<WeightyModes> weighty_modes_;     ///< one a model
  std::vector<PilotSamples> hot_;
  Pilot pilot_;
  std::vector<double> log_probability_, probability_;  ///< of the models, as far as is known
  std::vector<double> bias_;                           ///< of the last round of tuning
  std::vector<double> sampling_bias_;                  ///< of the draws
  std::vector<std::vector<double>> at_mixture_;  ///< ln π - ln q at draws of each model's mixture
  Posterior posterior_;
  long shared_evaluations_ = 0;    ///< of no chain in particular
  long evidence_evaluations_ = 0;  ///< those of them that weighing the draws took
};

}  // namespace

Posterior reversible_jump(const Problem& problem, const Options& options) {
  if (options.chains < 1) {
    throw std::invalid_argument("chains = " + std::to_string(options.chains) +
                                " must be at least 1");
  }
  for (const auto& [name, value] :
       {std::pair{"draws", options.draws}, std::pair{"warmup", options.warmup},
        std::pair{"thin", options.thin}, std::pair{"threads", options.threads}}) {
    if (value < 0) {
      throw std::invalid_argument(std::string(name) + " = " + std::to_string(value) +
                                  " must be at least 0 (0: the engine chooses)");
    }
  }
  return Engine(problem, options).run();
}

}  // namespace wheeltap::inference
