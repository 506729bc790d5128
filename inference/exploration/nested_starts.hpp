// Starting points for climbs in a model from the modes of models nested in it.
#pragma once

#include <vector>

#include "inference/exploration/model_exploration.hpp"
#include "inference/model/model_space.hpp"

namespace wheeltap::inference {

/// Sorts models by dimension, so that each model comes after the models nested in it.
[[nodiscard]] std::vector<int> by_dimension(const ModelSpace& space);

/// True if `outer` has all parameters of `inner`.
[[nodiscard]] bool is_within(const Model& inner, const Model& outer);

/// True if one model of the list is nested in every other, as the empty subset is in all subsets of
/// some terms.
[[nodiscard]] bool is_nested(const ModelSpace& space);

/// Starting points for climbs in `model`, from the best modes of the explored models nested in it.
/// Returns at most `most`: those of the highest evidence among the models that lack the fewest of
/// its parameters. A missing parameter starts at its prior's median, and again at its quantile of 7
/// % (z = -1.5). The median means no effect for a coefficient of either sign; the quantile means a
/// small effect for a positive one. The search thus finds a law that has one more term than the law
/// already found; climbs from draws of the prior would rarely find it. Empty if no explored model
/// is nested in it.
[[nodiscard]] std::vector<std::vector<double>> nested_starts(
    const ModelSpace& space, int model, const std::vector<ModelExploration>& explorations,
    std::size_t most);

}  // namespace wheeltap::inference
