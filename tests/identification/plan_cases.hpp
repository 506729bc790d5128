// A planned test of a beam for several tests.
#pragma once

#include <string>
#include <utility>

#include "fem/structures/mesh.hpp"
#include "identification/planning/engine_check.hpp"
#include "identification/structural/damage/damage_problem.hpp"
#include "identification/structural/defects/reduction.hpp"

namespace wheeltap::identification::planning {

/// A simply supported beam with nine candidate sensors and at most `most` damages.
inline PlanCase beam_plan(int most) {
  PlanCase plan;
  plan.damage_case.beam = {
      .length = 1.0,
      .elements = 20,
      .supports = fem::named_supports("simply-supported", 1.0),
      .material = {.young = 70e9, .poisson = 0.3, .density = 2700.0},
      .section = {.area = 1.5e-4, .second_moment = 4.5e-10, .shear_coefficient = 0.85}};
  DefectKind kind{.type = &defects::kReduction,
                  .name = "damage",
                  .plural = "damages",
                  .max_count = most,
                  .location = inference::Uniform{0.0, 1.0},
                  .severity = inference::Prior(inference::Uniform{0.0, 0.6})};
  kind.line = SiteLine::of_beam(plan.damage_case.beam);
  plan.damage_case.kinds = {std::move(kind)};
  plan.damage_case.data.frequencies_hz = {1.0};
  plan.damage_case.data.sd_hz = {1.0};
  complete(plan.damage_case);
  const fem::Structure structure = fem::as_structure(plan.damage_case.beam);
  const fem::Mesh mesh(structure);
  for (int i = 1; i < 10; ++i)
    plan.structure.candidates.push_back(
        {std::to_string(i), mesh.motion(0, 0.1 * i, fem::Direction::y)});
  plan.structure.modes = 5;
  plan.noise = {.seconds = 600.0, .damping = 0.005, .shape_sd = 0.01, .reference_seconds = 600.0};
  plan.choose = 3;
  return plan;
}

}  // namespace wheeltap::identification::planning
