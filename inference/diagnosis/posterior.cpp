#include "inference/diagnosis/posterior.hpp"

#include <stdexcept>

#include "inference/diagnosis/standing.hpp"
#include "inference/diagnosis/verdict.hpp"

namespace wheeltap::inference {
namespace {

int checked(const ModelSpace& space, int model) {
  if (model < 0 || model >= space.size()) {
    throw std::invalid_argument("model = " + std::to_string(model) + " must be from 0 to " +
                                std::to_string(space.size() - 1));
  }
  return model;
}

}  // namespace

Estimate Posterior::probability(int model) const {
  checked(*space, model);
  const ModelShares shares = model_shares(*this);
  const Standings all = standings(*this, shares, mixing(*this, shares, {}));
  const ModelStanding& of = all.models[static_cast<std::size_t>(model)];
  return {.value = of.probability, .mcse = of.mcse};
}

Estimate Posterior::probability(std::string_view model) const {
  return probability(space->find(model));
}

Estimate Posterior::log_bayes_factor(int a, int b) const {
  return inference::log_bayes_factor(*this, checked(*space, a), checked(*space, b));
}

Estimate Posterior::log_bayes_factor(std::string_view a, std::string_view b) const {
  return log_bayes_factor(space->find(a), space->find(b));
}

std::pair<std::size_t, std::size_t> Posterior::best_draw() const {
  std::size_t chain = 0, place = 0;
  for (std::size_t c = 0; c < chains.size(); ++c)
    for (std::size_t i = 0; i < chains[c].log_likelihood.size(); ++i)
      if (chains[c].log_likelihood[i] > chains[chain].log_likelihood[place]) chain = c, place = i;
  return {chain, place};
}

bool Posterior::converged() const {
  return judge(*this).converged;
}

std::vector<Reason> Posterior::why_not() const {
  return judge(*this).not_established;
}

ChainsOf Posterior::draws_of(std::string_view parameter, int model) const {
  std::string known;
  int at = -1;
  for (int i = 0; i < (*space)[checked(*space, model)].dimension; ++i) {
    const std::string name = space->parameter_name(model, i);
    if (name == parameter) at = i;
    known += (i == 0 ? "'" : ", '") + name + "'";
  }
  if (at < 0) {
    throw std::invalid_argument("model '" + (*space)[model].name + "' has no parameter '" +
                                std::string(parameter) + "' among " +
                                (known.empty() ? "none" : known));
  }
  ChainsOf out;
  for (const Chain& chain : chains) {
    std::vector<double>& values = out.emplace_back();
    for (std::size_t i = 0; i < chain.size(); ++i) {
      if (chain.model[i] == model) {
        values.push_back(chain.draw(i, *space).theta[static_cast<std::size_t>(at)]);
      }
    }
    chain.let_go();
  }
  return out;
}

ChainsOf Posterior::draws_of(std::string_view parameter, std::string_view model) const {
  return draws_of(parameter, space->find(model));
}

ChainsOf Posterior::indicator(int model) const {
  ChainsOf out;
  for (const Chain& chain : chains) {
    std::vector<double>& values = out.emplace_back();
    for (const int m : chain.model) values.push_back(m == model ? 1.0 : 0.0);
  }
  return out;
}

}  // namespace wheeltap::inference
