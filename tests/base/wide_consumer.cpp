// An external program, compiled for this machine's processor, that frees memory allocated by the
// library. Regression: it crashed in free() when both disagreed on Eigen's alignment.
#include <cstdio>

#include "fem/beam/modal_analysis.hpp"
#include "fem/sections/section.hpp"

int main() {
  namespace fem = wheeltap::fem;
  const fem::Beam beam = {
      .length = 1.0,
      .elements = 20,
      .supports = fem::named_supports("cantilever", 1.0),
      .material = {.young = 70e9, .poisson = 0.3, .density = 2700.0},
      .section = fem::section(fem::Rectangle{.width = 0.025, .height = 0.006}, 0.3)};
  for (int modes = 1; modes < 12; ++modes) {
    fem::Modes found = fem::modal_analysis(beam, {}, {.modes = modes});
    found.frequencies_hz.conservativeResize(modes + 5);
    found.shapes.conservativeResize(found.shapes.rows(), modes + 3);
    if (!(found.frequencies_hz[0] > 0.0)) return 1;
  }
  std::puts("done");
}
