#include "inference/tempering.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace wheeltap::inference {

namespace {
constexpr long kMaxRungs = 1 << 10;  // streams of one scan
// Draws from the prior before giving up: a feasible region of 1e-4 of the prior is missed with a
// probability of e^-10, and a likelihood that is zero mostly says so cheaply.
constexpr int kTries = 100'000;
constexpr int kTriesOfRecord = 5000;  // of a long record, after the first by its first samples
constexpr int kTriesOfWhole = 200;
constexpr long kGlance = 50;
constexpr int kFirstOfCheck = 1000;   // streams of the check, behind those of the rungs
constexpr double kFirstScans = 60.0;  // t₀: of full gain in learning weights
}  // namespace

std::vector<double> geometric_ladder(int rungs) {
  std::vector<double> betas(static_cast<std::size_t>(rungs), 0.0);
  for (int i = 1; i < rungs; ++i) {
    betas[static_cast<std::size_t>(i)] =
        std::pow(10.0, -5.0 * (1.0 - static_cast<double>(i - 1) / (rungs - 2)));
  }
  betas.back() = 1.0;
  return betas;
}

State start_from_prior(Target& target, base::Random& random) {
  State state;
  for (int i = 0; i < kTries; ++i) {
    target.draw_prior(random, state);
    target.evaluate(state);
    if (std::isfinite(state.log_likelihood)) return state;
  }
  throw LikelihoodError("the likelihood is zero at every one of " + std::to_string(kTries) +
                        " points drawn from the prior");
}

void check_models(Target& target, std::uint64_t seed) {
  std::shared_ptr<const Problem> part;
  std::unique_ptr<Target> glance;
  if (target.problem().shortened && target.problem().samples > kGlance) {
    part = target.problem().shortened(kGlance);
    glance = std::make_unique<Target>(*part, false);
  }
  for (int m = 0; m < target.space().size(); ++m) {
    if (!std::isfinite(target.space()[m].log_prior)) continue;
    // A long record's first samples tell what is impossible for less; they must not say so alone.
    const int tries = glance ? kTriesOfRecord : kTries;
    State state;
    bool finite = false;
    for (int i = 0; i < tries && !finite; ++i) {
      base::Random random(seed, static_cast<std::uint64_t>(m),
                          static_cast<std::uint64_t>(kFirstOfCheck + i), base::Purpose::start);
      target.draw_prior(m, random, state);
      if (glance && i >= kTriesOfWhole) {
        State first = state;
        glance->evaluate(first);
        if (!std::isfinite(first.log_likelihood)) continue;
      }
      target.evaluate(state);
      finite = std::isfinite(state.log_likelihood);
      if (state.z.empty()) break;
    }
    if (!finite) {
      std::string parameters;
      for (int i = 0; i < target.space()[m].dimension; ++i) {
        parameters += (i == 0 ? ": " : ", ") + target.space().parameter_name(m, i) + " ~ " +
                      target.space().prior(m, i).describe();
      }
      throw LikelihoodError("the likelihood of model '" + target.space()[m].name +
                            "' is zero at every point drawn from its prior (" +
                            std::to_string(tries) + " tried)" + parameters);
    }
  }
}

TemperedChain::TemperedChain(Target& target, std::vector<double> betas, KernelFactory kernels,
                             std::uint64_t seed, int chain)
    : target_(target),
      betas_(std::move(betas)),
      factory_(std::move(kernels)),
      seed_(seed),
      chain_(chain) {
  for (std::size_t i = 0; i < betas_.size(); ++i) kernels_.push_back(factory_());
  rejection_.assign(betas_.size(), 0.0);
  tried_.assign(betas_.size(), 0);
  direction_.assign(betas_.size(), 0);
  replica_.resize(betas_.size());
  std::iota(replica_.begin(), replica_.end(), 0);
  weights_.assign(betas_.size(),
                  std::vector<double>(static_cast<std::size_t>(target.space().size()), 0.0));
}

void TemperedChain::reset_round_trips() {
  round_trips_ = 0;
  direction_.assign(betas_.size(), 0);
}

void TemperedChain::start() {
  states_.clear();
  for (int i = 0; i < rungs(); ++i) {
    base::Random random(seed_, static_cast<std::uint64_t>(chain_), static_cast<std::uint64_t>(i),
                        base::Purpose::start);
    states_.push_back(start_from_prior(target_, random));
  }
}

void TemperedChain::set_kernels(KernelFactory kernels) {
  factory_ = std::move(kernels);
  for (auto& kernel : kernels_) kernel = factory_();
}

void TemperedChain::scan(int steps, bool adapting, base::Purpose purpose, const Observer& observe) {
  const auto stream = [&](long rung, base::Purpose p) {
    return base::Random(seed_, static_cast<std::uint64_t>(chain_),
                        static_cast<std::uint64_t>(scans_ * kMaxRungs + rung), p);
  };
  for (int i = 0; i < rungs(); ++i) {
    const auto r = static_cast<std::size_t>(i);
    base::Random random = stream(i, purpose);
    if (i == 0 && rungs() > 1) {
      State fresh;
      target_.draw_prior(random, fresh);
      target_.evaluate(fresh);
      // With a prior factor the fresh draw is an independence proposal; without one it is the
      // prior.
      const double log_ratio = fresh.log_prior_factor - states_[r].log_prior_factor;
      if (std::isfinite(fresh.log_likelihood) && std::log(random.uniform()) < log_ratio) {
        states_[r] = std::move(fresh);
      }
      continue;
    }
    target_.set_model_bias(weights_[r]);
    for (int s = 0; s < steps; ++s) {
      Kernel::Outcome outcome;
      const int from = states_[r].model;
      const int kernel =
          kernels_[r]->step(states_[r], {target_, random, betas_[r], adapting}, outcome);
      if (observe && i + 1 == rungs()) observe(kernel, outcome, from);
    }
    if (balancing_ && adapting) {
      const double gain = kFirstScans / std::max(kFirstScans, static_cast<double>(scans_));
      const double share = gain / static_cast<double>(weights_[r].size());
      for (double& w : weights_[r]) w += share;
      weights_[r][static_cast<std::size_t>(states_[r].model)] -= gain;
    }
  }
  base::Random random = stream(kMaxRungs - 1, base::Purpose::swap);
  for (int i = static_cast<int>(scans_ % 2); i + 1 < rungs(); i += 2) {
    const auto r = static_cast<std::size_t>(i);
    const auto low = static_cast<std::size_t>(states_[r].model);
    const auto high = static_cast<std::size_t>(states_[r + 1].model);
    const double log_ratio =
        (betas_[r + 1] - betas_[r]) * (states_[r].log_likelihood - states_[r + 1].log_likelihood) +
        weights_[r + 1][low] - weights_[r][low] + weights_[r][high] - weights_[r + 1][high];
    const double alpha = std::exp(std::min(0.0, log_ratio));
    rejection_[r] += 1.0 - alpha;
    ++tried_[r];
    if (random.uniform() < alpha) {
      std::swap(states_[r], states_[r + 1]);
      std::swap(replica_[r], replica_[r + 1]);
    }
  }
  int& bottom = direction_[static_cast<std::size_t>(replica_.front())];
  int& top = direction_[static_cast<std::size_t>(replica_.back())];
  if (bottom == -1) ++round_trips_;
  bottom = 1;
  if (top == 1) top = -1;
  ++scans_;
}

double TemperedChain::barrier() const {
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < betas_.size(); ++i) {
    if (tried_[i] > 0) sum += rejection_[i] / static_cast<double>(tried_[i]);
  }
  return sum;
}

void TemperedChain::adapt_ladder(int count) {
  // Λ(β), piecewise linear in ln(β + β_1) between the rungs so far, shared out equally.
  const std::size_t n = betas_.size();
  std::vector<double> cumulative(n, 0.0);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const double rate = tried_[i] > 0 ? rejection_[i] / static_cast<double>(tried_[i]) : 0.0;
    cumulative[i + 1] = cumulative[i] + std::max(rate, 1e-3);
  }
  const double shift = betas_[1];
  std::vector<double> betas(static_cast<std::size_t>(count), 0.0);
  std::vector<State> states;
  std::vector<std::unique_ptr<KernelMixture>> kernels;
  std::vector<std::vector<double>> weights;
  std::size_t segment = 0;
  for (int i = 0; i < count; ++i) {
    const double goal = cumulative.back() * i / (count - 1);
    while (segment + 2 < n && cumulative[segment + 1] < goal) ++segment;
    const double share =
        (goal - cumulative[segment]) / (cumulative[segment + 1] - cumulative[segment]);
    const double low = std::log(betas_[segment] + shift);
    const double high = std::log(betas_[segment + 1] + shift);
    betas[static_cast<std::size_t>(i)] = std::exp(low + share * (high - low)) - shift;
    const std::size_t nearest = share < 0.5 ? segment : segment + 1;
    states.push_back(states_[nearest]);
    weights.push_back(weights_[nearest]);
    kernels.push_back(kernels_[nearest] ? std::move(kernels_[nearest]) : factory_());
  }
  betas.front() = 0.0;
  betas.back() = 1.0;
  betas_ = std::move(betas);
  states_ = std::move(states);
  kernels_ = std::move(kernels);
  weights_ = std::move(weights);
  weights_.front().assign(weights_.front().size(), 0.0);  // the prior's own
  rejection_.assign(betas_.size(), 0.0);
  tried_.assign(betas_.size(), 0);
  direction_.assign(betas_.size(), 0);
  replica_.resize(betas_.size());
  std::iota(replica_.begin(), replica_.end(), 0);
}

}  // namespace wheeltap::inference
