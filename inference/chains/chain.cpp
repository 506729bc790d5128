#include "inference/chains/chain.hpp"

namespace wheeltap::inference {
namespace {

/// Calls f(list) for each list of a chain.
template <class OfChain, class F>
void for_each_list(OfChain& chain, const F& f) {
  f(chain.model), f(chain.theta), f(chain.log_prior), f(chain.log_likelihood);
  f(chain.move), f(chain.accepted), f(chain.prediction);
}

}  // namespace

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
    these.append(those.begin(), those.end());
  };
  follow(model, more.model);
  follow(theta, more.theta);
  follow(log_prior, more.log_prior);
  follow(log_likelihood, more.log_likelihood);
  follow(move, more.move);
  follow(accepted, more.accepted);
  follow(prediction, more.prediction);
}

void Chain::keep_in(const std::filesystem::path& folder) {
  for_each_list(*this, [&](auto& list) { list.keep_in(folder); });
}

void Chain::reserve(std::size_t draws, std::size_t dimension, std::size_t predictions) {
  model.reserve(draws);
  theta.reserve(draws * dimension);
  log_prior.reserve(draws);
  log_likelihood.reserve(draws);
  move.reserve(draws);
  accepted.reserve(draws);
  prediction.reserve(draws * predictions);
}

std::size_t Chain::bytes() const {
  std::size_t bytes = 0;
  for_each_list(*this, [&](const auto& list) { bytes += list.size() * sizeof(list[0]); });
  return bytes;
}

void Chain::settle() const {
  for_each_list(*this, [](const auto& list) { list.settle(); });
}

void Chain::let_go() const {
  for_each_list(*this, [](const auto& list) { list.let_go(); });
}

}  // namespace wheeltap::inference
