// Mixing of the chains, judged by quantities that have the same meaning in every model.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "inference/diagnosis/model_shares.hpp"
#include "inference/diagnosis/posterior.hpp"

namespace wheeltap::inference {

/// An additional quantity whose convergence is assessed. This quantity must have the same meaning
/// in every model. The convergence of counts and model indicators is always assessed.
struct Watched {
  std::string name;
  std::function<ChainsOf()> draws;  ///< called to judge the quantity, never concurrently
};

struct Mixing {
  /// R-hat of the log posterior, of the number of components of each kind (or of the indicators of
  /// models with a probability of 0.1 % to 99.9 %), and of the watched quantities, in this order.
  std::vector<std::pair<std::string, double>> rhats;
  double rhat_max =
      std::numeric_limits<double>::quiet_NaN();  ///< largest R-hat of all judged quantities
  std::string rhat_worst;                        ///< the quantity with the largest R-hat
  /// Effective sample size of the log posterior: the smaller of bulk and tail value
  double ess_log_posterior = 0.0;
  /// The smallest effective sample size over counts or indicators. If counts and indicators hardly
  /// change, `ess_model` is the effective sample size of the log posterior.
  double ess_model = 0.0;
  /// True if the effective sample size of a judged count or indicator does not exceed the limit
  bool too_few = false;

  /// Effective draws per chain: the smaller of `ess_model` and `ess_log_posterior`, divided by the
  /// number of chains.
  [[nodiscard]] double effective(std::size_t chains) const;
};

/// Computes R-hat and the effective sample sizes of a run. A count or an indicator is not judged if
/// its probabilities are known to within 0.001, even if its transitions are rare.
[[nodiscard]] Mixing mixing(const Posterior& posterior, const ModelShares& shares,
                            const std::vector<Watched>& watched);

}  // namespace wheeltap::inference
