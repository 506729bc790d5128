#include "inference/chains/tempering.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace wheeltap::inference {

namespace {
constexpr long kMaxRungs = 1 << 10;  // random streams per scan
// Largest number of draws from the prior. These draws miss a feasible region of 1e-4 of the prior
// with a probability of e^-10. The evaluation of a zero likelihood usually takes little time.
constexpr int kPriorTries = 100'000;
// Number of draws for a long record; after kTriesOfWhole draws, its first samples test a draw.
constexpr int kTriesOfRecord = 5000;
constexpr int kTriesOfWhole = 200;
// Number of samples in these tests, because each draw is expensive for a long record.
constexpr long kFirstSamples = 50;
constexpr int kFirstOfCheck = 1000;   // first random stream of the check, after those of the rungs
constexpr double kFirstScans = 60.0;  // t₀: number of scans with γ_t = 1
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
  for (int i = 0; i < kPriorTries; ++i) {
    target.draw_prior(random, state);
    target.evaluate(state);
    if (std::isfinite(state.log_likelihood)) return state;
  }
  throw LikelihoodError("the likelihood is zero at every one of " + std::to_string(kPriorTries) +
                        " points drawn from the prior");
}

std::vector<int> check_models(Target& target, std::uint64_t seed,
                              const std::function<bool(double tried)>& goes_on) {
  std::vector<int> impossible;
  int possible = 0, most_tries = 0;
  std::shared_ptr<const Problem> part;
  std::unique_ptr<Target> shortened;
  if (target.problem().shortened && target.problem().samples > kFirstSamples) {
    part = target.problem().shortened(kFirstSamples);
    shortened = std::make_unique<Target>(*part, false);
  }
  for (int m = 0; m < target.space().size(); ++m) {
    if (!std::isfinite(target.space()[m].log_prior)) continue;
    // Most impossible draws of a long record are impossible for its first samples, which take less
    // time. The first kTriesOfWhole draws use the whole record, so that LikelihoodError never
    // depends on the first samples alone.
    const int tries = shortened ? kTriesOfRecord : kPriorTries;
    State state;
    bool finite = false;
    for (int i = 0; i < tries && !finite; ++i) {
      if (goes_on && !goes_on((m + static_cast<double>(i) / tries) / target.space().size()))
        return impossible;
      base::Random random(seed, static_cast<std::uint64_t>(m),
                          static_cast<std::uint64_t>(kFirstOfCheck + i), base::Purpose::start);
      target.draw_prior(m, random, state);
      if (shortened && i >= kTriesOfWhole) {
        State first = state;
        shortened->evaluate(first);
        if (!std::isfinite(first.log_likelihood)) continue;
      }
      target.evaluate(state);
      finite = std::isfinite(state.log_likelihood);
      if (state.z.empty()) break;
    }
    most_tries = std::max(most_tries, tries);
    if (finite)
      ++possible;
    else
      impossible.push_back(m);
  }
  if (possible > 0 || impossible.empty()) return impossible;
  const int m = impossible.front();
  std::string parameters;
  for (int i = 0; i < target.space()[m].dimension; ++i) {
    parameters += (i == 0 ? ": " : ", ") + target.space().parameter_name(m, i) + " ~ " +
                  target.space().prior(m, i).describe();
  }
  throw LikelihoodError("the likelihood of model '" + target.space()[m].name +
                        "' is zero at every point drawn from its prior (" +
                        std::to_string(most_tries) + " tried)" + parameters);
}

Ladder::Ladder(std::vector<double> inverse_temperatures, int models)
    : betas(std::move(inverse_temperatures)),
      weights(betas.size(), std::vector<double>(static_cast<std::size_t>(models), 0.0)) {
  reset_swaps();
}

void Ladder::reset_swaps() {
  rejection.assign(betas.size(), 0.0);
  tried.assign(betas.size(), 0);
  direction.assign(betas.size(), 0);
  replica.resize(betas.size());
  std::iota(replica.begin(), replica.end(), 0);
}

void Ladder::reset_round_trips() {
  round_trips = 0;
  direction.assign(betas.size(), 0);
}

TemperedChain::TemperedChain(Target& target, Ladder ladder, KernelFactory kernels,
                             std::uint64_t seed, int chain)
    : target_(target),
      ladder_(std::move(ladder)),
      factory_(std::move(kernels)),
      seed_(seed),
      chain_(chain) {
  for (int i = 0; i < rungs(); ++i) kernels_.push_back(factory_());
}

std::vector<std::vector<double>> TemperedChain::learnt() const {
  std::vector<std::vector<double>> out;
  for (const auto& kernels : kernels_) out.push_back(kernels->learnt());
  return out;
}

void TemperedChain::restore(const std::vector<std::vector<double>>& learnt) {
  for (std::size_t r = 0; r < kernels_.size(); ++r) kernels_[r]->restore(learnt.at(r));
}

void TemperedChain::start() {
  ladder_.states.clear();
  for (int i = 0; i < rungs(); ++i) {
    base::Random random(seed_, static_cast<std::uint64_t>(chain_), static_cast<std::uint64_t>(i),
                        base::Purpose::start);
    ladder_.states.push_back(start_from_prior(target_, random));
  }
}

bool TemperedChain::scan(int steps, bool adapting, base::Purpose purpose, const Observer& observe,
                         const std::function<bool()>& leave) {
  const auto stream = [&](long rung, base::Purpose p) {
    return base::Random(seed_, static_cast<std::uint64_t>(chain_),
                        static_cast<std::uint64_t>(ladder_.scans * kMaxRungs + rung), p);
  };
  for (int i = 0; i < rungs(); ++i) {
    const auto r = static_cast<std::size_t>(i);
    base::Random random = stream(i, purpose);
    if (i == 0 && rungs() > 1) {
      State draw;
      target_.draw_prior(random, draw);
      target_.evaluate(draw);
      // Without a prior factor, this is a draw from the prior; otherwise, an independence
      // proposal.
      const double log_ratio = draw.log_prior_factor - ladder_.states[r].log_prior_factor;
      if (std::isfinite(draw.log_likelihood) && std::log(random.uniform()) < log_ratio) {
        ladder_.states[r] = std::move(draw);
      }
      continue;
    }
    target_.set_model_bias(ladder_.weights[r]);
    for (int s = 0; s < steps; ++s) {
      if (leave && leave()) return false;
      Kernel::Outcome outcome;
      const int from = ladder_.states[r].model;
      const int kernel = kernels_[r]->step(ladder_.states[r],
                                           {target_, random, ladder_.betas[r], adapting}, outcome);
      if (observe && i + 1 == rungs()) observe(kernel, outcome, from);
    }
    if (ladder_.balancing && adapting) {
      const double gain = kFirstScans / std::max(kFirstScans, static_cast<double>(ladder_.scans));
      const double share = gain / static_cast<double>(ladder_.weights[r].size());
      for (double& w : ladder_.weights[r]) w += share;
      ladder_.weights[r][static_cast<std::size_t>(ladder_.states[r].model)] -= gain;
    }
  }
  base::Random random = stream(kMaxRungs - 1, base::Purpose::swap);
  for (int i = static_cast<int>(ladder_.scans % 2); i + 1 < rungs(); i += 2) {
    const auto r = static_cast<std::size_t>(i);
    const auto low = static_cast<std::size_t>(ladder_.states[r].model);
    const auto high = static_cast<std::size_t>(ladder_.states[r + 1].model);
    const double log_ratio =
        (ladder_.betas[r + 1] - ladder_.betas[r]) *
            (ladder_.states[r].log_likelihood - ladder_.states[r + 1].log_likelihood) +
        ladder_.weights[r + 1][low] - ladder_.weights[r][low] + ladder_.weights[r][high] -
        ladder_.weights[r + 1][high];
    const double alpha = std::exp(std::min(0.0, log_ratio));
    ladder_.rejection[r] += 1.0 - alpha;
    ++ladder_.tried[r];
    if (random.uniform() < alpha) {
      std::swap(ladder_.states[r], ladder_.states[r + 1]);
      std::swap(ladder_.replica[r], ladder_.replica[r + 1]);
    }
  }
  int& bottom = ladder_.direction[static_cast<std::size_t>(ladder_.replica.front())];
  int& top = ladder_.direction[static_cast<std::size_t>(ladder_.replica.back())];
  if (bottom == -1) ++ladder_.round_trips;
  bottom = 1;
  if (top == 1) top = -1;
  ++ladder_.scans;
  return true;
}

double TemperedChain::barrier() const {
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < ladder_.betas.size(); ++i) {
    if (ladder_.tried[i] > 0) sum += ladder_.rejection[i] / static_cast<double>(ladder_.tried[i]);
  }
  return sum;
}

void TemperedChain::adapt_ladder(int count) {
  // Divides Λ(β), piecewise linear in ln(β + β_1) between the current rungs, into equal parts.
  const std::size_t n = ladder_.betas.size();
  std::vector<double> cumulative(n, 0.0);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const double rate =
        ladder_.tried[i] > 0 ? ladder_.rejection[i] / static_cast<double>(ladder_.tried[i]) : 0.0;
    cumulative[i + 1] = cumulative[i] + std::max(rate, 1e-3);
  }
  const double shift = ladder_.betas[1];
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
    const double low = std::log(ladder_.betas[segment] + shift);
    const double high = std::log(ladder_.betas[segment + 1] + shift);
    betas[static_cast<std::size_t>(i)] = std::exp(low + share * (high - low)) - shift;
    const std::size_t nearest = share < 0.5 ? segment : segment + 1;
    states.push_back(ladder_.states[nearest]);
    weights.push_back(ladder_.weights[nearest]);
    kernels.push_back(kernels_[nearest] ? std::move(kernels_[nearest]) : factory_());
  }
  betas.front() = 0.0;
  betas.back() = 1.0;
  ladder_.betas = std::move(betas);
  ladder_.states = std::move(states);
  kernels_ = std::move(kernels);
  ladder_.weights = std::move(weights);
  ladder_.weights.front().assign(ladder_.weights.front().size(), 0.0);  // weights of the prior
  ladder_.reset_swaps();
}

}  // namespace wheeltap::inference
