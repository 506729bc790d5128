// JSON of results, for summaries, reports and --json.
#pragma once

#include <nlohmann/json.hpp>

#include "base/eigen.hpp"

namespace wheeltap::apps {

/// JSON that keeps the order of its keys.
using Report = nlohmann::ordered_json;

/// A number, or null if it is not finite.
[[nodiscard]] Report finite(double x);
/// The rows of a matrix; null for entries that are not finite.
[[nodiscard]] Report rows_of(const Eigen::MatrixXd& matrix);

/// Rounds a number to five significant digits to shorten the JSON text; charts show fewer.
[[nodiscard]] double compact(double x);
/// Rounds a number to the digits that resolve a thousandth of `width`, at least five digits.
[[nodiscard]] double compact(double x, double width);

}  // namespace wheeltap::apps
