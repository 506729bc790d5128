#include "identification/structural/damage/findings/baseline_findings.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "identification/structural/damage/findings/unpacked_draws.hpp"

namespace wheeltap::identification {
namespace {

using inference::Posterior;

constexpr int kCheckedPoints = 24;

double bounded(double z) {
  return std::clamp(z, -8.0, 8.0);
}

double correlation(std::span<const double> a, std::span<const double> b,
                   std::span<const double> weights) {
  double w = 0.0, ma = 0.0, mb = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    w += weights[i];
    ma += weights[i] * a[i];
    mb += weights[i] * b[i];
  }
  ma /= w;
  mb /= w;
  double aa = 0.0, bb = 0.0, ab = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    aa += weights[i] * (a[i] - ma) * (a[i] - ma);
    bb += weights[i] * (b[i] - mb) * (b[i] - mb);
    ab += weights[i] * (a[i] - ma) * (b[i] - mb);
  }
  return aa > 0.0 && bb > 0.0 ? ab / std::sqrt(aa * bb) : 0.0;
}

std::vector<double> ranks(const std::vector<double>& x) {
  std::vector<std::size_t> order(x.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return x[i]; });
  std::vector<double> out(x.size());
  for (std::size_t r = 0; r < order.size(); ++r) out[order[r]] = static_cast<double>(r);
  return out;
}

}  // namespace

Contraction contraction_of(std::string name, const inference::Prior& prior,
                           std::span<const double> x, std::span<const double> z,
                           std::span<const double> weights) {
  double sum = 0.0, mean = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < z.size(); ++i) {
    sum += weights[i];
    mean += weights[i] * z[i];
  }
  mean /= sum;
  for (std::size_t i = 0; i < z.size(); ++i)
    squares += weights[i] * (z[i] - mean) * (z[i] - mean) / sum;
  return {.name = std::move(name),
          .contraction = 1.0 - squares,
          .shift = mean,
          .bound = bound_of(prior, x, weights)};
}

BaselineFindings baseline_findings(const DamageProblem& problem, const Posterior& posterior) {
  const UnpackedDraws draws(problem, posterior);
  const auto& space = draws.space();
  const auto width = static_cast<std::size_t>(posterior.dimension);
  BaselineFindings out{.check = problem.states()->check(kCheckedPoints)};

  std::vector<std::vector<double>> all;  // standard normal coordinates z of each parameter
  std::vector<double> weights;
  draws.for_each([&](std::size_t c, std::size_t i) { weights.push_back(draws.weight(c, i)); });
  for (int p = problem.first_theta; p < problem.first_theta + problem.structural; ++p) {
    const inference::Prior& prior = space.prior(0, p);
    std::vector<double> x, z;
    draws.for_each([&](std::size_t c, std::size_t i) {
      x.push_back(posterior.chains[c].theta[i * width + static_cast<std::size_t>(p)]);
      z.push_back(bounded(prior.to_standard_normal(x.back())));
    });
    const std::string name = space.parameter_name(0, p);
    out.contractions.push_back(contraction_of(name, prior, x, z, weights));
    out.marginals.push_back(marginal(
        {x}, posterior.log_weight.empty() ? inference::ChainsOf{} : inference::ChainsOf{weights}));
    out.priors.push_back(prior.describe());
    for (std::size_t q = 0; q < all.size(); ++q)
      if (const double r = correlation(all[q], z, weights); std::abs(r) > kEntangled)
        out.entangled.push_back({out.contractions[q].name, name, r});
    all.push_back(std::move(z));
  }

  for (int m = 0; m < space.size(); ++m) {
    std::vector<std::size_t> here;  // indices in `weights`
    std::vector<const double*> thetas;
    std::size_t at = 0;
    draws.for_each([&](std::size_t c, std::size_t i) {
      if (draws.model(c, i) == m) {
        here.push_back(at);
        thetas.push_back(posterior.chains[c].theta.data() + i * width);
      }
      ++at;
    });
    double share = 0.0;
    for (const std::size_t i : here) share += weights[i];
    if (share < kWorthReporting * std::reduce(weights.begin(), weights.end())) continue;
    const std::vector<double> equal(here.size(), 1.0);
    for (int s = problem.common; s < space[m].dimension; ++s) {
      std::vector<double> severity;
      for (const double* x : thetas)
        severity.push_back(bounded(space.prior(m, s).to_standard_normal(x[s])));
      const std::string label = space.parameter_name(m, s);
      if (label.starts_with("location")) continue;  // the sign of a location has no meaning
      for (std::size_t q = 0; q < all.size(); ++q) {
        std::vector<double> z;
        for (const std::size_t i : here) z.push_back(all[q][i]);
        if (const double r = correlation(ranks(z), ranks(severity), equal);
            std::abs(r) > kEntangled)
          out.hidden.push_back({space[m].name, out.contractions[q].name, label, r});
      }
    }
  }
  return out;
}

}  // namespace wheeltap::identification
