// A prior whose density is given by a table of points.
#pragma once

#include <vector>

#include "inference/model/prior.hpp"

namespace wheeltap::inference {

/// p(x) ∝ piecewise linear interpolation of (x_i, density_i), from the first x to the last; e.g.
/// from expert elicitation or the histogram of an earlier study.
class TabulatedPrior : public Distribution {
 public:
  /// `x` increases strictly; `density` has any unit, since it is normalised. Density may be 0 only
  /// at the ends, since an interior zero would split the prior. Throws std::invalid_argument,
  /// naming the entry, if one of these conditions fails, the lengths differ, or there are fewer
  /// than 2 points.
  TabulatedPrior(std::vector<double> x, std::vector<double> density);

  [[nodiscard]] double log_density(double x) const override;
  [[nodiscard]] Tails tails(double x) const override;
  [[nodiscard]] double quantile(Tails t) const override;
  [[nodiscard]] double lower() const override { return x_.front(); }
  [[nodiscard]] double upper() const override { return x_.back(); }
  /// "table of 5 on [0, 3]".
  [[nodiscard]] std::string describe() const override;

 private:
  /// Mass from the left end of cell i to a distance s from it, and from a distance s before its
  /// right end to that end.
  [[nodiscard]] double from_left(std::size_t i, double s) const;
  [[nodiscard]] double from_right(std::size_t i, double s) const;

  std::vector<double> x_, p_;
  std::vector<double> below_, above_;  ///< F and 1 - F at each x, each summed from its own end
};

}  // namespace wheeltap::inference
