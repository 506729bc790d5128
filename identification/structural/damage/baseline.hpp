// The undamaged structure as measured: damage is then what has changed.
#pragma once

#include <vector>

#include "identification/structural/damage/damage_case.hpp"

namespace wheeltap::identification {

/// Compares the data with the measured baseline b rather than with the model's own intact
/// frequencies m: the model of a damaged structure predicts f(θ) b/m, mode by mode, so that
///
///   f_obs m/b ~ N(f(θ), (f_obs m/b)² (s² + s_b²)),
///
/// s and s_b being the relative standard deviations of data and baseline. What the model does wrong
/// by a factor of each mode (moduli, densities, lengths; to first order whatever is small and not
/// where the damage is) cancels. The i-th frequency of the baseline is that of the i-th elastic
/// mode of the intact model; modes that it lacks (NaN) are left out of the data. Shapes stay as
/// they are.
///
/// Call it on a complete case, once. Throws InvalidInput (data): fewer modes in the baseline than
/// in the data, and factors that no model would excuse (below 1/2, above 2).
void compare_with_baseline(DamageCase& damage_case, const FrequencyData& baseline);

}  // namespace wheeltap::identification
