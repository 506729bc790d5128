// How many groups? A mixture of normal distributions with an unknown number of components, each
// with a place and a share, beside the exact answer.
//
//   y_i ~ Σ_j w_j N(μ_j, 1),   μ_j ~ N(0, 3²),   w ~ Dirichlet(1, …, 1),   k = 1 … 4 alike.
//
// Shares that sum to one are no independent parameters. Gamma's are: with a_j ~ Gamma(1, 1), the
// ratios w_j = a_j / Σ a are Dirichlet's, whatever their number, so that a component brings its own
// a_j and a birth needs no others to make room.
#include <cmath>
#include <cstdio>
#include <memory>
#include <span>
#include <vector>

#include "inference/engine/reversible_jump.hpp"

using namespace wheeltap::inference;

const std::vector<double> kReadings = {-3.4, -2.6, -2.1, -1.9, 1.4, 1.9, 2.2, 2.7, 3.5};
constexpr int kMost = 4;
constexpr double kPlaces = 3.0;  // sd of the μ_j
constexpr double kLogSqrt2Pi = 0.91893853320467274178;

// x holds the components one after the other, (μ, a) each.
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

// The readings of one component, its place integrated out.
struct Group {
  int n = 0;
  double sum = 0.0, squares = 0.0;

  [[nodiscard]] double log_evidence() const {
    constexpr double kVariance = kPlaces * kPlaces;
    return -n * kLogSqrt2Pi - 0.5 * std::log(1.0 + n * kVariance) -
           0.5 * (squares - sum * sum * kVariance / (1.0 + n * kVariance));
  }
};

// Σ over all ways to give readings i, i+1, … to the groups. Γ(1 + n_j) is what Dirichlet's average
// of ∏ w_j^n_j makes of each group, up to Γ(k)/Γ(k + n).
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
