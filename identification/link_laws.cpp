#include "identification/link_laws.hpp"

#include <algorithm>

#include "dynamics/link_tension.hpp"
#include "identification/marginal.hpp"
#include "identification/sid_fit.hpp"

namespace wheeltap::identification {
namespace {

constexpr std::size_t kMostDraws = 400;
constexpr int kPoints = 41;

// Parameters of the case for draws of a model, evenly spread over the chains.
std::vector<std::vector<double>> draws_of(const SidProblem& problem,
                                          const inference::Posterior& posterior, int model) {
  std::vector<std::pair<std::size_t, std::size_t>> at;
  for (std::size_t c = 0; c < posterior.chains.size(); ++c) {
    for (std::size_t i = 0; i < posterior.chains[c].model.size(); ++i) {
      if (posterior.chains[c].model[i] == model) at.emplace_back(c, i);
    }
  }
  const auto width = static_cast<std::size_t>(posterior.dimension);
  const std::size_t n = std::min(at.size(), kMostDraws);
  std::vector<std::vector<double>> draws;
  for (std::size_t j = 0; j < n; ++j) {
    const auto [c, i] = at[j * at.size() / n];
    draws.push_back(problem.theta(model, {posterior.chains[c].theta.data() + i * width, width}));
  }
  return draws;
}

// Displacements of the masses relative to the base, samples × masses.
Eigen::MatrixXd displacements(const SidProblem& problem, int model,
                              const std::vector<double>& theta) {
  const SidModel& m = problem.sid_case.models[static_cast<std::size_t>(model)];
  const dynamics::Simulator& simulator =
      problem.misfits[static_cast<std::size_t>(model)].simulator();
  std::vector<dynamics::Sensor> sensors;
  for (int mass = 1; mass <= m.chain.size(); ++mass) {
    sensors.push_back({.mass = mass,
                       .quantity = dynamics::Quantity::displacement,
                       .frame = dynamics::Frame::relative});
  }
  return dynamics::Simulator(m.chain, problem.sid_case.excitation(), sensors, m.initial,
                             simulator.options())
      .simulate(theta)
      .values;
}

LinkCurve curve(const dynamics::Link& link, const std::vector<std::vector<double>>& draws,
                const Eigen::VectorXd& extension) {
  const double low = extension.minCoeff(), high = extension.maxCoeff();
  LinkCurve out;
  out.a = link.a, out.b = link.b;
  std::vector<double> tension(draws.size());
  for (int i = 0; i < kPoints; ++i) {
    const double e = low + (high - low) * i / (kPoints - 1);
    std::ranges::transform(draws, tension.begin(), [&](const std::vector<double>& theta) {
      return dynamics::resting_tension(link, theta, e);
    });
    std::ranges::sort(tension);
    out.extension.push_back(e);
    out.q2_5.push_back(quantile(tension, 0.025));
    out.q50.push_back(quantile(tension, 0.5));
    out.q97_5.push_back(quantile(tension, 0.975));
  }
  return out;
}

}  // namespace

std::optional<std::vector<LinkCurve>> link_laws(const SidProblem& problem,
                                                const inference::Posterior& posterior, int model) {
  const Eigen::MatrixXd z =
      displacements(problem, model, posterior_mean(problem, posterior, model));
  if (z.rows() == 0) return {};
  const auto draws = draws_of(problem, posterior, model);
  const auto mass = [&](int i) -> Eigen::VectorXd {
    return i == 0 ? Eigen::VectorXd(Eigen::VectorXd::Zero(z.rows()))
                  : Eigen::VectorXd(z.col(i - 1));
  };
  std::vector<LinkCurve> out;
  for (const auto& link : problem.sid_case.models[static_cast<std::size_t>(model)].chain.links) {
    const Eigen::VectorXd e = mass(link.b) - mass(link.a);
    if (e.maxCoeff() > e.minCoeff()) out.push_back(curve(link, draws, e));
  }
  return out;
}

}  // namespace wheeltap::identification
