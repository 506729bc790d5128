// Identifies number, locations and severities of the damages of a cantilever from its five lowest
// frequencies with 0.1 % noise. True damage: the element at 0.33 m has lost 30 % of its stiffness.
#include <cstdio>

#include "fem/sections/section.hpp"
#include "identification/structural/damage/findings/damage_findings.hpp"
#include "identification/structural/defects/reduction.hpp"

using namespace wheeltap;
using namespace wheeltap::identification;

int main() {
  // The intact beam: aluminium, 1 m x 25 mm x 6 mm.
  const fem::Beam beam = {
      .length = 1.0,
      .elements = 40,
      .supports = fem::named_supports("cantilever", 1.0),
      .material = {.young = 70e9, .poisson = 0.3, .density = 2700.0},
      .section = fem::section(fem::Rectangle{.width = 0.025, .height = 0.006}, 0.3)};

  // The possible damage: zero to two elements with reduced stiffness, at any location.
  const DefectKind damage = {.type = &defects::kReduction,
                             .name = "damage",
                             .plural = "damages",
                             .max_count = 2,
                             .location = inference::Uniform{0.0, 1.0},
                             .severity = inference::Prior(inference::Uniform{0.0, 0.9})};

  // The measured frequencies; in this example, the frequencies of the model with the true damage.
  FrequencyData data;
  data.frequencies_hz = elastic_frequencies(beam, {.damages = {{0.33, 0.3}}}, 5);
  for (const double f : data.frequencies_hz) data.sd_hz.push_back(0.001 * f);

  const auto problem = make_damage_problem({.beam = beam, .data = data, .kinds = {damage}}, {});
  const auto posterior = inference::reversible_jump(problem->problem, {.seed = 1});
  const DamageFindings found = damage_findings(*problem, posterior, {}, 1);

  for (const ModelFinding& model : found.models) {
    std::printf("%s: P = %.3f +- %.3f\n", model.name.c_str(), model.probability(),
                model.standing.mcse);
    for (const ParameterFinding& p : model.parameters) {
      std::printf("    %-14s %.3f, 95 %% interval %.3f to %.3f\n", p.unknown.label.c_str(),
                  p.estimate.q50, p.estimate.q2_5, p.estimate.q97_5);
    }
  }
  std::puts(found.sampling.verdict.converged ? "converged" : "NOT converged");
}
