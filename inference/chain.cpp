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

}  // namespace wheeltap::inference
