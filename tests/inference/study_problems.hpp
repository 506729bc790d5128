// Further problems with known answers, for the study of many dimensions and many modes
// (verdict_table --study). They take too long for the test suites.
#pragma once

#include <vector>

#include "tests/inference/hard_problems.hpp"

namespace wheeltap::inference {

/// Gaussian and autoregressive densities, funnels with normal priors, Student t densities, a
/// Rosenbrock density, a shell, and densities with 2^n or 5! equal modes, each against a model
/// without parameters.
[[nodiscard]] const std::vector<HardProblem>& study_problems();

}  // namespace wheeltap::inference
