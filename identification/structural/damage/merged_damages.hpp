// Adjacent damages that act as one longer damage: their count follows from the
// length that one of them covers, an element for example, and not from the data.
//
// A loss of stiffness r over a length l adds a flexibility in proportion to c = l r / (1 - r). To
// the first orders of l over a mode's wavelength the frequencies know of damages i only the sum,
// centre and spread of their c_i. Two are one where the damage of length L with the same,
//
//   L r / (1 - r) = Σ c_i,   s = Σ c_i s_i / Σ c_i,   L²/12 = Σ c_i ((s_i - s)² + l_i²/12) / Σ c_i,
//
// explains the data as well: its log likelihood is at most 2 below that of the two (half the 95 %
// quantile of χ² of one degree of freedom).
#pragma once

#include <optional>
#include <vector>

#include "identification/findings/findings.hpp"
#include "identification/structural/damage/unpacked_draws.hpp"

namespace wheeltap::identification {

/// Draws of one model in which damages of a kind are merged.
struct MergedModel {
  int model = 0;
  double merged = 0.0;  ///< share of its draws with fewer damages once they are merged
  int count = 0;        ///< their number then, in most of these
  // Of the longest merged damage of these draws, on the stretch that most of them have it on:
  int stretch = 0;
  double fixed = 0.0;                   ///< what one damage covers there [m]
  Marginal location = {}, length = {};  ///< its middle and its extent [m]
  Marginal reduction = {};
  double gain = 0.0;  ///< ln likelihood, merged less apart, on average
};

/// What a kind of damage of fixed extent comes to, neighbours counted as one.
struct MergedFinding {
  int kind = 0;
  std::vector<double> count;        ///< probability of 0, 1, … damages
  double merged = 0.0;              ///< probability that some are merged
  std::vector<MergedModel> models;  ///< those with merged draws, the most probable first

  /// Nullptr where no draw of the model has merged damages.
  [[nodiscard]] const MergedModel* of(int model) const;
};

/// Whether the kind's damages cover a length that the case fixes: an element, or a stated extent.
[[nodiscard]] bool has_fixed_extent(const DefectKind& kind);
/// That length where damage is at `location` on the kind's line [m].
[[nodiscard]] double fixed_extent(const DefectKind& kind, double location);

/// Nothing where the kind's extent is not fixed, or no model with two of them has draws; nor where
/// another program predicts, which knows its own damages alone. Lengths up to a quarter of the
/// member count as one damage. Some 200 draws of each model with two damages are taken.
[[nodiscard]] std::optional<MergedFinding> merged_damages(const UnpackedDraws& draws,
                                                          const std::vector<ModelFinding>& models,
                                                          int kind);

}  // namespace wheeltap::identification
