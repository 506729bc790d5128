// Clusters of things that are near each other, none with two of one group.
#pragma once

#include <functional>
#include <vector>

namespace wheeltap::signals {

/// Agglomerative clustering by average linkage (Sokal & Michener 1958) with Lance & Williams'
/// update: of all pairs of clusters, those with the least mean distance are joined while that is at
/// most `threshold`. `groups` gives the group of each of n things; two of one group never come into
/// one cluster (the poles of one order, the modes of one set-up). `distance(i, j)` >= 0 of things
/// of unlike groups, ∞ where they must not meet. Each cluster ascends; they come in the order of
/// their least members.
[[nodiscard]] std::vector<std::vector<int>> average_linkage(
    const std::vector<int>& groups, const std::function<double(int, int)>& distance,
    double threshold);

}  // namespace wheeltap::signals
