// Prior draws, with which the program checks whether a case is plausible.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "base/random.hpp"
#include "inference/model/model_space.hpp"

namespace wheeltap::identification {

inline constexpr int kPriorDraws = 200;

/// Draw with index `i` from the prior of a model; the same index always gives the same draw.
[[nodiscard]] inline std::vector<double> prior_draw(const inference::ModelSpace& space, int model,
                                                    int i) {
  base::Random random(1, 0, static_cast<std::uint64_t>(i), base::Purpose::prediction);
  std::vector<double> x;
  for (int p = 0; p < space[model].dimension; ++p) {
    x.push_back(space.prior(model, p).from_standard_normal(random.normal()));
  }
  return x;
}

/// The range of one quantity over draws of the prior.
struct PriorRange {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void take(double x) { low = std::min(low, x), high = std::max(high, x); }
  /// The value in the range that is nearest to x, for x > 0.
  [[nodiscard]] double nearest(double x) const { return std::clamp(x, low, high); }
};

}  // namespace wheeltap::identification
