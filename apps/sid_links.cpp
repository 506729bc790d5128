#include "apps/sid_links.hpp"

#include <algorithm>

#include "apps/sid_summary.hpp"
#include "dynamics/link_tension.hpp"

namespace wheeltap::apps {
namespace {

constexpr double kWorthTelling = 0.05;  // models with less probability are not drawn
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

Report curve(const dynamics::Link& link, const std::vector<std::vector<double>>& draws,
             const Eigen::VectorXd& extension) {
  const double low = extension.minCoeff(), high = extension.maxCoeff();
  Report x = Report::array(), lower = x, middle = x, upper = x;
  std::vector<double> tension(draws.size());
  for (int i = 0; i < kPoints; ++i) {
    const double e = low + (high - low) * i / (kPoints - 1);
    std::ranges::transform(draws, tension.begin(), [&](const std::vector<double>& theta) {
      return dynamics::resting_tension(link, theta, e);
    });
    std::ranges::sort(tension);
    x.push_back(e);
    lower.push_back(quantile(tension, 0.025));
    middle.push_back(quantile(tension, 0.5));
    upper.push_back(quantile(tension, 0.975));
  }
  return {{"between", {link.a, link.b}},
          {"extension", x},
          {"tension", {{"q2.5", lower}, {"q50", middle}, {"q97.5", upper}}}};
}

}  // namespace

Report link_laws(const SidProblem& problem, const inference::Posterior& posterior,
                 const Report& models) {
  Report out = Report::object();
  for (int m = 0; m < problem.problem.space.size(); ++m) {
    if (models[static_cast<std::size_t>(m)]["probability"].get<double>() < kWorthTelling ||
        models[static_cast<std::size_t>(m)]["visited"] == 0) {
      continue;
    }
    const Eigen::MatrixXd z = displacements(problem, m, posterior_mean(problem, posterior, m));
    if (z.rows() == 0) continue;
    const auto draws = draws_of(problem, posterior, m);
    const auto mass = [&](int i) -> Eigen::VectorXd {
      return i == 0 ? Eigen::VectorXd(Eigen::VectorXd::Zero(z.rows()))
                    : Eigen::VectorXd(z.col(i - 1));
    };
    Report links = Report::array();
    for (const auto& link : problem.sid_case.models[static_cast<std::size_t>(m)].chain.links) {
      const Eigen::VectorXd e = mass(link.b) - mass(link.a);
      if (e.maxCoeff() > e.minCoeff()) links.push_back(curve(link, draws, e));
    }
    out[problem.problem.space[m].name] = std::move(links);
  }
  return out;
}

}  // namespace wheeltap::apps
