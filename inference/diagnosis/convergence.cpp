#include "inference/diagnosis/convergence.hpp"

#include <cmath>

#include "inference/diagnosis/verdict.hpp"
#include "inference/statistics/diagnostics.hpp"

namespace wheeltap::inference {
namespace {

// True if `passes` holds for all models that the draws show neither as certain nor as impossible.
template <class Passes>
bool every_open_model(const Posterior& posterior, const Passes& passes) {
  for (int m = 0; m < posterior.space->size(); ++m) {
    const ChainsOf indicator = posterior.indicator(m);
    const double share = mean(indicator);
    if (share > kLimits.known && share < 1.0 - kLimits.known && !passes(indicator)) return false;
  }
  return true;
}

}  // namespace

bool may_stop(const Posterior& posterior, bool balanced) {
  const double enough = balanced ? kLimits.known : kLimits.worth_knowing;
  return every_open_model(
             posterior,
             [&](const ChainsOf& indicator) { return mcse_mean(indicator) <= enough; }) &&
         judge(posterior).converged;
}

double annealed_excess(const ModelFindings& found) {
  const double excess = found.annealed_beyond - found.beyond_mixture;
  const double visits = found.beyond_mixture * found.beyond_mixture_ess;
  return excess > 0.0 && !(visits > kLimits.beyond_visits) ? excess : 0.0;
}

bool lacks_annealed(const ModelFindings& found, double share) {
  if (!(annealed_excess(found) > share)) return false;
  const double effective =
      static_cast<double>(found.annealed_draws) / kLimits.annealed_draws_an_effective;
  return 2.0 * std::sqrt(effective * found.annealed_beyond) > kLimits.sigmas;
}

bool chains_agree(const Posterior& posterior) {
  if (!every_open_model(posterior, [](const ChainsOf& indicator) {
        return rhat(indicator) < kLimits.rhat_apart;
      }))
    return false;
  ChainsOf log_posterior;
  for (const Chain& chain : posterior.chains) {
    std::vector<double>& values =
        log_posterior.emplace_back(chain.log_likelihood.begin(), chain.log_likelihood.end());
    for (std::size_t i = 0; i < values.size(); ++i) values[i] += chain.log_prior[i];
  }
  return rhat(log_posterior) < kLimits.rhat_apart;
}

}  // namespace wheeltap::inference
