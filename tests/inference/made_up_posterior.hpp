// Runs that were made up: independent draws of models whose probabilities are known, so that every
// answer and its error are known.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "base/constants.hpp"
#include "base/random.hpp"
#include "inference/diagnosis/posterior.hpp"

namespace wheeltap::inference::made_up {

inline constexpr int kDraws = 4000;  // a chain

inline const Evidence kUnknown{.log_evidence = kNaN, .standard_error = kNaN};

// Three models of one parameter, the third without one.
inline const ModelSpace& three() {
  static const auto space = ModelSpace::of_models(
      {{"a", Normal{0.0, 1.0}}}, {{"one", 1.0, {"a"}}, {"two", 1.0, {"a"}}, {"none", 1.0, {}}});
  return space;
}

// Independent draws of models with these probabilities (one list per chain; further chains use the
// last) and a normal parameter. Bridged evidences are exact for the first chain's probabilities.
inline Posterior run(const std::vector<std::vector<double>>& probabilities) {
  Posterior posterior;
  posterior.space = std::make_shared<const ModelSpace>(three());
  posterior.dimension = 1;
  posterior.draws = kDraws;
  posterior.likelihood_evaluations = 1;
  posterior.jumps_proposed.assign(3, std::vector<long>(3, 1234567));
  posterior.jumps_accepted.assign(3, std::vector<long>(3, 100));
  for (std::uint64_t c = 0; c < 4; ++c) {
    const auto& p = probabilities[std::min<std::size_t>(c, probabilities.size() - 1)];
    base::Random random(5, c, 0, base::Purpose::test);
    Chain chain;
    for (int i = 0; i < kDraws; ++i) {
      const double u = random.uniform();
      chain.model.push_back(u < p[0] ? 0 : u < p[0] + p[1] ? 1 : 2);
      chain.theta.push_back(chain.model.back() == 2 ? kNaN : random.normal());
      chain.log_prior.push_back(0.0);
      chain.log_likelihood.push_back(random.normal());
    }
    posterior.chains.push_back(std::move(chain));
  }
  for (const double p : probabilities.front()) {
    posterior.found.push_back(
        {.climbs = 100,
         .modes = {},
         .annealed = kUnknown,
         .sampled = kUnknown,
         .bridged = {.log_evidence = -50.0 + std::log(p), .standard_error = 0.01}});
  }
  return posterior;
}

}  // namespace wheeltap::inference::made_up
