#include "inference/evidence/importance_sampling.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "base/parallel.hpp"
#include "base/parcel.hpp"

namespace wheeltap::inference {

std::vector<double> log_importance_ratios(const Problem& problem, int model,
                                          const NormalMixture& proposal, int n, std::uint64_t seed,
                                          int threads, long& evaluations,
                                          const std::function<bool()>& stop) {
  // Draws per job (block). Random streams belong to blocks, not to threads.
  constexpr int kBlock = 1000;
  const int blocks = (n + kBlock - 1) / kBlock;
  std::vector<double> ratios(static_cast<std::size_t>(n));
  std::vector<long> counted(static_cast<std::size_t>(blocks), 0);
  base::parallel_for(
      blocks, threads,
      [&](int block) {
        ModelPosterior posterior(problem, model);
        base::Random random(seed, static_cast<std::uint64_t>(block) | (std::uint64_t{1} << 62U),
                            static_cast<std::uint64_t>(model), base::Purpose::evidence);
        std::vector<double> z(static_cast<std::size_t>(posterior.dimension()));
        const int end = std::min(n, (block + 1) * kBlock);
        for (int i = block * kBlock; i < end && !(stop && stop()); ++i) {
          proposal.sample(random, z);
          const double log_posterior = posterior(z).log_posterior();
          ratios[static_cast<std::size_t>(i)] = log_posterior - proposal.log_density(z);
        }
        counted[static_cast<std::size_t>(block)] = posterior.evaluations();
      },
      base::carriage([&](int block, auto& parcel) {
        const auto begin = static_cast<std::size_t>(block * kBlock);
        parcel(
            std::span(ratios).subspan(begin, std::min<std::size_t>(kBlock, ratios.size() - begin)),
            counted[static_cast<std::size_t>(block)]);
      }));
  for (const long c : counted) evaluations += c;
  return ratios;
}

double pareto_shape(std::span<const double> log_weights) {
  return pareto_tail(log_weights).shape;
}

ParetoTail pareto_tail(std::span<const double> log_weights) {
  constexpr ParetoTail kNone{.shape = -std::numeric_limits<double>::infinity(), .log_excess = 0.0};
  std::vector<double> sorted(log_weights.begin(), log_weights.end());
  std::ranges::sort(sorted, std::greater<>());
  const auto n = static_cast<double>(sorted.size());
  const auto tail = static_cast<std::size_t>(std::min(0.2 * n, 3.0 * std::sqrt(n)));
  if (tail < 5 || sorted[tail] == -std::numeric_limits<double>::infinity()) return kNone;
  // Excesses of the largest weights over the threshold, ascending, in units of the largest weight.
  std::vector<double> x;
  for (std::size_t i = tail; i-- > 0;)
    x.push_back(std::exp(sorted[i] - sorted[0]) - std::exp(sorted[tail] - sorted[0]));
  if (!(x.back() > 0.0) || !(x[x.size() / 4] > 0.0)) return kNone;
  // Mean of θ = -k/σ, weighted by the profile likelihood, on a grid that the quartile determines.
  const auto m = static_cast<double>(x.size());
  const double quartile = x[static_cast<std::size_t>(m / 4.0 + 0.5) - 1];
  const int points = 30 + static_cast<int>(std::sqrt(m));
  const auto shape = [&](double theta) {
    double sum = 0.0;
    for (const double v : x) sum += std::log1p(-theta * v);
    return sum / m;
  };
  std::vector<double> theta, log_likelihood;
  for (int j = 1; j <= points; ++j) {
    const double t = 1.0 / x.back() + (1.0 - std::sqrt(points / (j - 0.5))) / (3.0 * quartile);
    const double k = shape(t);
    theta.push_back(t);
    log_likelihood.push_back(m * (std::log(-t / k) - k - 1.0));
  }
  const double top = std::ranges::max(log_likelihood);
  double mean = 0.0, sum = 0.0;
  for (std::size_t j = 0; j < theta.size(); ++j) {
    const double w = std::exp(log_likelihood[j] - top);
    mean += w * theta[j];
    sum += w;
  }
  const double fitted = shape(mean / sum), scale = -fitted * sum / mean;
  const double k = (m * fitted + 10.0 * 0.5) / (m + 10.0);  // shrinkage to ½ (ibid., appendix)
  // A weight exceeds w(p) = u + σ/k ((p/q)^-k - 1) with probability p, and u with probability q. n
  // draws typically lack the part of the mean between p = 1/100n and 1/n.
  const double q = m / n, threshold = std::exp(sorted[tail] - sorted[0]);
  const double high = 1.0 / n, low = 0.01 / n;
  const double power = std::abs(k - 1.0) > 1e-9
                           ? (std::pow(high, 1.0 - k) - std::pow(low, 1.0 - k)) / (1.0 - k)
                           : std::log(high / low);
  const double lacking =
      k > 0.0 ? (threshold - scale / k) * (high - low) + scale / k * std::pow(q, k) * power : 0.0;
  double total = 0.0;
  for (const double w : sorted) total += std::exp(w - sorted[0]);
  return {.shape = k, .log_excess = std::log1p(std::max(0.0, n * lacking / total))};
}

ImportanceSampling importance_sampling(const Problem& problem, int model,
                                       const NormalMixture& proposal,
                                       const ImportanceOptions& options) {
  if (options.draws < 100)
    throw std::invalid_argument("importance sampling: draws = " + std::to_string(options.draws) +
                                ", must be >= 100");
  const int d = ModelPosterior(problem, model).dimension();
  if (proposal.dimension() != d)
    throw std::invalid_argument(
        "importance sampling: the proposal's dimension = " + std::to_string(proposal.dimension()) +
        ", must be " + std::to_string(d));
  ImportanceSampling result;
  Evidence& evidence = result.evidence;
  const std::vector<double> ratios =
      log_importance_ratios(problem, model, proposal, options.draws, options.seed, options.threads,
                            evidence.likelihood_evaluations);
  const double top = std::ranges::max(ratios);
  const std::string name = "model '" + problem.space[model].name + "': ";
  if (top == -std::numeric_limits<double>::infinity())
    throw LikelihoodError(name + "the likelihood is zero at every one of " +
                          std::to_string(options.draws) + " draws from the proposal");
  const double n = options.draws;
  double sum = 0.0, squares = 0.0;
  for (const double r : ratios) {
    const double w = std::exp(r - top);
    sum += w;
    squares += w * w;
  }
  evidence.log_evidence = top + std::log(sum / n);
  result.effective_draws = sum * sum / squares;
  evidence.standard_error = std::sqrt(std::max(0.0, (n * squares / (sum * sum) - 1.0) / (n - 1.0)));
  result.pareto_k = pareto_shape(ratios);
  if (result.pareto_k > 0.7)
    evidence.warnings.push_back(
        {.kind = EvidenceWarning::Kind::heavy_tail, .value = result.pareto_k});
  if (result.effective_draws < 100.0)
    evidence.warnings.push_back(
        {.kind = EvidenceWarning::Kind::few_effective_draws, .value = result.effective_draws});
  return result;
}

}  // namespace wheeltap::inference
