#include "inference/search/simulated_annealing.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "base/constants.hpp"
#include "base/random.hpp"

namespace wheeltap::inference {

Optimum maximise_by_annealing(const Objective& objective, int dimension,
                              const AnnealingOptions& options) {
  const auto require = [](bool fine, const char* name, double value, const char* bound) {
    if (!fine)
      throw std::invalid_argument(std::string("annealing: ") + name + " = " +
                                  std::to_string(value) + ", must be " + bound);
  };
  constexpr long kStarts = 50;
  require(dimension >= 1, "dimension", dimension, ">= 1");
  require(options.evaluations > kStarts, "evaluations", static_cast<double>(options.evaluations),
          "> 50");
  require(options.start_sd > 0.0, "start_sd", options.start_sd, "> 0");
  require(options.initial_temperature >= 0.0, "initial_temperature", options.initial_temperature,
          ">= 0");
  require(options.final_temperature > 0.0, "final_temperature", options.final_temperature, "> 0");
  require(options.bound > 0.0, "bound", options.bound, "> 0");

  const auto d = static_cast<std::size_t>(dimension);
  base::Random random(options.seed, 1, 0, base::Purpose::start);
  Optimum result{std::vector<double>(d, 0.0), -kInfinity, 0, false};
  const auto evaluate = [&](const std::vector<double>& z) {
    ++result.evaluations;
    const double value = objective(z);
    if (value > result.value) {
      result.value = value;
      result.z = z;
    }
    return std::isnan(value) ? -kInfinity : value;
  };

  std::vector<double> z(d);
  double sum = 0.0, squares = 0.0, finite = 0.0;
  for (long i = 0; i < kStarts; ++i) {
    for (double& x : z)
      x = std::clamp(options.start_sd * random.normal(), -options.bound, options.bound);
    const double value = evaluate(z);
    if (value == -kInfinity) continue;
    finite += 1.0;
    sum += value;
    squares += value * value;
  }
  double hottest = options.initial_temperature;
  if (hottest == 0.0 && finite > 1.0)
    hottest = std::sqrt(std::max(0.0, squares / finite - sum / finite * (sum / finite)));
  hottest = std::max(hottest, 10.0 * options.final_temperature);

  z = result.z;
  double current = result.value;
  std::vector<double> log_step(d, std::log(options.start_sd));
  const long steps = options.evaluations - kStarts;
  const double cooling = std::log(options.final_temperature / hottest) / static_cast<double>(steps);
  for (long step = 0; step < steps; ++step) {
    const double temperature = hottest * std::exp(cooling * static_cast<double>(step));
    if (step == steps - steps / 5) {  // what remains is spent on the best mode met
      z = result.z;
      current = result.value;
    }
    const auto j = static_cast<std::size_t>(random.index(dimension));
    const double before = z[j];
    z[j] += std::exp(log_step[j]) * random.normal() / std::max(1e-6, std::fabs(random.normal()));
    const double value = std::fabs(z[j]) > options.bound ? -kInfinity : evaluate(z);
    const bool accept =
        value > -kInfinity &&
        (current == -kInfinity || std::log(random.uniform()) * temperature < value - current);
    // A gain that does not fall: the target changes with the temperature all along.
    log_step[j] = std::clamp(log_step[j] + 0.1 * ((accept ? 1.0 : 0.0) - 0.44), -25.0,
                             std::log(10.0 * options.start_sd));
    if (accept) {
      current = value;
    } else {
      z[j] = before;
    }
  }
  result.converged =
      result.value > -kInfinity && result.value - current < 100.0 * options.final_temperature;
  return result;
}

}  // namespace wheeltap::inference
