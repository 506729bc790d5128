// Where to climb from in a model whose parameters include those of others.
#pragma once

#include <vector>

#include "inference/exploration/model_exploration.hpp"
#include "inference/model/model_space.hpp"

namespace wheeltap::inference {

/// The models of a list in order of dimension, so that each comes after those nested in it.
[[nodiscard]] std::vector<int> by_dimension(const ModelSpace& space);

/// Whether `outer` has every parameter of `inner`.
[[nodiscard]] bool is_within(const Model& inner, const Model& outer);

/// Whether one model of the list is nested in every other, as the empty subset is in all subsets of
/// some terms.
[[nodiscard]] bool is_nested(const ModelSpace& space);

/// Starts for climbs in `model`, from the best modes of the explored models nested in it: at most
/// `most`, those of the highest evidence among the ones that lack the fewest of its parameters.
/// What a nested model lacks starts at its prior's median, and again at its quantile of 7 % (z =
/// -1.5): the first is nothing of a coefficient that may have either sign, the second little of one
/// that may not. Where one law was found, the law with one term more is thus sought beside it,
/// which two draws of the prior would rarely find. Empty where no model is nested in it.
[[nodiscard]] std::vector<std::vector<double>> nested_starts(
    const ModelSpace& space, int model, const std::vector<ModelExploration>& explorations,
    std::size_t most);

}  // namespace wheeltap::inference
