// Comparison of measured frequencies of a structure after damage with those before damage.
#pragma once

#include <vector>

#include "identification/structural/damage/damage_case.hpp"

namespace wheeltap::identification {

/// Compares the data with measured baseline frequencies b instead of the model's intact frequencies
/// m. The prediction for a mode of the damaged structure is then f(θ) b/m instead of f(θ):
///
///   f_obs m/b ~ N(f(θ), (f_obs m/b)² (s² + s_b²)),
///
/// with s and s_b the relative standard deviations of data and baseline. Model errors that multiply
/// the frequency of a mode by the same factor in both states cancel: errors of moduli, densities
/// and lengths and, to first order, small local errors away from the damage. The i-th baseline
/// frequency belongs to the i-th elastic mode of the intact model. Modes without a baseline (NaN)
/// are removed from the data. Mode shapes are not changed.
///
/// Call this function once, on a complete case. Throws InvalidInput (data) if the baseline has
/// fewer modes than the data, and for implausible factors b/m (below 1/2, above 2).
void compare_with_baseline(DamageCase& damage_case, const FrequencyData& baseline);

}  // namespace wheeltap::identification
