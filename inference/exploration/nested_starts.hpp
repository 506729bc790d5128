// Starting points of local optimisations in a model, computed from the posterior modes of smaller
// models nested in it.
#pragma once

#include <vector>

#include "inference/exploration/model_exploration.hpp"
#include "inference/model/model_space.hpp"

namespace wheeltap::inference {

/// Sorts models by dimension, so that each model comes after the models nested in it.
[[nodiscard]] std::vector<int> by_dimension(const ModelSpace& space);

/// True if `outer` has all parameters of `inner`.
[[nodiscard]] bool is_within(const Model& inner, const Model& outer);

/// True if one model of the list is nested in every other model. For example, the empty subset of
/// terms is nested in all subsets.
[[nodiscard]] bool is_nested(const ModelSpace& space);

/// Starting points of local optimisations in `model`, computed from the best posterior modes of at
/// most `most` explored models that are nested in `model`. The nested models are ordered by the
/// number of missing parameters, then by descending evidence. Each nested model gives two starting
/// points. The missing parameters are at the medians of their priors in the first point, and at the
/// 7 % quantiles (z = -1.5) in the second. A coefficient of either sign has no effect at the
/// median. A positive coefficient has a small effect at the 7 % quantile. The search thus finds a
/// force law that has one more term than a force law already found. Local optimisations from draws
/// of the prior would rarely find this force law. The result is empty if no explored model is
/// nested in `model`.
[[nodiscard]] std::vector<std::vector<double>> nested_starts(
    const ModelSpace& space, int model, const std::vector<ModelExploration>& explorations,
    std::size_t most);

}  // namespace wheeltap::inference
