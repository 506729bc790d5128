#include "inference/evidence/metropolis.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "base/eigen_solvers.hpp"
#include "base/parallel.hpp"
#include "base/parcel.hpp"
#include "inference/statistics/diagnostics.hpp"

namespace wheeltap::inference {
namespace {

std::span<const double> view(const Eigen::VectorXd& z) {
  return {z.data(), static_cast<std::size_t>(z.size())};
}
std::span<double> view(Eigen::VectorXd& z) {
  return {z.data(), static_cast<std::size_t>(z.size())};
}

class Walker {
 public:
  Walker(const Problem& problem, int model, const NormalMixture* pilot, std::uint64_t seed,
         std::uint64_t chain)
      : posterior_(problem, model),
        pilot_(pilot),
        random_(seed, chain, static_cast<std::uint64_t>(model), base::Purpose::evidence),
        d_(posterior_.dimension()),
        factor_(2.38 / std::sqrt(std::max(1.0, static_cast<double>(d_))) *
                Eigen::MatrixXd::Identity(d_, d_)) {
    start();
  }

  // Makes one step; with a pilot, every second step is a draw from the pilot.
  bool step(int iteration, bool adapt) {
    return pilot_ != nullptr && iteration % 2 == 1 ? renew() : walk(adapt ? iteration : -1);
  }

  ModelPosterior& posterior() { return posterior_; }
  [[nodiscard]] const Eigen::VectorXd& z() const { return z_; }
  [[nodiscard]] const Eigen::VectorXd& x() const { return x_; }
  [[nodiscard]] const ModelPosterior::Value& value() const { return value_; }

 private:
  static constexpr double kSmallestLogRate = -7.0;  // lower limit of log α in adaptation: α = 1e-3

  void start() {
    // Starts at the best of kGood draws with a positive likelihood, or at the first after kTries.
    constexpr int kGood = 50, kTries = 2000, kMostTries = 100'000;
    Eigen::VectorXd z(d_);
    int good = 0;
    for (int i = 0; i < kMostTries && good < (i < kTries ? kGood : 1); ++i) {
      if (pilot_ != nullptr) {
        pilot_->sample(random_, view(z));
      } else {
        posterior_.draw_prior(random_, view(z));
      }
      const ModelPosterior::Value value = posterior_(view(z));
      if (value.log_posterior() == -std::numeric_limits<double>::infinity()) continue;
      if (good++ == 0 || value.log_posterior() > value_.log_posterior()) accept(z, value);
      if (pilot_ != nullptr) break;  // pilot draws need no selection
    }
    if (good == 0)
      throw LikelihoodError(
          "model '" + posterior_.name() + "': the likelihood is zero at every one of " +
          std::to_string(kMostTries) +
          (pilot_ != nullptr ? " draws from the pilot" : " draws from the prior"));
  }

  void accept(const Eigen::VectorXd& z, const ModelPosterior::Value& value) {
    z_ = z;
    x_ = Eigen::Map<const Eigen::VectorXd>(posterior_.x().data(), d_);
    value_ = value;
  }

  // Makes a random-walk step; for negative iterations, without adaptation.
  bool walk(int iteration) {
    Eigen::VectorXd u(d_);
    for (double& v : u) v = random_.normal();
    // With a pilot, the step has the covariance of a random component of the pilot. The component
    // is independent of the state, so the step remains symmetric.
    const Eigen::MatrixXd& factor =
        pilot_ != nullptr ? (*pilot_)[pilot_->sample_component(random_)].factor : factor_;
    const Eigen::VectorXd to = z_ + std::exp(log_scale_) * (factor * u);
    const double log_u = std::log(random_.uniform());
    const ModelPosterior::Value value =
        posterior_.above(value_.log_posterior() + std::min(log_u, kSmallestLogRate), 1.0, view(to));
    const double ratio = value.log_posterior() - value_.log_posterior();
    const bool accepted = log_u < ratio;
    if (iteration >= 0) adapt(iteration, std::min(1.0, std::exp(ratio)), u);
    if (accepted) accept(to, value);
    return accepted;
  }

  void adapt(int iteration, double rate, const Eigen::VectorXd& u) {
    const double target = d_ == 1 ? 0.44 : 0.234;
    const double gain =
        std::min(1.0, static_cast<double>(d_) * std::pow(iteration + 1.0, -2.0 / 3.0));
    if (pilot_ != nullptr) {
      log_scale_ += gain * (rate - target);
      return;
    }
    // S' S'ᵀ = S (I + η (α - α*) u uᵀ / |u|²) Sᵀ
    const Eigen::MatrixXd next = factor_ *
                                 (Eigen::MatrixXd::Identity(d_, d_) +
                                  gain * (rate - target) / u.squaredNorm() * u * u.transpose()) *
                                 factor_.transpose();
    const Eigen::LLT<Eigen::MatrixXd> llt(next);
    if (llt.info() == Eigen::Success) factor_ = llt.matrixL();
  }

  bool renew() {
    Eigen::VectorXd to(d_);
    pilot_->sample(random_, view(to));
    const double log_u = std::log(random_.uniform());
    const double proposals = pilot_->log_density(view(z_)) - pilot_->log_density(view(to));
    const ModelPosterior::Value value =
        posterior_.above(value_.log_posterior() + log_u - proposals, 1.0, view(to));
    const double ratio = value.log_posterior() - value_.log_posterior() + proposals;
    const bool accepted = log_u < ratio;
    if (accepted) accept(to, value);
    return accepted;
  }

  ModelPosterior posterior_;
  const NormalMixture* pilot_;
  base::Random random_;
  Eigen::Index d_;
  Eigen::MatrixXd factor_;
  double log_scale_ = 0.0;
  Eigen::VectorXd z_, x_;
  ModelPosterior::Value value_;
};

ModelSamples run(const Problem& problem, int model, const NormalMixture* pilot,
                 const MetropolisOptions& options) {
  const auto require = [](bool fine, const char* name, int value, const char* bound) {
    if (!fine)
      throw std::invalid_argument(std::string("metropolis: ") + name + " = " +
                                  std::to_string(value) + ", must be " + bound);
  };
  require(options.chains >= 1, "chains", options.chains, ">= 1");
  require(options.warmup >= 0, "warmup", options.warmup, ">= 0");
  require(options.draws >= 4, "draws", options.draws, ">= 4");
  const auto chains = static_cast<std::size_t>(options.chains);
  const Eigen::Index d = ModelPosterior(problem, model).dimension();
  require(d >= 1, "dimension of the model", static_cast<int>(d), ">= 1");
  ModelSamples samples{std::vector<Eigen::MatrixXd>(chains, Eigen::MatrixXd(options.draws, d)),
                       std::vector<Eigen::MatrixXd>(chains, Eigen::MatrixXd(options.draws, d)),
                       ChainsOf(chains),
                       ChainsOf(chains),
                       0.0,
                       1.0,
                       0,
                       {}};
  std::vector<long> accepted(chains, 0), evaluations(chains, 0);
  base::parallel_for(
      options.chains, options.threads,
      [&](int chain) {
        const auto c = static_cast<std::size_t>(chain);
        Walker walker(problem, model, pilot, options.seed, c);
        for (int i = 0; i < options.warmup; ++i) walker.step(i, true);
        for (int i = 0; i < options.draws; ++i) {
          accepted[c] += walker.step(i, false) ? 1 : 0;
          samples.z[c].row(i) = walker.z().transpose();
          samples.x[c].row(i) = walker.x().transpose();
          samples.log_posterior[c].push_back(walker.value().log_posterior());
          samples.log_likelihood[c].push_back(walker.value().log_likelihood);
        }
        evaluations[c] = walker.posterior().evaluations();
      },
      base::carriage([&](int chain, auto& parcel) {
        const auto c = static_cast<std::size_t>(chain);
        parcel(samples.z[c], samples.x[c], samples.log_posterior[c], samples.log_likelihood[c],
               accepted[c], evaluations[c]);
      }));
  for (std::size_t c = 0; c < chains; ++c) {
    samples.acceptance += static_cast<double>(accepted[c]) / (options.chains * 1.0 * options.draws);
    samples.likelihood_evaluations += evaluations[c];
  }
  samples.rhat = rhat(samples.log_posterior);
  for (Eigen::Index j = 0; j < d; ++j) {
    ChainsOf of;
    for (const Eigen::MatrixXd& z : samples.z) of.emplace_back(z.col(j).begin(), z.col(j).end());
    samples.rhat = std::max(samples.rhat, rhat(of));
  }
  if (!(samples.rhat < 1.05))
    samples.warnings.push_back(
        {.kind = EvidenceWarning::Kind::chains_disagree, .value = samples.rhat});
  return samples;
}

}  // namespace

ModelSamples metropolis(const Problem& problem, int model, const MetropolisOptions& options) {
  return run(problem, model, nullptr, options);
}

ModelSamples metropolis(const Problem& problem, int model, const NormalMixture& pilot,
                        const MetropolisOptions& options) {
  return run(problem, model, &pilot, options);
}

}  // namespace wheeltap::inference
