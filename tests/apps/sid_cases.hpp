// A small system-identification case, and records for it.
#pragma once

#include <nlohmann/json.hpp>

#include "apps/cases/sid_case.hpp"
#include "program.hpp"

namespace wheeltap::apps {

/// Linear against Duffing, simulated: 200 samples at 100 Hz.
inline nlohmann::json small_sid_case() {
  return nlohmann::json::parse(R"({
    "kind": "sid",
    "record": {"channels": [
      {"column": "force [N]", "role": "force", "mass": 1},
      {"column": "displacement [m]", "role": "response", "mass": 1, "quantity": "displacement"}]},
    "parameters": {"k": {"uniform": [0, 100]}, "k3": {"uniform": [0, 1e4]}},
    "models": [
      {"name": "linear", "prior": 0.5, "masses": [0.5], "noise": 0.05,
       "links": [{"between": [0, 1], "stiffness": "k", "damping": 0.1}]},
      {"name": "duffing", "prior": 0.5, "masses": [0.5], "noise": 0.05,
       "links": [{"between": [0, 1], "stiffness": "k", "damping": 0.1, "cubic": "k3"}]}],
    "truth": {"model": "duffing", "parameters": {"k": 50, "k3": 1000}, "noise": 0.05,
      "samples": 200, "sample_rate": 100, "seed": 1,
      "excitation": [{"mass": 1, "kind": "white", "variance": 100}]}
  })");
}

inline SidCaseFile parse_sid(const Workspace& where, const nlohmann::json& json) {
  return parse_sid_case(read_case(where.write_json("case.json", json)));
}

}  // namespace wheeltap::apps
