#include "inference/evidence/tmcmc.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <ranges>
#include <span>
#include <stdexcept>
#include <string>

#include "base/constants.hpp"
#include "base/number.hpp"
#include "base/parallel.hpp"
#include "base/parcel.hpp"
#include "inference/evidence/approximate_steps.hpp"

namespace wheeltap::inference {
namespace {

constexpr long kStageSamples = 50;  // first length of a growing record

struct Particle {
  std::vector<double> z;
  double log_base = 0.0;     // ln p₀
  double log_gain = 0.0;     // ln factor + ln likelihood
  double approximate = 0.0;  // approximation of log_gain, if the current stage uses it
  [[nodiscard]] bool possible() const { return log_gain > -kInfinity; }
};

struct Weights {
  double log_mean, cov;
};

// ln mean and coefficient of variation of the weights exp(step · gain). For a step of 0, the weight
// is 1 for samples with a positive likelihood, otherwise 0.
Weights weights(const std::vector<Particle>& particles, double step) {
  double top = -kInfinity;
  for (const Particle& p : particles) top = std::max(top, p.log_gain);
  double sum = 0.0, squares = 0.0;
  for (const Particle& p : particles) {
    if (p.log_gain == -kInfinity) continue;
    const double w = std::exp(step * (p.log_gain - top));
    sum += w;
    squares += w * w;
  }
  const auto n = static_cast<double>(particles.size());
  const double mean = sum / n;
  return {step * top + std::log(mean), std::sqrt(std::max(0.0, squares / n / (mean * mean) - 1.0))};
}

class Replicate {
 public:
  Replicate(const Problem& problem, int model, const TmcmcOptions& options, int index, bool growing)
      : problem_(problem),
        model_(model),
        options_(options),
        index_(static_cast<std::uint64_t>(index)),
        to_(open(growing ? kStageSamples : problem.samples)) {}

  // Returns ln Z; NaN if the run was stopped or did not reach β = 1.
  double run() {
    double log_evidence = draw_prior();
    log_evidence += anneal();
    while (to_->samples() < problem_.samples && !ended()) {
      lengthen();
      log_evidence += anneal();
    }
    return ended() ? std::numeric_limits<double>::quiet_NaN() : log_evidence;
  }

  [[nodiscard]] const std::vector<Particle>& particles() const { return particles_; }
  [[nodiscard]] int stages() const { return stages_; }
  [[nodiscard]] long evaluations() const {
    return before_ + to_->posterior.evaluations() + (from_ ? from_->posterior.evaluations() : 0);
  }
  [[nodiscard]] bool sluggish() const { return sluggish_; }
  [[nodiscard]] bool cut() const { return cut_; }
  [[nodiscard]] long screened() const { return screened_; }
  // Exponent at the maximum number of stages; NaN if β = 1 was reached.
  [[nodiscard]] double stalled_at() const { return stalled_at_; }

 private:
  static constexpr int kMostStages = 1000, kMostSweeps = 30;
  // Required number of draws with a positive likelihood, and largest number of prior draws.
  static constexpr std::size_t kLeastPossible = 20, kMostDraws = 100'000;
  static constexpr long kLeastGrowth = 10;
  static constexpr std::size_t kBatch = 32;  // likelihoods per batch: a few vectors full
  // Largest standard deviation of the error of the approximation, times β, for screened moves, and
  // number of steps of such a move: in many dimensions, each step moves less.
  static constexpr double kScreenError = 1.5;
  [[nodiscard]] int screen_steps() const { return std::max(5, to_->posterior.dimension() / 6); }

  [[nodiscard]] base::Random stream(std::uint64_t stage) const {
    // The high bit separates these streams from other streams of this purpose.
    return {options_.seed, index_ | (std::uint64_t{1} << 63U),
            stage << 32U | static_cast<std::uint64_t>(model_), base::Purpose::evidence};
  }

  // The posterior given the first samples of a record.
  struct Record {
    Record(std::shared_ptr<const Problem> own, const Problem& problem, int model)
        : kept(std::move(own)), posterior(problem, model), length(problem.samples) {}
    [[nodiscard]] long samples() const { return length; }

    std::shared_ptr<const Problem> kept;  // null: the caller's problem
    ModelPosterior posterior;
    long length;
  };

  [[nodiscard]] std::unique_ptr<Record> open(long samples) const {
    if (samples == problem_.samples)
      return std::make_unique<Record>(std::shared_ptr<const Problem>(), problem_, model_);
    std::shared_ptr<const Problem> part = problem_.shortened(samples);
    const Problem& problem = *part;
    return std::make_unique<Record>(std::move(part), problem, model_);
  }

  [[nodiscard]] bool is_to_stop() const { return stopped_ || (options_.stop && options_.stop()); }
  [[nodiscard]] bool ended() const { return stopped_ || cut_ || !std::isnan(stalled_at_); }
  [[nodiscard]] bool spent() const {
    return options_.most_evaluations > 0 &&
           evaluations() >= options_.most_evaluations / options_.replicates;
  }

  // Draws the initial samples from the prior. Returns ln of the share of draws with a positive
  // likelihood (hits). If the first `samples` draws have fewer than kLeastPossible hits, drawing
  // continues up to r = kLeastPossible hits in N draws. The estimate is then (r - 1)/(N - 1),
  // otherwise hits / N. Both estimates are unbiased for this stopping rule (Girshick, Mosteller &
  // Savage 1946, Annals of Mathematical Statistics 17:13, theorem 5).
  double draw_prior() {
    base::Random random = stream(0);
    const auto first = static_cast<std::size_t>(options_.samples);
    std::vector<Particle> possible;
    std::size_t drawn = 0;
    const auto enough = [&] { return drawn >= first && possible.size() >= kLeastPossible; };
    for (std::size_t batch = first; drawn < kMostDraws && !enough(); batch = kBatch) {
      particles_.assign(batch, {});
      for (Particle& p : particles_) {
        p.z.resize(static_cast<std::size_t>(to_->posterior.dimension()));
        to_->posterior.draw_prior(random, p.z);
      }
      evaluate();
      if (stopped_) return 0.0;
      for (Particle& p : particles_) {
        if (enough()) break;
        ++drawn;
        if (p.possible()) possible.push_back(std::move(p));
      }
    }
    if (possible.empty())
      throw LikelihoodError("model '" + to_->posterior.name() +
                            "': the likelihood is zero at every one of " + std::to_string(drawn) +
                            " draws from the prior");
    particles_ = std::move(possible);
    const double known = drawn > first && particles_.size() == kLeastPossible ? 1.0 : 0.0;
    return std::log((static_cast<double>(particles_.size()) - known) /
                    (static_cast<double>(drawn) - known));
  }

  // Moves from the posterior of the current record to that of twice as many samples, or of fewer if
  // the new samples are very informative. The posterior can then be irregular, because the response
  // loses its dependence on the parameters.
  void lengthen() {
    if (from_) before_ += from_->posterior.evaluations();
    from_ = std::move(to_);
    const long n = from_->samples();
    for (long step = std::min(n, problem_.samples - n);; step /= 2) {
      to_ = open(n + step);
      evaluate();
      if (stopped_) return;
      if (step <= n / kLeastGrowth + 1 || weights(particles_, 1.0).cov <= options_.weight_cov)
        return;
      before_ += to_->posterior.evaluations();
    }
  }

  // Moves from β = 0 (`from_` or the prior) to β = 1 (`to_`). Returns ln of the ratio of the two
  // evidences.
  double anneal() {
    bool possible = particles_.size() == static_cast<std::size_t>(options_.samples) &&
                    std::ranges::all_of(particles_, &Particle::possible);
    double log_ratio = 0.0;
    for (double beta = 0.0; beta < 1.0 && !ended();) {
      // The first stage makes `samples` particles of those that are possible.
      cut_ = spent() && particles_.size() == static_cast<std::size_t>(options_.samples);
      if (cut_) break;
      if (++stages_ > kMostStages) {
        stalled_at_ = beta;
        break;
      }
      const double step = possible ? next_step(1.0 - beta) : 0.0;
      possible = true;
      log_ratio += weights(particles_, step).log_mean;
      beta = beta + step >= 1.0 - 1e-12 ? 1.0 : beta + step;
      base::Random stage = stream(static_cast<std::uint64_t>(stages_));
      resample(step, stage);
      move(beta, stage);
      report(beta);
    }
    return log_ratio;
  }

  // Reports the completed share of the path, or of the samples if the data enter in parts.
  void report(double beta) {
    if (!options_.progress) return;
    const double whole = std::max(1.0, static_cast<double>(problem_.samples));
    const double from = from_ ? static_cast<double>(from_->samples()) : 0.0;
    const double to = std::max(1.0, static_cast<double>(to_->samples()));
    const double done = (from + beta * (to - from)) / whole;
    stopped_ = !options_.progress((done - reported_) / options_.replicates) || is_to_stop();
    reported_ = done;
  }

  void evaluate() {
    std::vector<double> zs;
    for (const Particle& p : particles_) zs.insert(zs.end(), p.z.begin(), p.z.end());
    std::vector<ModelPosterior::Value> values(particles_.size());
    const auto d = static_cast<std::size_t>(to_->posterior.dimension());
    for (std::size_t i = 0; i < values.size(); i += kBatch) {
      const std::size_t n = std::min(kBatch, values.size() - i);
      if ((stopped_ = is_to_stop())) return;
      evaluate(std::span<const double>(zs).subspan(i * d, n * d), std::span(values).subspan(i, n));
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
      particles_[i].log_base = values[i].log_base;
      particles_[i].log_gain = values[i].log_gain;
    }
  }

  // log_base belongs to the initial distribution, log_gain to the tempered factor.
  void evaluate(std::span<const double> zs, std::span<ModelPosterior::Value> out) {
    to_->posterior.evaluate(zs, out);
    if (!from_) return;
    shorter_.resize(out.size());
    from_->posterior.evaluate(zs, shorter_);
    for (std::size_t i = 0; i < out.size(); ++i) {
      if (out[i].log_gain == -kInfinity) continue;
      const double before = shorter_[i].log_gain;
      out[i].log_gain = before == -kInfinity ? -kInfinity : out[i].log_gain - before;
      out[i].log_base += before;
    }
  }

  // Finds by bisection the step whose weights have the required coefficient of variation.
  [[nodiscard]] double next_step(double rest) const {
    if (weights(particles_, rest).cov <= options_.weight_cov) return rest;
    double low = 0.0, high = rest;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (weights(particles_, middle).cov > options_.weight_cov ? high : low) = middle;
    }
    return high;
  }

  // Systematic resampling: equally spaced pointers with one uniform random offset.
  void resample(double step, base::Random& random) {
    double top = -kInfinity;
    for (const Particle& p : particles_) top = std::max(top, p.log_gain);
    std::vector<double> cumulative;
    double sum = 0.0;
    for (const Particle& p : particles_)
      cumulative.push_back(sum +=
                           p.log_gain == -kInfinity ? 0.0 : std::exp(step * (p.log_gain - top)));
    std::vector<Particle> next;
    const double n = options_.samples, u = random.uniform();
    std::size_t from = 0;
    for (int i = 0; i < options_.samples; ++i) {
      const double pointer = (i + u) / n * sum;
      while (from + 1 < cumulative.size() && cumulative[from] <= pointer) ++from;
      next.push_back(particles_[from]);
    }
    particles_ = std::move(next);
  }

  // A mixture fitted to one half of the samples moves the other half. A proposal fitted to the
  // samples that it moves tends to keep them, which biases ln Z.
  void move(double beta, base::Random& random) {
    const auto middle = static_cast<std::ptrdiff_t>(particles_.size() / 2);
    const std::span<Particle> first(particles_.begin(), particles_.begin() + middle);
    const std::span<Particle> second(particles_.begin() + middle, particles_.end());
    const NormalMixture of_first = fit(first, random), of_second = fit(second, random);
    const double for_first = scale_of_screen(second, beta);
    const double for_second = scale_of_screen(first, beta);
    for_first > 0.0 ? move_screened(first, of_second, beta, for_first, random)
                    : move(first, of_second, beta, random);
    for_second > 0.0 ? move_screened(second, of_first, beta, for_second, random)
                     : move(second, of_first, beta, random);
  }

  // The factor c in [0, 1] with which c · approximation predicts the log_gain of these samples
  // best, up to a constant; 0 if the errors are too large.
  [[nodiscard]] double scale_of_screen(std::span<const Particle> particles, double beta) const {
    if (!options_.approximation || from_) return 0.0;
    const auto n = static_cast<Eigen::Index>(particles.size());
    Eigen::VectorXd gains(n), screens(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Particle& p = particles[static_cast<std::size_t>(i)];
      gains[i] = beta * p.log_gain;
      screens[i] = beta * options_.approximation(p.z);
    }
    gains.array() -= gains.mean();
    screens.array() -= screens.mean();
    const double square = screens.squaredNorm();
    if (!(square > 0.0)) return 0.0;
    const double scale = std::clamp(gains.dot(screens) / square, 0.0, 1.0);
    const double error = (gains - scale * screens).norm() / std::sqrt(static_cast<double>(n));
    return error < kScreenError ? scale : 0.0;
  }

  NormalMixture fit(std::span<const Particle> particles, base::Random& random) const {
    const int d = to_->posterior.dimension();
    Eigen::MatrixXd states(static_cast<Eigen::Index>(particles.size()), d);
    for (Eigen::Index i = 0; i < states.rows(); ++i)
      states.row(i) =
          Eigen::Map<const Eigen::RowVectorXd>(particles[static_cast<std::size_t>(i)].z.data(), d);
    NormalMixture::FitOptions options;
    options.max_components = 8;
    options.defensive_weight = 0.05;
    return NormalMixture::fit(states, options, random);
  }

  [[nodiscard]] SweepProposal proposal(const NormalMixture& mixture, int sweep) const {
    using Kind = SweepProposal::Kind;
    constexpr std::array kKinds = {Kind::renewal, Kind::walk, Kind::contraction};
    const Kind kind = kKinds[static_cast<std::size_t>(sweep) % kKinds.size()];
    const double log_scale = kind == Kind::contraction ? log_contraction_ : log_scale_;
    return {.mixture = mixture, .kind = kind, .scale = std::exp(log_scale)};
  }

  // Adapts the scale of one kind of proposals to an acceptance rate of 0.3.
  void adapt(SweepProposal::Kind kind, double rate) {
    const double change = 2.0 * (rate - 0.3);
    if (kind == SweepProposal::Kind::walk) log_scale_ = std::clamp(log_scale_ + change, -6.0, 2.0);
    if (kind == SweepProposal::Kind::contraction)
      log_contraction_ = std::clamp(log_contraction_ + change, -6.0, 0.0);
  }

  // Moves as the next function, with proposals that pass the approximation times `scale`. Several
  // accepted steps of a walk count as several moves; several renewals count as one.
  void move_screened(std::span<Particle> particles, const NormalMixture& mixture, double beta,
                     double scale, base::Random& random) {
    ++screened_;
    for (Particle& p : particles) p.approximate = options_.approximation(p.z);
    const auto n = static_cast<double>(particles.size());
    std::vector<double> proposals;
    std::vector<Particle> ends;
    std::vector<std::size_t> places;
    std::vector<int> counts;
    std::vector<ModelPosterior::Value> values;
    double moved = 0.0;
    // A screened move leads farther than a plain move: each evaluation makes `many` steps.
    const int many = screen_steps();
    const double least = 0.1 * many * options_.acceptances * n;
    for (int sweep = 0; moved < least && sweep < kMostSweeps; ++sweep) {
      const SweepProposal propose = proposal(mixture, sweep);
      double steps = 0.0;
      for (std::size_t begin = 0; begin < particles.size(); begin += kBatch) {
        if ((stopped_ = is_to_stop())) return;
        const auto batch = particles.subspan(begin, std::min(kBatch, particles.size() - begin));
        ends.clear();
        places.clear();
        counts.clear();
        proposals.clear();
        for (std::size_t k = 0; k < batch.size(); ++k) {
          Particle end = batch[k];
          const int count = step_by_approximation(options_.approximation, beta * scale, propose,
                                                  many, random, end.z, end.approximate);
          steps += count;
          if (count == 0) continue;
          proposals.insert(proposals.end(), end.z.begin(), end.z.end());
          ends.push_back(std::move(end));
          places.push_back(k);
          counts.push_back(count);
        }
        if (ends.empty()) continue;
        values.assign(ends.size(), {});
        evaluate(proposals, values);
        for (std::size_t i = 0; i < ends.size(); ++i) {
          Particle& p = batch[places[i]];
          const double log_second = beta * (values[i].log_gain - p.log_gain -
                                            scale * (ends[i].approximate - p.approximate));
          if (!(std::log(random.uniform()) < log_second)) continue;
          p = std::move(ends[i]);
          p.log_base = values[i].log_base;
          p.log_gain = values[i].log_gain;
          moved += propose.kind == SweepProposal::Kind::renewal ? 1.0 : counts[i];
        }
      }
      adapt(propose.kind, steps / (many * n));
    }
    sluggish_ = sluggish_ || moved < 0.5 * least;
  }

  void move(std::span<Particle> particles, const NormalMixture& mixture, double beta,
            base::Random& random) {
    const int d = to_->posterior.dimension();
    const auto n = static_cast<double>(particles.size());
    std::vector<double> normal(static_cast<std::size_t>(d));
    std::vector<double> proposals(kBatch * static_cast<std::size_t>(d));
    std::vector<double> levels(kBatch);  // lower limits of log_base + beta log_gain
    std::vector<ModelPosterior::Value> values(kBatch);
    double moved = 0.0;
    const double least = (from_ ? 0.5 : 1.0) * options_.acceptances * n;
    for (int sweep = 0; moved < least && sweep < kMostSweeps && !stopped_; ++sweep) {
      const SweepProposal propose = proposal(mixture, sweep);
      double accepted = 0.0;
      for (std::size_t begin = 0; begin < particles.size(); begin += kBatch) {
        if ((stopped_ = is_to_stop())) return;
        const auto batch = particles.subspan(begin, std::min(kBatch, particles.size() - begin));
        for (std::size_t k = 0; k < batch.size(); ++k) {
          const Particle& p = batch[k];
          const std::span<double> to(proposals.data() + k * normal.size(), normal.size());
          const double log_ratio = propose(p.z, random, normal, to);
          levels[k] = std::log(random.uniform()) - log_ratio + p.log_base + beta * p.log_gain;
        }
        const std::span<ModelPosterior::Value> found(values.data(), batch.size());
        evaluate({proposals.data(), batch.size() * normal.size()}, found);
        for (std::size_t k = 0; k < batch.size(); ++k) {
          if (found[k].log_gain == -kInfinity) continue;
          if (found[k].log_base + beta * found[k].log_gain > levels[k]) {
            Particle& p = batch[k];
            std::copy_n(proposals.begin() + static_cast<std::ptrdiff_t>(k * normal.size()), d,
                        p.z.begin());
            p.log_base = found[k].log_base;
            p.log_gain = found[k].log_gain;
            accepted += 1.0;
          }
        }
      }
      moved += accepted;
      adapt(propose.kind, accepted / n);
    }
    sluggish_ = sluggish_ || moved < 0.5 * least;
  }

  const Problem& problem_;
  int model_;
  const TmcmcOptions& options_;
  std::uint64_t index_;
  long screened_ = 0;
  std::unique_ptr<Record> from_;  // null: the prior
  std::unique_ptr<Record> to_;
  long before_ = 0;  // likelihood evaluations of earlier records
  std::vector<ModelPosterior::Value> shorter_;
  std::vector<Particle> particles_;
  double log_scale_ = 0.0;  // for walks
  double log_contraction_ = 0.0;
  int stages_ = 0;
  bool sluggish_ = false;
  double reported_ = 0.0;
  bool stopped_ = false;
  bool cut_ = false;
  // Exponent β at which the run stalled; NaN if the run reached β = 1.
  double stalled_at_ = std::numeric_limits<double>::quiet_NaN();
};

// True if the data should enter in parts. If a model cannot explain the data, its best fit to the
// first samples may be far from its best fit to all samples, which the draws then do not reach.
bool better_growing(const Problem& problem, int model, const TmcmcOptions& options,
                    long& evaluations) {
  constexpr int kPilots = 2;  // number of pilot runs with each path
  constexpr double kClearly = 3.0;
  if (!problem.shortened || problem.samples <= 2 * kStageSamples) return false;
  if (options.path != TmcmcPath::better) return options.path == TmcmcPath::growing;
  TmcmcOptions pilot = options;
  pilot.samples = std::min(options.samples, 200);
  pilot.acceptances = 0.25 * options.acceptances;
  if (options.progress) pilot.progress = [&](double) { return options.progress(0.0); };
  std::vector<double> log_evidence(2 * kPilots);
  std::vector<long> cost(2 * kPilots);
  base::parallel_for(
      2 * kPilots, options.threads,
      [&](int i) {
        Replicate replicate(problem, model, pilot, options.replicates + i, i < kPilots);
        const double found = replicate.run();
        log_evidence[static_cast<std::size_t>(i)] = std::isnan(found) ? -kInfinity : found;
        cost[static_cast<std::size_t>(i)] = replicate.evaluations();
      },
      base::carriage([&](int i, auto& parcel) {
        parcel(log_evidence[static_cast<std::size_t>(i)], cost[static_cast<std::size_t>(i)]);
      }));
  for (const long c : cost) evaluations += c;
  return std::max(log_evidence[0], log_evidence[1]) >
         std::max(log_evidence[2], log_evidence[3]) - kClearly;
}

}  // namespace

Tmcmc tmcmc(const Problem& problem, int model, const TmcmcOptions& asked) {
  std::mutex progress_mutex;
  TmcmcOptions options = asked;
  if (asked.progress) {
    options.progress = [&](double share) {
      const std::scoped_lock lock(progress_mutex);
      return asked.progress(share);
    };
  }
  const auto require = [](bool fine, const char* name, double value, const char* bound) {
    if (!fine)
      throw std::invalid_argument(std::string("tmcmc: ") + name + " = " + std::to_string(value) +
                                  ", must be " + bound);
  };
  require(options.replicates >= 4, "replicates", options.replicates, ">= 4");
  require(options.samples >= 20, "samples", options.samples, ">= 20");
  require(options.weight_cov > 0.0, "weight_cov", options.weight_cov, "> 0");
  require(options.acceptances > 0.0, "acceptances", options.acceptances, "> 0");
  require(options.most_evaluations >= 0, "most_evaluations",
          static_cast<double>(options.most_evaluations), ">= 0");

  Tmcmc result;
  ModelPosterior posterior(problem, model);
  if (posterior.dimension() == 0) {
    result.evidence.log_evidence = posterior({}).log_gain;
    result.evidence.likelihood_evaluations = posterior.evaluations();
    return result;
  }
  const auto r = static_cast<std::size_t>(options.replicates);
  std::vector<double> log_evidence(r);
  std::vector<long> evaluations(r);
  std::vector<int> stages(r);
  std::vector<long> screened(r);
  std::vector<char> sluggish(r), cut(r);
  std::vector<double> stalled(r);
  const bool growing =
      better_growing(problem, model, options, result.evidence.likelihood_evaluations);
  result.z.resize(static_cast<Eigen::Index>(r) * options.samples, posterior.dimension());
  result.z.setZero();
  result.log_posterior.assign(static_cast<std::size_t>(result.z.rows()), -kInfinity);
  base::parallel_for(
      options.replicates, options.threads,
      [&](int index) {
        const auto i = static_cast<std::size_t>(index);
        Replicate replicate(problem, model, options, index, growing);
        log_evidence[i] = replicate.run();
        evaluations[i] = replicate.evaluations();
        stages[i] = replicate.stages();
        screened[i] = replicate.screened();
        sluggish[i] = replicate.sluggish() ? 1 : 0;
        stalled[i] = replicate.stalled_at();
        cut[i] = replicate.cut() ? 1 : 0;
        if (std::isnan(log_evidence[i]) && !replicate.cut()) return;
        Eigen::Index row = static_cast<Eigen::Index>(index) * options.samples;
        for (const Particle& p : replicate.particles()) {
          result.log_posterior[static_cast<std::size_t>(row)] = p.log_base + p.log_gain;
          result.z.row(row++) =
              Eigen::Map<const Eigen::RowVectorXd>(p.z.data(), posterior.dimension());
        }
      },
      base::carriage([&](int index, auto& parcel) {
        const auto i = static_cast<std::size_t>(index);
        parcel(log_evidence[i], evaluations[i], stages[i], screened[i], sluggish[i], stalled[i],
               cut[i]);
        const Eigen::Index first = static_cast<Eigen::Index>(index) * options.samples;
        for (Eigen::Index row = first; row < first + options.samples; ++row) {
          parcel(result.log_posterior[static_cast<std::size_t>(row)]);
          for (Eigen::Index j = 0; j < result.z.cols(); ++j) parcel(result.z(row, j));
        }
      }));

  Evidence& evidence = result.evidence;
  for (const long e : evaluations) evidence.likelihood_evaluations += e;
  result.stages = std::ranges::max(stages);
  for (const long n : screened) result.screened += n;
  if (std::ranges::any_of(log_evidence, [](double l) { return std::isnan(l); })) {
    evidence.log_evidence = evidence.standard_error = std::numeric_limits<double>::quiet_NaN();
    const auto is_number = [](double x) { return !std::isnan(x); };
    if (const auto first = std::ranges::find_if(stalled, is_number); first != stalled.end())
      evidence.warnings.push_back({.kind = EvidenceWarning::Kind::stalled, .value = *first});
    result.cut = std::ranges::all_of(std::views::iota(std::size_t{0}, r), [&](std::size_t i) {
      return cut[i] != 0 || is_number(log_evidence[i]);
    });
    if (!result.cut) result.z.resize(0, posterior.dimension());
    result.log_posterior.clear();
    return result;
  }

  const double n = options.replicates;
  const double top = std::ranges::max(log_evidence);
  double mean = 0.0, squares = 0.0;
  for (const double l : log_evidence) mean += std::exp(l - top) / n;
  for (const double l : log_evidence) {
    const double e = std::exp(l - top) / mean - 1.0;
    squares += e * e;
  }
  evidence.log_evidence = top + std::log(mean);
  evidence.standard_error = std::sqrt(squares / (n - 1.0) / n * (n - 1.0) / (n - 3.0));
  if (squares / (n - 1.0) > 0.25)
    evidence.warnings.push_back({.kind = EvidenceWarning::Kind::replicates_scatter,
                                 .value = std::sqrt(squares / (n - 1.0))});
  if (std::ranges::any_of(sluggish, [](char s) { return s != 0; }))
    evidence.warnings.push_back({.kind = EvidenceWarning::Kind::samples_hardly_move});
  return result;
}

}  // namespace wheeltap::inference
