// Selects the degree of a polynomial. This is a minimal complete use of the engine: define the
// models, the priors of their parameters, and the likelihood. The engine chooses all other
// settings.
//
//   y_i = a + b t_i (+ c t_i²) + noise,   t in [-1, 1], unknown standard deviation of the noise.
#include <cmath>
#include <cstdio>
#include <memory>
#include <span>
#include <vector>

#include "inference/engine/reversible_jump.hpp"

using namespace wheeltap::inference;
namespace base = wheeltap::base;

// Twelve readings of -0.2 + 0.9 t + 0.35 t² with noise of standard deviation 0.2 (seed 2016).
std::vector<double> readings() {
  base::Random random(2016, 0, 0, base::Purpose::simulation);
  std::vector<double> y;
  for (int i = 0; i < 12; ++i) {
    const double t = -1.0 + 2.0 * i / 11.0;
    y.push_back(-0.2 + 0.9 * t + 0.35 * t * t + 0.2 * random.normal());
  }
  return y;
}

// x contains the parameters in the order of the model: a, b, noise and, for the parabola, c.
class Readings : public Likelihood {
 public:
  explicit Readings(std::vector<double> y) : y_(std::move(y)) {}

  double log_likelihood(int /*model*/, std::span<const double> x) override {
    double sum = 0.0;
    for (std::size_t i = 0; i < y_.size(); ++i) {
      const double t = -1.0 + 2.0 * static_cast<double>(i) / static_cast<double>(y_.size() - 1);
      const double predicted = x[0] + x[1] * t + (x.size() > 3 ? x[3] * t * t : 0.0);
      const double r = (y_[i] - predicted) / x[2];
      sum +=
          -0.5 * r * r - std::log(x[2] * 2.50662827463100050242);  // with the normalising constant
    }
    return sum;
  }

 private:
  std::vector<double> y_;
};

int main() {
  const std::vector<double> y = readings();
  const Problem problem{
      .space = ModelSpace::of_models(
          {{"a", Normal{0.0, 1.0}},
           {"b", Normal{0.0, 1.0}},
           {"noise", LogUniform{0.01, 1.0}},
           {"c", Normal{0.0, 1.0}}},
          {{"line", 0.5, {"a", "b", "noise"}}, {"parabola", 0.5, {"a", "b", "noise", "c"}}}),
      .likelihood = [&] { return std::make_unique<Readings>(y); }};

  const Posterior posterior = reversible_jump(problem, {.seed = 1});

  const Estimate p = posterior.probability("parabola");
  const Estimate bayes_factor = posterior.log_bayes_factor("parabola", "line");
  std::printf("P(parabola | readings) = %.3f ± %.3f\n", p.value, p.mcse);
  std::printf("ln of the Bayes factor against a line: %.2f ± %.2f\n", bayes_factor.value,
              bayes_factor.mcse);
  std::printf("posterior mean of c, given a parabola: %.2f (true value: 0.35)\n",
              mean(posterior.draws_of("c", "parabola")));
  std::printf("%ld likelihood evaluations, %s\n", posterior.likelihood_evaluations,
              posterior.converged() ? "converged" : "not converged:");
  for (const Reason& reason : posterior.why_not())
    std::printf("  %s\n", describe(reason, *posterior.space).c_str());
  return 0;
}
