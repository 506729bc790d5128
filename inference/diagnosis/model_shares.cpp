#include "inference/diagnosis/model_shares.hpp"

#include <algorithm>
#include <cmath>

#include "inference/statistics/diagnostics.hpp"

namespace wheeltap::inference {

ModelShares model_shares(const Posterior& posterior) {
  const auto models = static_cast<std::size_t>(posterior.space->size());
  const std::size_t chains = posterior.chains.size();
  ModelShares out;
  out.counts.assign(chains, std::vector<long>(models));
  long all = 0;
  for (std::size_t c = 0; c < chains; ++c) {
    for (const int m : posterior.chains[c].model) ++out.counts[c][static_cast<std::size_t>(m)];
    all += static_cast<long>(posterior.chains[c].size());
  }
  out.visits.assign(models, 0.0);
  out.weight.assign(models, 1.0);
  if (!posterior.log_weight.empty()) {
    const double top = std::ranges::max(posterior.log_weight);
    for (std::size_t m = 0; m < models; ++m) {
      out.weight[m] = std::max(std::exp(posterior.log_weight[m] - top), 1e-300);
    }
  }
  double total = 0.0;
  for (std::size_t m = 0; m < models; ++m) {
    for (std::size_t c = 0; c < chains; ++c) {
      out.visits[m] +=
          static_cast<double>(out.counts[c][m]) / static_cast<double>(std::max(all, 1L));
    }
    total += out.visits[m] * out.weight[m];
  }
  for (double& w : out.weight) w /= total > 0.0 ? total : 1.0;
  out.share.resize(models);
  for (std::size_t m = 0; m < models; ++m) out.share[m] = out.visits[m] * out.weight[m];
  out.error.assign(models, 0.0);
  for (std::size_t m = 0; m < models; ++m) {
    if (out.visits[m] == 0.0) continue;
    out.error[m] = mcse_mean(of_all_draws(posterior, [&](const Draw& draw) {
      const auto at = static_cast<std::size_t>(draw.model);
      return out.weight[at] * ((at == m ? 1.0 : 0.0) - out.share[m]);
    }));
  }
  return out;
}

}  // namespace wheeltap::inference
