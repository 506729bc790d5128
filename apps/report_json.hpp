// The JSON of results: what summaries, reports and --json are made of.
#pragma once

#include <nlohmann/json.hpp>

#include "base/eigen.hpp"

namespace wheeltap::apps {

/// JSON that keeps the order in which it is written.
using Report = nlohmann::ordered_json;

/// A number, or null for what JSON cannot hold.
[[nodiscard]] Report finite(double x);
/// A list of rows of such numbers.
[[nodiscard]] Report rows_of(const Eigen::MatrixXd& matrix);

/// Five digits are more than a chart shows, and shorter to store.
[[nodiscard]] double compact(double x);
/// With as many digits as tell a thousandth of `width` apart, and at least those.
[[nodiscard]] double compact(double x, double width);

}  // namespace wheeltap::apps
