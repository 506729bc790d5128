// How well the chains mixed, by quantities that mean the same in every model.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "inference/diagnosis/model_shares.hpp"
#include "inference/diagnosis/posterior.hpp"

namespace wheeltap::inference {

/// A quantity that means the same in every model, by which convergence is judged too. Counts and
/// models are watched anyway.
struct Watched {
  std::string name;
  std::function<ChainsOf()> draws;  ///< asked for when it is judged, one after another
};

struct Mixing {
  /// Of the log posterior, counts of each kind (or indicators of models from 0.1 % to 99.9 %), and
  /// what is watched, in this order.
  std::vector<std::pair<std::string, double>> rhats;
  double rhat_max = std::numeric_limits<double>::quiet_NaN();  ///< of those judged
  std::string rhat_worst;                                      ///< the quantity that has it
  double ess_log_posterior = 0.0;                              ///< the smaller of bulk and tail
  /// The smallest over counts or indicators; that of the log posterior where these hardly change.
  double ess_model = 0.0;
  bool too_few = false;  ///< `ess_model` is of a quantity that is judged, and not above the limit

  /// Effective draws of a chain, by both.
  [[nodiscard]] double effective(std::size_t chains) const;
};

/// A count or an indicator whose probabilities are known to 0.001 is not judged, however few its
/// excursions.
[[nodiscard]] Mixing mixing(const Posterior& posterior, const ModelShares& shares,
                            const std::vector<Watched>& watched);

}  // namespace wheeltap::inference
