// Infers the number k of components of a mixture of normal densities. Each component j has a mean
// μ_j and a weight w_j. The program prints P(k) by sampling and by exact computation.
//
//   y_i ~ Σ_j w_j N(μ_j, 1),   μ_j ~ N(0, 3²),   w ~ Dirichlet(1, …, 1),   P(k) = 1/4, k = 1 … 4.
//
// The weights sum to one, so they are not independent parameters. The program therefore samples
// independent a_j ~ Gamma(1, 1); the ratios w_j = a_j / Σ a then have the Dirichlet distribution
// for any k. A birth adds one a_j and does not change the a_j of the other components.
#include <cmath>
#include <cstdio>
#include <memory>
#include <span>
#include <vector>

#include "inference/engine/reversible_jump.hpp"

using namespace wheeltap::inference;

const std::vector<double> kReadings = {-3.4, -2.6, -2.1, -1.9, 1.4, 1.9, 2.2, 2.7, 3.5};
constexpr int kMost = 4;
constexpr double kPlaces = 3.0;  // prior sd of the means μ_j
constexpr double kLogSqrt2Pi = 0.91893853320467274178;

// x contains μ_1, a_1, μ_2, a_2, …
class Mixture : public Likelihood {
 public:
  double log_likelihood(int /*model*/, std::span<const double> x) override {
    double all = 0.0;
    for (std::size_t j = 0; j < x.size(); j += 2) all += x[j + 1];
    double sum = 0.0;
    for (const double y : kReadings) {
      double density = 0.0;
      for (std::size_t j = 0; j < x.size(); j += 2)
        density += x[j + 1] / all * std::exp(-0.5 * (y - x[j]) * (y - x[j]));
      sum += std::log(density) - kLogSqrt2Pi;
    }
    return sum;
  }
};

// The readings of one component. The evidence integrates over the mean of the component.
struct Group {
  int n = 0;
  double sum = 0.0, squares = 0.0;

  [[nodiscard]] double log_evidence() const {
    constexpr double kVariance = kPlaces * kPlaces;
    return -n * kLogSqrt2Pi - 0.5 * std::log(1.0 + n * kVariance) -
           0.5 * (squares - sum * sum * kVariance / (1.0 + n * kVariance));
  }
};

// Sum of the evidence over all assignments of the readings i, i + 1, … to the groups. The mean of
// ∏ w_j^n_j over the Dirichlet prior is Γ(k)/Γ(k + n) ∏ Γ(1 + n_j), for n readings, n_j in group j.
double all_ways(std::size_t i, std::vector<Group>& groups) {
  double sum = 0.0;
  if (i == kReadings.size()) {
    for (const Group& g : groups) sum += g.log_evidence() + std::lgamma(1.0 + g.n);
    return std::exp(sum);
  }
  const double y = kReadings[i];
  for (Group& g : groups) {
    const Group before = g;
    g = {g.n + 1, g.sum + y, g.squares + y * y};
    sum += all_ways(i + 1, groups);
    g = before;
  }
  return sum;
}

double evidence(int k) {
  std::vector<Group> groups(static_cast<std::size_t>(k));
  return all_ways(0, groups) *
         std::exp(std::lgamma(k) - std::lgamma(k + static_cast<double>(kReadings.size())));
}

int main() {
  std::vector<ModelSpace::Counts> counts;
  for (int k = 1; k <= kMost; ++k) counts.push_back({{k}, 1.0});
  const ComponentKind group{
      "group", "groups", {{"place", Normal{0.0, kPlaces}}, {"a", Gamma{1.0, 1.0}}}};
  const Problem problem{.space = ModelSpace::of_components({}, {group}, counts),
                        .likelihood = [] { return std::make_unique<Mixture>(); }};
  const Posterior posterior = reversible_jump(problem, {.seed = 1});

  double total = 0.0;
  for (int k = 1; k <= kMost; ++k) total += evidence(k);
  bool right = true;
  for (int k = 1; k <= kMost; ++k) {
    const Estimate p = posterior.probability(problem.space[k - 1].name);
    const double exact = evidence(k) / total;
    std::printf("P(%-8s) = %.4f +- %.4f, exactly %.4f\n", problem.space[k - 1].name.c_str(),
                p.value, p.mcse, exact);
    right = right && std::fabs(p.value - exact) < 4.5 * p.mcse;
  }
  return right ? 0 : 1;
}
