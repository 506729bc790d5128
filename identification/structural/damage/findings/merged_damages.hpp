// Adjacent damages that act as one longer damage. The number of adjacent damages depends on the
// length that one damage covers (for example an element) and not on the data.
//
// A loss of stiffness r over a length l adds a flexibility proportional to c = l r / (1 - r). In
// the lowest orders of l divided by the wavelength of the mode, frequencies depend only on the sum,
// centre and spread of the c_i of the damages i. Two damages are replaced by one damage of length L
// with the same sum, centre and spread,
//
//   L r / (1 - r) = Σ c_i,   s = Σ c_i s_i / Σ c_i,   L²/12 = Σ c_i ((s_i - s)² + l_i²/12) / Σ c_i.
//
// The log likelihood with this one damage must be at most 2 below the log likelihood with the two
// damages (2 is about half the 95 % quantile of χ² with one degree of freedom).
#pragma once

#include <optional>
#include <vector>

#include "identification/findings/findings.hpp"
#include "identification/structural/damage/findings/unpacked_draws.hpp"

namespace wheeltap::identification {

/// Draws of one model in which adjacent damages of one kind are merged into one longer damage.
struct MergedModel {
  int model = 0;
  double merged = 0.0;  ///< fraction of draws in which damages were merged
  int count = 0;        ///< most frequent number of damages after merging
  // The longest merged damage of each draw, on the member where it is most frequent:
  int stretch = 0;
  double fixed = 0.0;                   ///< length that one damage covers on this member [m]
  Marginal location = {}, length = {};  ///< centre and length of the merged damage [m]
  Marginal reduction = {};
  double gain = 0.0;  ///< mean change of the log likelihood by merging
};

/// Numbers of damages of a kind with fixed extent, after merging.
struct MergedFinding {
  int kind = 0;
  std::vector<double> count;        ///< probability of 0, 1, … damages
  double merged = 0.0;              ///< probability that damages are merged
  std::vector<MergedModel> models;  ///< models with merged draws, most probable first

  /// The merged damages of a model; nullptr if no draw of the model has merged damages.
  [[nodiscard]] const MergedModel* of(int model) const;
};

/// True if damages of the kind have a fixed length: the length of an element, or a given extent.
[[nodiscard]] bool has_fixed_extent(const DefectKind& kind);
/// The length [m] of a damage at `location` [m], measured along the SiteLine of the kind.
[[nodiscard]] double fixed_extent(const DefectKind& kind, double location);

/// Merges damages in about 200 draws of each model with two or more damages. A merged damage has at
/// most a quarter of the length of the member. The result is empty if the kind has no fixed extent,
/// no probable model with two or more damages has draws, or DamageProblem::as_case is false.
[[nodiscard]] std::optional<MergedFinding> merged_damages(const UnpackedDraws& draws,
                                                          const std::vector<ModelFinding>& models,
                                                          int kind);

}  // namespace wheeltap::identification
