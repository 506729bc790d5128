// A prior whose density is given by a table of values.
#pragma once

#include <vector>

#include "inference/model/prior.hpp"

namespace wheeltap::inference {

/// p(x) ∝ piecewise linear interpolation of (x_i, density_i), from the first x to the last x. The
/// table may come from expert elicitation or from the histogram of an earlier study.
class TabulatedPrior : public Distribution {
 public:
  /// `x` increases strictly. `density` may have any unit, because the constructor normalises it.
  /// The density may be 0 only at the ends, because an interior zero would split the prior. Throws
  /// std::invalid_argument, naming the entry, if one of these conditions fails, the lengths differ,
  /// or there are fewer than 2 table entries.
  TabulatedPrior(std::vector<double> x, std::vector<double> density);

  [[nodiscard]] double log_density(double x) const override;
  [[nodiscard]] Tails tails(double x) const override;
  [[nodiscard]] double quantile(Tails t) const override;
  [[nodiscard]] double lower() const override { return x_.front(); }
  [[nodiscard]] double upper() const override { return x_.back(); }
  /// Description of the prior, e.g. "table of 5 on [0, 3]".
  [[nodiscard]] std::string describe() const override;

 private:
  /// Returns the probability mass of cell i within the distance s from the left end of the cell.
  /// from_right returns the mass within the distance s from the right end.
  [[nodiscard]] double from_left(std::size_t i, double s) const;
  [[nodiscard]] double from_right(std::size_t i, double s) const;

  std::vector<double> x_, p_;
  /// F at each x, summed from the left end; 1 - F, summed from the right end
  std::vector<double> below_, above_;
};

}  // namespace wheeltap::inference
