#include "inference/evidence/bridge_sampling.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "base/parallel.hpp"
#include "inference/evidence/importance_sampling.hpp"
#include "inference/evidence/tmcmc.hpp"
#include "inference/statistics/diagnostics.hpp"

namespace wheeltap::inference {

namespace {

constexpr int kMostDraws = 80000;

double variance(const std::vector<double>& values, double mean) {
  double sum = 0.0;
  for (const double v : values) sum += (v - mean) * (v - mean);
  return sum / static_cast<double>(values.size() - 1);
}

}  // namespace

Bridge bridge(const ChainsOf& at_posterior, const std::vector<double>& at_proposal) {
  Bridge result;
  const auto n2 = static_cast<double>(at_proposal.size());
  const std::size_t chains = at_posterior.size();
  // The median of all ratios is the unit of the ratios.
  std::vector<double> pooled;
  for (const auto& chain : at_posterior) pooled.insert(pooled.end(), chain.begin(), chain.end());
  std::ranges::nth_element(pooled, pooled.begin() + static_cast<std::ptrdiff_t>(pooled.size() / 2));
  const double typical = pooled[pooled.size() / 2];
  const auto n1 = static_cast<double>(pooled.size());
  const double effective = std::clamp(ess_mean(at_posterior), 1.0, n1);
  const double s1 = effective / (effective + n2), s2 = 1.0 - s1;
  const auto clipped = [&](double log_ratio) {
    return std::exp(std::min(700.0, log_ratio - typical));
  };
  double z = 1.0;
  for (int iteration = 0; iteration < 1000 && !result.settled; ++iteration) {
    double numerator = 0.0, denominator = 0.0;
    for (const double l : at_proposal) {
      const double r = clipped(l);
      numerator += r / (s1 * r + s2 * z) / n2;
    }
    for (const auto& chain : at_posterior)
      for (const double l : chain) denominator += 1.0 / (s1 * clipped(l) + s2 * z) / n1;
    const double next = numerator / denominator;
    result.settled = std::fabs(next - z) <= 1e-10 * z;
    z = next;
    if (!(z > 0.0)) break;
  }
  result.log_evidence = typical + std::log(z);

  // f₁ = π/Z / (s₁ π/Z + s₂ q) at the proposal's draws, f₂ = q / (same) at the posterior's:
  // Var[ln Z] = Var f₁ / (n₂ E² f₁) + τ Var f₂ / (n₁ E² f₂).
  std::vector<double> f1;
  f1.reserve(at_proposal.size());
  double mean1 = 0.0, mean2 = 0.0;
  for (const double l : at_proposal) {
    const double r = clipped(l) / z;
    mean1 += f1.emplace_back(r / (s1 * r + s2)) / n2;
  }
  ChainsOf f2(chains);
  for (std::size_t c = 0; c < chains; ++c)
    for (const double l : at_posterior[c])
      mean2 += f2[c].emplace_back(1.0 / (s1 * clipped(l) / z + s2)) / n1;
  const double relative1 = variance(f1, mean1) / (n2 * mean1 * mean1);
  const double relative2 = std::pow(mcse_mean(f2) / mean2, 2.0);
  result.standard_error = std::sqrt(relative1 + relative2);
  result.effective_draws = ess_mean(f2);
  return result;
}

Evidence bridge_sampling(const Problem& problem, int model, const ModelSamples& samples,
                         const BridgeOptions& options) {
  const std::size_t chains = samples.z.size();
  const Eigen::Index draws = chains == 0 ? 0 : samples.z.front().rows();
  if (draws < 20)
    throw std::invalid_argument("bridge sampling: " + std::to_string(draws) +
                                " draws per chain, must be >= 20");
  if (options.proposal_draws < 0)
    throw std::invalid_argument("bridge sampling: proposal_draws = " +
                                std::to_string(options.proposal_draws) + ", must be >= 0");
  const Eigen::Index fit_draws = draws / 2, used = draws - fit_draws, d = samples.z.front().cols();

  // Equally spaced draws, at most as many as a mixture can use.
  const auto all = fit_draws * static_cast<Eigen::Index>(chains);
  const Eigen::Index stride = std::max<Eigen::Index>(1, all / 5000);
  Eigen::MatrixXd training((all + stride - 1) / stride, d);
  for (Eigen::Index i = 0, row = 0; i < all; i += stride)
    training.row(row++) = samples.z[static_cast<std::size_t>(i / fit_draws)].row(i % fit_draws);
  base::Random random(options.seed, 0, static_cast<std::uint64_t>(model), base::Purpose::fit);
  const NormalMixture proposal = NormalMixture::fit(training, options.fit, random);

  // ln l at the posterior draws, one vector per chain for the autocorrelation.
  ChainsOf at_posterior(chains);
  for (std::size_t c = 0; c < chains; ++c)
    for (Eigen::Index i = fit_draws; i < draws; ++i) {
      const Eigen::VectorXd z = samples.z[c].row(i);
      at_posterior[c].push_back(samples.log_posterior[c][static_cast<std::size_t>(i)] -
                                proposal.log_density({z.data(), static_cast<std::size_t>(d)}));
    }
  Evidence evidence;
  const int n2 = options.proposal_draws > 0 ? options.proposal_draws
                                            : static_cast<int>(used) * static_cast<int>(chains);
  const std::vector<double> at_proposal = log_importance_ratios(
      problem, model, proposal, n2, options.seed, options.threads, evidence.likelihood_evaluations);

  const Bridge bridged = bridge(at_posterior, at_proposal);
  evidence.log_evidence = bridged.log_evidence;
  evidence.standard_error = bridged.standard_error;
  if (!bridged.settled)
    evidence.warnings.push_back({.kind = EvidenceWarning::Kind::bridge_unsettled});
  if (bridged.effective_draws < 100.0)
    evidence.warnings.push_back(
        {.kind = EvidenceWarning::Kind::few_bridge_draws, .value = bridged.effective_draws});
  evidence.warnings.insert(evidence.warnings.end(), samples.warnings.begin(),
                           samples.warnings.end());
  return evidence;
}

Evidence bridge_sampling(const Problem& problem, int model, const BridgeOptions& options) {
  const Tmcmc first =
      tmcmc(problem, model, {.seed = options.seed, .replicates = 4, .threads = options.threads});
  Evidence evidence = bridge_sampling(problem, model, first, options);
  if (first.z.size() > 0) evidence.likelihood_evaluations += first.evidence.likelihood_evaluations;
  return evidence;
}

Evidence bridge_sampling(const Problem& problem, int model, const Tmcmc& first,
                         const BridgeOptions& options) {
  if (first.z.size() == 0) return first.evidence;  // exact for a model without parameters, or NaN
  base::Random random(options.seed, 1, static_cast<std::uint64_t>(model), base::Purpose::fit);
  const NormalMixture pilot = NormalMixture::fit(first.z, options.fit, random);
  // Lengthens the chains while a warning remains. Each attempt starts anew; no result is selected.
  Evidence evidence;
  long spent = 0;
  for (int draws = 5000; draws <= kMostDraws; draws *= 4) {
    const ModelSamples samples =
        metropolis(problem, model, pilot,
                   {.seed = options.seed + static_cast<std::uint64_t>(draws),
                    .warmup = draws / 5,
                    .draws = draws,
                    .threads = options.threads});
    evidence = bridge_sampling(problem, model, samples, options);
    spent += evidence.likelihood_evaluations + samples.likelihood_evaluations;
    if (evidence.warnings.empty()) break;
  }
  evidence.likelihood_evaluations = spent;
  return evidence;
}

}  // namespace wheeltap::inference
