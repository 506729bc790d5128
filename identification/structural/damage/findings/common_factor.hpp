// A change of all frequencies by one factor, as the alternative to damage.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "identification/structural/damage/findings/damage_findings.hpp"
#include "identification/structural/damage/findings/unpacked_draws.hpp"

namespace wheeltap::identification {

/// The least-squares fit of one factor c to measured frequencies, c · predicted.
struct FactorFit {
  double factor = 1.0;
  double chi_square = 0.0;  ///< Σ ((f_obs - c f) / sd)² at the best c
  double without = 0.0;     ///< the same sum for c = 1
  int measured = 0;         ///< number of measured frequencies
};

/// Fits c to `observed` and `predicted` [Hz] with the standard deviations `sd` [Hz]. Skips modes
/// whose observed frequency is NaN.
[[nodiscard]] FactorFit fit_factor(std::span<const double> observed,
                                   std::span<const double> predicted, std::span<const double> sd);

/// Reports that the frequencies of the intact structure times one factor fit the data (p of the χ²
/// test at least 0.05), that without this factor they do not, and that damage is more probable than
/// not. At least three frequencies are necessary for the test. The noise is the stated one, or the
/// posterior mean. Does not apply to shapes, to states, and to cases with unknown properties of the
/// intact structure.
[[nodiscard]] std::optional<remark::CommonFactor> common_factor(
    const UnpackedDraws& draws, const std::vector<ModelFinding>& models);

}  // namespace wheeltap::identification
