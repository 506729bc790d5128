// Chains and excitations shared by several tests.
#pragma once

#include <random>
#include <utility>
#include <vector>

#include "dynamics/simulate.hpp"

namespace wheeltap::dynamics {

inline std::vector<double> noise(std::size_t samples, unsigned seed, double amplitude = 1.0) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> uniform(-amplitude, amplitude);
  std::vector<double> x(samples);
  for (double& value : x) value = uniform(generator);
  return x;
}

/// Masses 5 kg in series, k = 50, c = 0.1: Tiboaca 2016, section 5.2.
inline Chain uniform_chain(int masses) {
  Chain chain;
  for (int i = 0; i < masses; ++i) {
    chain.masses.emplace_back(5.0);
    chain.links.push_back({.a = i, .b = i + 1, .stiffness = 50.0, .damping = 0.1});
  }
  return chain;
}

inline std::vector<Sensor> displacements(int masses) {
  std::vector<Sensor> sensors;
  for (int i = 1; i <= masses; ++i) sensors.push_back({.mass = i});
  return sensors;
}

/// One unit mass on one link, released from displacement A without force. Unit mass, sampled at
/// `rate`.
inline Simulator released(Link link, double amplitude, double rate, std::size_t samples,
                          SimulatorOptions options) {
  Chain chain{.masses = {1.0}, .links = {std::move(link)}};
  return Simulator(chain,
                   {.sample_rate_hz = rate,
                    .forces = {{.mass = 1, .signal = {std::vector<double>(samples, 0.0)}}}},
                   {{.mass = 1},
                    {.mass = 1, .quantity = Quantity::velocity},
                    {.mass = 1, .quantity = Quantity::acceleration}},
                   {.displacement = {amplitude}, .velocity = {0.0}}, std::move(options));
}

}  // namespace wheeltap::dynamics
