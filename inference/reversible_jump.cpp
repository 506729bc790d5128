#include "inference/reversible_jump.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>

#include "inference/diagnostics.hpp"
#include "inference/parallel.hpp"
#include "inference/pilot.hpp"
#include "inference/reporter.hpp"
#include "inference/starting_points.hpp"

namespace wheeltap::inference {

namespace {

constexpr int kExplorationRungs = 10;
constexpr int kMaxRungs = 30;
constexpr int kExplorationScans = 1260;  // 20 + 40 + … + 640
constexpr int kFirstScans = 20;
constexpr int kStepsAScan = 3;
constexpr std::array<int, 3> kTuning{4000, 8000, 20000};  // steps before each refit
// The last round of tuning is one of this length more where its effective draws of the model index
// were fewer than kEnoughModelDraws: the run is to have some 15 000 of them (a probability of ½
// known to 0.004), and mixtures fitted to few are slow to give them.
constexpr int kLongTuning = 80000;
constexpr double kEnoughModelDraws = 4000.0;
// Chains whose mean log posterior differs by more after exploration have not found the same place.
constexpr double kDisagreement = 10.0;
constexpr double kWorseMode = 20.0;  // ln: a mode this much below the best one is left
constexpr int kDrawsAMode = 500;     // for the first pilot
constexpr int kManyPeaks = 80;       // components of the mixtures that such samples are fitted by
constexpr int kLongWarmup = 20000;   // iterations: long enough beside what such samples cost
constexpr long kLongRecord = 20000;  // samples: exploring from the prior costs more than it finds
constexpr int kDefaultDraws = 25000;
constexpr int kMaxDraws = 200000;
constexpr std::size_t kMaxPredictions = 64;  // longer ones are not recorded draw by draw

// One chain through all the stages.
struct Runner {
  std::unique_ptr<Target> target;
  std::unique_ptr<TemperedChain> tempered;
  std::unique_ptr<KernelMixture> kernels;
  State state;
  long iteration = 0;
  std::vector<PilotSamples> by_rung;
  std::vector<int> models;  ///< visited in the last round of tuning
  double explored = 0.0;    ///< mean log posterior at β = 1 in the last round of exploration
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

    if (problem_.samples >= kLongRecord && problem_.shortened && problem_.space.kinds().empty() &&
        !options_.prior_only && !options_.tempered_draws) {
      explore_growing();
    } else {
      explore();
    }
    if (!reporter_.stopped()) tune();
    posterior_.warmup_evaluations = evaluations() + shared_evaluations_;
    if (!reporter_.stopped()) sample();

    posterior_.likelihood_evaluations = evaluations() + shared_evaluations_;
    for (const Runner& runner : runners_)
      posterior_.full_evaluations += runner.target->full_evaluations();
    posterior_.stopped_early = reporter_.stopped();
    posterior_.wall_seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    return std::move(posterior_);
  }

 private:
  [[nodiscard]] long evaluations() const {
    long sum = 0;
    for (const Runner& runner : runners_) sum += runner.target->evaluations();
    return sum;
  }

  template <typename Job>
  void each_chain(Job&& job) {
    parallel_for(options_.chains, options_.threads,
                 [&](int c) { job(c, runners_[static_cast<std::size_t>(c)]); });
  }

  // Tempering from the prior, every chain on its own.
  void explore() {
    const int scans = options_.warmup > 0
                          ? std::max(60, options_.warmup / (2 * kExplorationRungs * kStepsAScan))
                          : kExplorationScans;
    reporter_.begin("exploring", static_cast<double>(scans) * options_.chains);
    each_chain([&](int c, Runner& runner) {
      runner.target = std::make_unique<Target>(problem_, options_.prior_only);
      const int rungs = options_.moves.tempering ? kExplorationRungs : 1;
      runner.tempered = std::make_unique<TemperedChain>(
          *runner.target, rungs > 1 ? geometric_ladder(rungs) : std::vector<double>{1.0},
          [&] { return exploration_kernels(problem_, options_, atlases_); }, options_.seed, c);
      runner.tempered->start();
      int done = 0;
      for (int round = kFirstScans; done < scans; round *= 2) {
        const int n = std::min(round, scans - done);
        runner.by_rung.assign(static_cast<std::size_t>(runner.tempered->rungs()),
                              PilotSamples(problem_.space));
        runner.explored = 0.0;
        for (int i = 0; i < n; ++i) {
          const long before = runner.target->evaluations();
          runner.tempered->scan(kStepsAScan, true, Purpose::exploration);
          for (int r = 0; r < runner.tempered->rungs(); ++r) {
            runner.by_rung[static_cast<std::size_t>(r)].add(runner.tempered->state(r));
          }
          const State& cold = runner.tempered->cold();
          runner.explored += (runner.target->log_prior(cold) + cold.log_likelihood) / n;
          reporter_.evaluated(runner.target->evaluations() - before);
          if (!reporter_.advance(1.0)) return;
        }
        done += n;
        if (c == 0) posterior_.warmup += n * kStepsAScan;
        // Two neighbours a unit of the barrier (Syed et al. 2022, section 4.3), while there is time
        // left.
        if (runner.tempered->rungs() > 1 && done < scans) {
          runner.tempered->adapt_ladder(std::clamp(
              static_cast<int>(std::ceil(2.0 * runner.tempered->barrier())) + 2, 6, kMaxRungs));
        }
      }
      runner.state = runner.tempered->cold();
    });
    if (reporter_.stopped()) return;
    if (explored_alike()) {
      if (problem_.shortened && start_at(search_modes(problem_, options_, reporter_, 1), true))
        posterior_.notes.push_back(
            "Tempering from the prior missed a mode that a search on growing records found, so the "
            "chains were restarted there.");
    } else if (problem_.shortened && (options_.warmup == 0 || options_.warmup >= kLongWarmup)) {
      if (start_at(growing_populations(problem_, options_, reporter_)))
        posterior_.notes.push_back(
            "After tempering from the prior the chains were in different places, so they were "
            "restarted from samples that had seen the record grow.");
    } else if (start_at(search_modes(problem_, options_, reporter_, options_.chains), false)) {
      posterior_.notes.push_back(
          "After tempering from the prior the chains were in different places, so each of them was "
          "restarted near a mode that differential evolution had found for it.");
    }
    if (reporter_.stopped()) return;
    fit(0, true);
  }

  // Where a long record makes exploring from the prior cost more than it finds.
  void explore_growing() {
    each_chain([&](int, Runner& runner) {
      runner.target = std::make_unique<Target>(problem_, options_.prior_only);
      runner.by_rung.assign(1, PilotSamples(problem_.space));
    });
    const bool started = start_at(climb_with_record(problem_, options_, reporter_), false);
    if (reporter_.stopped()) return;
    if (!started)
      throw LikelihoodError("no model has a mode that a search on growing records finds");
    posterior_.notes.push_back(
        "The record is long, so the chains were started near modes that were found on its first "
        "samples and followed as it grew.");
    fit(0, true);
  }

  [[nodiscard]] bool explored_alike() const {
    const auto [low, high] = std::ranges::minmax_element(runners_, {}, &Runner::explored);
    return high->explored - low->explored < kDisagreement;
  }

  [[nodiscard]] bool missed(int model, const Laplace& mode) {
    Runner& runner = runners_.front();
    State state;
    state.model = model;
    state.z = mode.z;
    runner.target->evaluate(state);
    double explored = -std::numeric_limits<double>::infinity();
    for (const Runner& one : runners_) explored = std::max(explored, one.explored);
    return runner.target->log_prior(state) + state.log_likelihood >
           explored + kDisagreement + static_cast<double>(state.z.size());
  }

  // The samples take the place of the coldest ones, a share of them each chain's. False where there
  // are none.
  bool start_at(Populations found) {
    shared_evaluations_ += found.likelihood_evaluations;
    if (reporter_.stopped() || found.best < 0) return false;
    const ModelSpace& space = problem_.space;
    for (const Eigen::MatrixXd& z : found.z) population_.emplace_back(z.transpose());
    each_chain([&](int c, Runner& runner) {
      PilotSamples& cold = runner.by_rung.back();
      cold = PilotSamples(space);
      for (int m = 0; m < space.size(); ++m) {
        const Eigen::MatrixXd& z = found.z[static_cast<std::size_t>(m)];
        State state;
        state.model = m;
        // Of every replicate some: their rows come one after the other.
        for (Eigen::Index i = c; i < z.rows(); i += options_.chains) {
          state.z.assign(z.row(i).begin(), z.row(i).end());
          cold.add(state);
        }
        if (m != found.best) continue;
        runner.target->evaluate(state);
        runner.state = state;
      }
    });
    return true;
  }

  // The normals about modes take the place of the chains' coldest samples, each searcher's that of
  // its own chains. False where there are none, or where chains have been higher already and
  // `only_missed` is set.
  bool start_at(const Modes& modes, bool only_missed) {
    if (modes.empty() || reporter_.stopped()) return false;
    const ModelSpace& space = problem_.space;
    const int searchers = static_cast<int>(modes.size());
    std::vector<const Laplace*> best(static_cast<std::size_t>(space.size()), nullptr);
    for (const auto& of_chain : modes) {
      for (std::size_t m = 0; m < best.size(); ++m) {
        const Laplace& mode = of_chain[m];
        shared_evaluations_ += mode.evidence.likelihood_evaluations;
        if (std::isfinite(mode.evidence.log_evidence) &&
            (best[m] == nullptr || mode.evidence.log_evidence > best[m]->evidence.log_evidence)) {
          best[m] = &mode;
        }
      }
    }
    int start = -1;
    const auto worth = [&](int m) {
      return best[static_cast<std::size_t>(m)]->evidence.log_evidence + space[m].log_prior;
    };
    for (int m = 0; m < space.size(); ++m) {
      if (best[static_cast<std::size_t>(m)] == nullptr) continue;
      if (start < 0 || worth(m) > worth(start)) start = m;
    }
    if (start < 0 || (only_missed && !missed(start, *best[static_cast<std::size_t>(start)])))
      return false;
    each_chain([&](int c, Runner& runner) {
      Random random(options_.seed, static_cast<std::uint64_t>(c), 0, Purpose::adaptation);
      PilotSamples& cold = runner.by_rung.back();
      cold = PilotSamples(space);
      for (int m = 0; m < space.size(); ++m) {
        const auto at = static_cast<std::size_t>(m);
        if (best[at] == nullptr) continue;
        const Laplace* mode = &modes[static_cast<std::size_t>(c % searchers)][at];
        if (!(mode->evidence.log_evidence > best[at]->evidence.log_evidence - kWorseMode)) {
          mode = best[at];
        }
        const Eigen::MatrixXd factor = Eigen::LLT<Eigen::MatrixXd>(mode->covariance).matrixL();
        State state;
        state.model = m;
        state.z = mode->z;
        Eigen::VectorXd u(factor.rows());
        for (int i = 0; i < kDrawsAMode; ++i) {
          for (double& value : u) value = random.normal();
          const Eigen::VectorXd step = factor * u;
          for (std::size_t j = 0; j < state.z.size(); ++j) {
            state.z[j] = mode->z[j] + step[static_cast<Eigen::Index>(j)];
          }
          cold.add(state);
        }
        if (m != start) continue;
        // The last draw, unless the posterior is no normal and has it in a valley.
        State at_mode = state;
        at_mode.z = mode->z;
        runner.target->evaluate(state);
        runner.target->evaluate(at_mode);
        const auto value = [&](const State& s) {
          return runner.target->log_prior(s) + s.log_likelihood;
        };
        const auto usual = 5.0 + 2.0 * static_cast<double>(state.z.size());
        if (!(value(state) > value(at_mode) - usual)) state = at_mode;
        runner.state = state;
      }
    });
    return true;
  }

  // Pools what the chains have seen and freezes the proposals that follow from it.
  void fit(int round, bool tempered) {
    std::vector<PilotSamples> pooled;
    if (tempered) {
      // Ladders differ between chains: pool by rank from the cold end.
      std::size_t rungs = 0;
      for (const Runner& runner : runners_) rungs = std::max(rungs, runner.by_rung.size());
      pooled.assign(rungs, PilotSamples(problem_.space));
      for (const Runner& runner : runners_) {
        for (std::size_t r = 0; r < runner.by_rung.size(); ++r) {
          pooled[rungs - 1 - r].append(runner.by_rung[runner.by_rung.size() - 1 - r]);
        }
      }
      hot_ = pooled;
    } else {
      pooled = hot_;
      pooled.emplace_back(problem_.space);
      for (const Runner& runner : runners_) pooled.back().append(runner.by_rung.back());
    }
    // The last fit is the one that is used; the first two only have to lead there.
    const bool last = round >= static_cast<int>(kTuning.size());
    pilot_ = fit_pilot(problem_.space, pooled,
                       {.seed = options_.seed,
                        .round = round,
                        .threads = options_.threads,
                        .most_samples = last ? 12000 : 3000,
                        .most_components = population_.empty() ? 20 : kManyPeaks,
                        .besides = population_,
                        .bias = tempered ? std::vector<double>{} : bias_});
  }

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
      if (!reporter_.stopped()) fit(static_cast<int>(round) + 1, false);
    }
    if (!reporter_.stopped() && options_.warmup == 0) {
      const int thin = posterior_.thin;
      const int longest =
          options_.draws > 0 ? std::min(kLongTuning / thin, options_.draws) * thin : kLongTuning;
      if (longest > kTuning.back() && tuned_model_draws() < kEnoughModelDraws) {
        reporter_.begin("tuning on", static_cast<double>(longest) * options_.chains);
        done += tune_once(done, longest);
        if (!reporter_.stopped()) fit(static_cast<int>(kTuning.size()) + 1, false);
      }
    }
    const std::vector<double> none(static_cast<std::size_t>(problem_.space.size()), 0.0);
    for (Runner& runner : runners_) runner.target->set_model_bias(none);
    posterior_.warmup += done;
  }

  int tune_once(int done, int steps) {
    bias_ = equal_visits_bias(*pilot_.fit);
    each_chain([&](int c, Runner& runner) {
      runner.target->set_model_bias(bias_);
      runner.kernels = sampling_kernels(problem_, options_, atlases_, pilot_);
      runner.by_rung.assign(1, PilotSamples(problem_.space));
      runner.models.clear();
      for (int i = 0; i < steps; ++i) {
        Random random(options_.seed, static_cast<std::uint64_t>(c),
                      static_cast<std::uint64_t>(done + i), Purpose::adaptation);
        Kernel::Outcome outcome;
        runner.kernels->step(runner.state, {*runner.target, random, 1.0, true}, outcome);
        runner.by_rung[0].add(runner.state);
        runner.models.push_back(runner.state.model);
        if (i % 64 == 63 && !reporter_.advance(64.0)) return;
      }
    });
    return steps;
  }

  // Effective draws of the least certain model's indicator in the last round of tuning; infinite
  // where one model has all the probability.
  [[nodiscard]] double tuned_model_draws() const {
    double least = std::numeric_limits<double>::infinity();
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

  void sample() {
    posterior_.tempered_draws = options_.tempered_draws;
    prepare_sampling();
    const int first = options_.draws > 0 ? options_.draws : kDefaultDraws;
    reporter_.begin("sampling", static_cast<double>(first) * options_.chains);
    draw(first);
    if (options_.draws == 0) {
      while (!reporter_.stopped() && posterior_.draws < kMaxDraws && !converged()) {
        if (!posterior_.tempered_draws && runners_.front().tempered && options_.moves.tempering &&
            !chains_agree()) {
          restart_tempered();
          continue;
        }
        const int more = std::min(posterior_.draws, kMaxDraws - posterior_.draws);
        reporter_.begin("sampling on", static_cast<double>(more) * options_.chains);
        draw(more);
      }
    }
    collect();
  }

  // Chains that disagree have not seen the same modes: what they drew becomes warm-up, and the
  // ladder stays in use from here on.
  void restart_tempered() {
    posterior_.tempered_draws = true;
    posterior_.notes.push_back(
        "The chains disagreed, so they were restarted with parallel tempering throughout.");
    posterior_.warmup += posterior_.draws * posterior_.thin;
    posterior_.warmup_evaluations = evaluations() + shared_evaluations_;
    posterior_.draws = 0;
    if (options_.thin == 0) posterior_.thin = 1;  // a scan is a step of every rung already
    for (Chain& chain : posterior_.chains) chain = Chain{};
    prepare_sampling();
    reporter_.begin("sampling with tempering",
                    static_cast<double>(kDefaultDraws) * options_.chains);
    draw(kDefaultDraws);
  }

  void prepare_sampling() {
    const auto models = static_cast<std::size_t>(problem_.space.size());
    each_chain([&](int, Runner& runner) {
      const auto make = [&] { return sampling_kernels(problem_, options_, atlases_, pilot_); };
      runner.kernels = make();
      if (posterior_.tempered_draws) runner.tempered->set_kernels(make);
      runner.moves.clear();
      for (int i = 0; i < runner.kernels->size(); ++i) {
        runner.moves.push_back({.name = (*runner.kernels)[i].name()});
      }
      runner.proposed.assign(models, std::vector<long>(models));
      runner.accepted = runner.proposed;
    });
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
      runner.tempered->scan(posterior_.thin, false, Purpose::sampling, observe);
      runner.state = runner.tempered->cold();
      return {move, accepted};
    }
    for (int t = 0; t < posterior_.thin; ++t) {
      Random random(options_.seed, static_cast<std::uint64_t>(c),
                    static_cast<std::uint64_t>(runner.iteration++), Purpose::sampling);
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

  void record(const Runner& runner, Chain& chain, int move, bool accepted) {
    const State& state = runner.state;
    chain.model.push_back(state.model);
    chain.theta.insert(chain.theta.end(), state.x.begin(), state.x.end());
    chain.theta.resize(chain.model.size() * static_cast<std::size_t>(posterior_.dimension),
                       std::numeric_limits<double>::quiet_NaN());
    chain.log_prior.push_back(runner.target->log_prior_physical(state));
    chain.log_likelihood.push_back(state.log_likelihood);
    chain.move.push_back(static_cast<std::int16_t>(move));
    chain.accepted.push_back(accepted ? 1 : 0);
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

  // Good enough to stop: every undecided model probability known to 0.004 and mixed; the log
  // posterior too; and where one model has all the probability, its parameters.
  [[nodiscard]] bool converged() const {
    for (int m = 0; m < problem_.space.size(); ++m) {
      const double p = share(m);
      if (p < 0.001) continue;
      if (p > 0.999 ? !parameters_converged(m) : !probability_converged(m)) return false;
    }
    const Convergence of = convergence(log_posterior());
    return of.rhat < 1.01 && of.ess_bulk > 400.0 && of.ess_tail > 400.0;
  }
  [[nodiscard]] bool probability_converged(int model) const {
    const ChainsOf chains = indicator(model);
    return mcse_mean(chains) <= 0.004 && ess_mean(chains) >= 400.0 && rhat(chains) <= 1.01;
  }
  // A component's slot is a label only: of components, their sums.
  [[nodiscard]] bool parameters_converged(int model) const {
    const Model& m = problem_.space[model];
    const auto width = static_cast<std::size_t>(posterior_.dimension);
    const auto own = static_cast<int>(m.parameters.size());
    const auto mixed = [&](auto&& value) {
      ChainsOf chains;
      std::size_t least = std::numeric_limits<std::size_t>::max();
      for (const Chain& chain : posterior_.chains) {
        std::vector<double>& values = chains.emplace_back();
        for (std::size_t i = 0; i < chain.model.size(); ++i) {
          if (chain.model[i] == model) values.push_back(value(&chain.theta[i * width]));
        }
        least = std::min(least, values.size());
      }
      for (auto& values : chains) values.resize(least);
      return rhat(chains) < 1.01 && ess_bulk(chains) > 400.0;
    };
    for (int i = 0; i < own; ++i) {
      if (!mixed([i](const double* x) { return x[i]; })) return false;
    }
    for (std::size_t j = 0; j < m.counts.size(); ++j) {
      const auto size = static_cast<int>(problem_.space.kinds()[j].parameters.size());
      for (int i = 0; m.counts[j] > 0 && i < size; ++i) {
        const auto sum = [&, i](const double* x) {
          double total = 0.0;
          for (int c = 0; c < m.counts[j]; ++c) total += x[m.offsets[j] + c * size + i];
          return total;
        };
        if (!mixed(sum)) return false;
      }
    }
    return true;
  }

  // Whether longer chains would do: an R-hat far from 1 says that they are in different places.
  [[nodiscard]] bool chains_agree() const {
    for (int m = 0; m < problem_.space.size(); ++m) {
      const double p = share(m);
      if (p > 0.001 && p < 0.999 && !(rhat(indicator(m)) < 1.05)) return false;
    }
    return rhat(log_posterior()) < 1.05;
  }

  void collect() {
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
  std::vector<PilotSamples> hot_;
  std::vector<Eigen::MatrixXd> population_;  ///< of each model, dimension × n; or none
  Pilot pilot_;
  std::vector<double> bias_;  ///< of the last round of tuning
  Posterior posterior_;
  long shared_evaluations_ = 0;  ///< of no chain in particular
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
