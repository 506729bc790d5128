// A prior that is drawn rather than named: a density through given points.
#pragma once

#include <vector>

#include "inference/model/prior.hpp"

namespace wheeltap::inference {

/// p(x) ∝ the straight lines through (x_i, density_i), from the first x to the last; an expert's
/// sketch, or the histogram of an earlier study.
class TabulatedPrior : public Distribution {
 public:
  /// `x` increases strictly; `density` is in any unit, since it is divided by its integral. It may
  /// be 0 at an end alone: a gap within would be two priors. Throws std::invalid_argument, naming
  /// the place, where either is not so, or the two are not of one length, 2 at least.
  TabulatedPrior(std::vector<double> x, std::vector<double> density);

  [[nodiscard]] double log_density(double x) const override;
  [[nodiscard]] Tails tails(double x) const override;
  [[nodiscard]] double quantile(Tails t) const override;
  [[nodiscard]] double lower() const override { return x_.front(); }
  [[nodiscard]] double upper() const override { return x_.back(); }
  /// "table of 5 on [0, 3]".
  [[nodiscard]] std::string describe() const override;

 private:
  /// The mass from the left end of cell i to s beyond it, and from s before its right end.
  [[nodiscard]] double from_left(std::size_t i, double s) const;
  [[nodiscard]] double from_right(std::size_t i, double s) const;

  std::vector<double> x_, p_;
  std::vector<double> below_, above_;  ///< F and 1 - F at each x, each summed from its own end
};

}  // namespace wheeltap::inference
