#include "inference/moves/self_tests.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "base/constants.hpp"
#include "base/number.hpp"
#include "inference/statistics/standard_normal.hpp"

namespace wheeltap::inference {
namespace {

std::string at(double z, double x) {
  return "at z = " + base::number(z) + ", x = " + base::significant(x, 6) + ": ";
}

// Change of z if x, or its distance from 0, is rounded to a double.
double resolution(const Prior& prior, double x) {
  const double step = 4e-16 * (std::fabs(x) + 1e-300);
  return prior.to_standard_normal(x + step) - prior.to_standard_normal(x - step);
}

// p(x(z)) dx/dz / φ(z), with dx/dz by fourth-order differences. std::nullopt if x does not resolve
// the differences.
struct Ratio {
  double value, error;  // error due to rounding
};
std::optional<Ratio> density_over_slope(const Prior& prior, double z, double x) {
  constexpr double kStep = 5e-3, kSmallest = 5e-6, kMost = 0.04;
  const auto beside = [&](double d) { return prior.from_standard_normal(z + d); };
  // Uses short steps if x spans orders of magnitude, because no polynomial approximates x there.
  const double spread = beside(2 * kStep) - beside(-2 * kStep);
  const double step = std::clamp(kStep * kMost * std::fabs(x) / spread, kSmallest, kStep);
  const double slope =
      (8.0 * (beside(step) - beside(-step)) - (beside(2 * step) - beside(-2 * step))) /
      (12.0 * step);
  const double rounding = 4e-15 * std::fabs(x) / step;
  if (!(slope > 0.0 && std::isfinite(slope)) || rounding > 0.1 * slope) return std::nullopt;
  return Ratio{std::exp(prior.log_density(x) + std::log(slope) + 0.5 * z * z + kLogSqrt2Pi),
               4.0 * rounding / slope};
}

// A function of model and z between -1 and 1: a wave over one or two coordinates, with one
// amplitude per model.
struct Wave {
  std::vector<double> amplitudes;
  std::array<std::size_t, 2> coordinates;
  std::array<double, 2> frequencies;
  double phase;

  Wave(base::Random& random, int models, int dimension) {
    for (int m = 0; m < models; ++m) amplitudes.push_back(2.0 * random.uniform() - 1.0);
    for (auto& c : coordinates)
      c = static_cast<std::size_t>(random.uniform() * std::max(1, dimension));
    frequencies = {random.normal(), random.uniform() < 0.5 ? 0.0 : random.normal()};
    phase = 2.0 * std::numbers::pi * random.uniform();
  }

  [[nodiscard]] double operator()(const State& state) const {
    double angle = phase;
    for (std::size_t i = 0; i < coordinates.size() && !state.z.empty(); ++i)
      angle += frequencies[i] * state.z[coordinates[i] % state.z.size()];
    return amplitudes[static_cast<std::size_t>(state.model)] * std::cos(angle);
  }
};

// Sums of w (g(x) h(y) - h(x) g(y)) and of its square.
struct Balance {
  Wave g, h;
  bool invariance;  // h = 1
  double sum = 0.0, squares = 0.0;
  long terms = 0;

  void add(double weight, const State& x, const State& y) {
    const double d = invariance ? g(x) - g(y) : g(x) * h(y) - h(x) * g(y);
    if (d == 0.0) return;
    ++terms;
    sum += weight * d;
    squares += weight * weight * d * d;
  }
  // p-value of a zero mean; 1 for too few terms.
  [[nodiscard]] double p_value() const {
    if (terms < 30 || !(squares > 0.0)) return 1.0;
    return 2.0 * normal_cdf(-std::fabs(sum) / std::sqrt(squares));
  }
};

// Computes exp(factor + β log likelihood), scaled to a largest value of 1; false if all are 0.
bool weigh_tests(const std::vector<State>& states, double beta, std::vector<double>& weights) {
  double top = -kInfinity;
  for (std::size_t n = 0; n < states.size(); ++n) {
    const State& s = states[n];
    const bool possible = std::isfinite(s.log_likelihood) && std::isfinite(s.log_prior_factor);
    weights[n] = possible ? s.log_prior_factor + beta * s.log_likelihood : -kInfinity;
    top = std::max(top, weights[n]);
  }
  if (top == -kInfinity) return false;
  for (double& w : weights) w = std::exp(w - top);
  return true;
}

double effective(const std::vector<double>& weights) {
  double sum = 0.0, squares = 0.0;
  for (const double w : weights) {
    sum += w;
    squares += w * w;
  }
  return sum * sum / squares;
}

std::string in_words(const MoveCheck& check, double false_alarm) {
  const auto counts = [](long accepted, long proposed) {
    return std::to_string(accepted) + " of " + std::to_string(proposed) + " proposals accepted";
  };
  if (check.proposed == 0) return "the move made no proposal from any draw of the prior";
  std::string text = counts(check.accepted, check.proposed);
  if (check.jumps_proposed > 0)
    text += ", between models " + counts(check.jumps_accepted, check.jumps_proposed);
  if (check.accepted == 0) return text + ": detailed balance could not be tested";
  text += check.passed ? "; no fault found" : "; detailed balance is VIOLATED";
  return text + " (p = " + base::significant(check.p_value, 2) + ", limit " +
         base::significant(false_alarm, 2) + "), with the likelihood to the powers 0 and " +
         base::significant(check.beta, 2);
}

}  // namespace

PriorCheck check_prior(const Prior& prior) {
  constexpr double kStep = 1.0 / 64.0;
  constexpr int kHalf = 6 * 64;
  constexpr int kKink = 3;  // number of positions that a kink of the density affects
  PriorCheck check;
  double previous = -kInfinity, smallest = kInfinity, largest = 0.0, weight = 0.0;
  int in_a_row = 0, most = 0;
  std::string worst;
  for (int i = -kHalf; i <= kHalf; ++i) {
    const double z = kStep * i;
    const double x = prior.from_standard_normal(z);
    const auto fault = [&](const std::string& what) { check.faults.push_back(at(z, x) + what); };
    if (std::isnan(x) || x < prior.lower() || x > prior.upper())
      fault("the quantile lies outside the support, [" + base::number(prior.lower()) + ", " +
            base::number(prior.upper()) + "]");
    else if (x < previous)
      fault("the quantile decreases");
    else if (std::isnan(prior.log_density(x)))
      fault("the log density is not a number");
    if (!check.passed()) return check;
    previous = x;
    const double back = prior.to_standard_normal(x), grain = resolution(prior, x);
    if (!std::isfinite(grain)) continue;  // at a bound of the support
    if (!(std::fabs(back - z) <= 1e-7 + 4.0 * grain)) {
      fault("the distribution function at this x gives z = " + base::significant(back, 6));
      return check;
    }
    const std::optional<Ratio> ratio = density_over_slope(prior, z, x);
    if (!ratio) continue;
    const double phi = std::exp(-0.5 * z * z);
    weight += phi;
    check.mass += phi * ratio->value;
    if (std::fabs(ratio->value - 1.0) <= 1e-5 + ratio->error) {
      in_a_row = 0;
      continue;
    }
    most = std::max(most, ++in_a_row);
    if (in_a_row <= kKink) continue;
    if (worst.empty()) worst = at(z, x);
    largest = std::max(largest, ratio->value);
    smallest = std::min(smallest, ratio->value);
  }
  check.mass = weight > 0.0 ? check.mass / weight : 1.0;
  if (most <= kKink) return check;
  if (largest / smallest < 1.0 + 1e-4)
    check.faults.push_back("the density integrates to " + base::significant(check.mass, 9) +
                           ": it must be normalised");
  else
    check.faults.push_back(worst + "the density is " + base::significant(smallest, 4) + " to " +
                           base::significant(largest, 4) +
                           " times the derivative of the distribution function");
  return check;
}

MoveCheck check_move(const Problem& problem, const std::function<std::unique_ptr<Move>()>& make,
                     const MoveCheckOptions& options) {
  if (options.draws < 100)
    throw std::invalid_argument("check_move: draws = " + std::to_string(options.draws) +
                                ", must be 100 or more");
  Target target(problem, false);
  base::Random random(options.seed, 0, 0, base::Purpose::test);
  std::vector<State> states(static_cast<std::size_t>(options.draws));
  for (State& state : states) {
    target.draw_prior(random, state);
    target.evaluate(state);
  }
  std::vector<double> weights(states.size());
  if (!weigh_tests(states, 0.0, weights))
    throw std::invalid_argument(
        "check_move: prior factor and likelihood are not finite at any of " +
        std::to_string(options.draws) + " draws of the prior");
  MoveCheck check;
  check.beta = 1.0;
  const auto carried = [&] { return weigh_tests(states, check.beta, weights), effective(weights); };
  while (check.beta > 0.0 && carried() < 0.05 * options.draws)
    check.beta = check.beta > 1e-12 ? 0.5 * check.beta : 0.0;

  constexpr int kPairs = 32;  // pairs of functions at each of two powers β
  const int models = problem.space.size(), dimension = problem.space.max_dimension();
  const std::unique_ptr<Move> move = make();
  for (const double beta : {0.0, check.beta}) {
    std::vector<Balance> balances;
    for (int i = 0; i < kPairs; ++i)
      balances.push_back(
          {Wave(random, models, dimension), Wave(random, models, dimension), i % 4 == 0});
    weigh_tests(states, beta, weights);
    for (std::size_t n = 0; n < states.size(); ++n) {
      if (!(weights[n] > 0.0)) continue;
      State next = states[n];
      next.screened = next.evaluated = false;
      const auto log_hastings = move->propose(states[n], {target, random, beta, false}, next);
      if (!log_hastings) continue;
      if (!next.evaluated) target.evaluate(next);
      // Takes the expectation over acceptance, because rare acceptances would get too much weight.
      const double log_alpha = log_target_ratio(target, beta, states[n], next) + *log_hastings;
      const double alpha = std::isnan(log_alpha) ? 0.0 : std::exp(std::min(0.0, log_alpha));
      const bool accepted = random.uniform() < alpha, jump = next.model != states[n].model;
      ++check.proposed;
      check.accepted += accepted ? 1 : 0;
      check.jumps_proposed += jump ? 1 : 0;
      check.jumps_accepted += jump && accepted ? 1 : 0;
      if (!(alpha > 0.0)) continue;
      for (Balance& balance : balances) balance.add(weights[n] * alpha, states[n], next);
    }
    for (const Balance& balance : balances)
      check.p_value = std::min(check.p_value, 2 * kPairs * balance.p_value());
  }
  check.passed = check.p_value >= options.false_alarm;
  check.words = in_words(check, options.false_alarm);
  return check;
}

}  // namespace wheeltap::inference
