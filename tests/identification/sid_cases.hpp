// A small chain for several tests.
#pragma once

#include "identification/sid/sid_problem.hpp"
#include "identification/sid/sid_record.hpp"
#include "identification/sid/sid_simulation.hpp"

namespace wheeltap::identification {

/// Linear and Duffing models for 200 samples at 100 Hz of a Duffing oscillator under white noise: k
/// is parameter 0, k3 parameter 1. Without its record.
inline SidCase small_sid_case() {
  using dynamics::Coefficient;
  const dynamics::Link linear{
      .a = 0, .b = 1, .stiffness = Coefficient::of_parameter(0), .damping = 0.1, .laws = {}};
  dynamics::Link duffing = linear;
  duffing.laws.push_back(dynamics::make_law<dynamics::laws::Cubic>({Coefficient::of_parameter(1)}));
  SidCase out;
  out.title = "small";
  out.parameters = {{"k", inference::Uniform{0.0, 100.0}}, {"k3", inference::Uniform{0.0, 1e4}}};
  out.channels = {{.column = "force [N]", .role = SidChannel::Role::force, .mass = 1},
                  {.column = "displacement [m]", .role = SidChannel::Role::response, .mass = 1}};
  out.models = {{.name = "linear",
                 .weight = 0.5,
                 .chain = {.masses = {0.5}, .links = {linear}},
                 .noise = {0.05},
                 .parameters = {0}},
                {.name = "duffing",
                 .weight = 0.5,
                 .chain = {.masses = {0.5}, .links = {duffing}},
                 .noise = {0.05},
                 .parameters = {0, 1}}};
  out.truth = SidTruth{.model = 1,
                       .theta = {50.0, 1000.0},
                       .noise = {0.05},
                       .samples = 200,
                       .sample_rate_hz = 100.0,
                       .excitations = {{.mass = 1, .signal = TrueExcitation::White{100.0}}}};
  return out;
}

/// Adds the record of the case's truth, of which `use` is scored.
inline SidCase simulated(SidCase sid_case, const RecordUse& use = {}) {
  sid_case.simulated = true;
  take_record(sid_case, simulate_record(sid_case, sid_case.truth.value().seed), use);
  return sid_case;
}

inline double log_likelihood(const SidProblem& problem, int model, const std::vector<double>& x) {
  return problem.problem.likelihood()->log_likelihood(model, x);
}

}  // namespace wheeltap::identification
