// Hierarchical clustering with at most one member of each group per cluster.
#pragma once

#include <functional>
#include <vector>

namespace wheeltap::signals {

/// Agglomerative clustering by average linkage (Sokal & Michener 1958) with the update formula of
/// Lance and Williams. The algorithm repeatedly joins the two clusters with the smallest mean
/// distance, as long as this distance is at most `threshold`. `groups` gives the group of each of
/// the n items; two items of one group are never in the same cluster. A group is, for example, the
/// poles of one model order or the modes of one set-up. `distance(i, j)` >= 0 is the distance
/// between items of different groups; the distance ∞ forbids a common cluster. The members of each
/// cluster are in ascending order; clusters are sorted by their first members.
[[nodiscard]] std::vector<std::vector<int>> average_linkage(
    const std::vector<int>& groups, const std::function<double(int, int)>& distance,
    double threshold);

}  // namespace wheeltap::signals
