#include "inference/chain.hpp"

#include <algorithm>

namespace wheeltap::inference {

void Chain::truncate(std::size_t draws) {
  const std::size_t before = std::max<std::size_t>(size(), 1);
  theta.resize(theta.size() / before * draws);
  prediction.resize(prediction.size() / before * draws);
  model.resize(draws);
  log_prior.resize(draws);
  log_likelihood.resize(draws);
  move.resize(draws);
  accepted.resize(draws);
}

void Chain::append(const Chain& more) {
  const auto follow = [](auto& these, const auto& those) {
    these.insert(these.end(), those.begin(), those.end());
  };
  follow(model, more.model);
  follow(theta, more.theta);
  follow(log_prior, more.log_prior);
  follow(log_likelihood, more.log_likelihood);
  follow(move, more.move);
  follow(accepted, more.accepted);
  follow(prediction, more.prediction);
}

}  // namespace wheeltap::inference
