#include "inference/model/tabulated_prior.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "base/number.hpp"

namespace wheeltap::inference {
namespace {

[[noreturn]] void refuse_table(const char* list, std::size_t i, double value, const char* bound) {
  throw std::invalid_argument("table prior: " + std::string(list) + "[" + std::to_string(i) +
                              "] = " + base::number(value) + ", must be " + bound);
}

// Solves first u + ½ (last - first) u² = mass for u in [0, 1], accurately for small mass. The
// densities at both ends of a cell are relative to the mass of the cell, so that nothing
// underflows.
double share_of_cell(double first, double last, double mass) {
  const double root = std::sqrt(std::fmax(0.0, first * first + 2.0 * (last - first) * mass));
  return mass > 0.0 ? std::fmin(1.0, 2.0 * mass / (first + root)) : 0.0;
}

}  // namespace

TabulatedPrior::TabulatedPrior(std::vector<double> x, std::vector<double> density)
    : x_(std::move(x)), p_(std::move(density)) {
  if (x_.size() < 2 || x_.size() != p_.size())
    throw std::invalid_argument("table prior: " + std::to_string(x_.size()) + " values of x and " +
                                std::to_string(p_.size()) +
                                " of density; give equal numbers, at least 2");
  const std::size_t last = x_.size() - 1;
  for (std::size_t i = 0; i <= last; ++i) {
    if (!std::isfinite(x_[i])) refuse_table("x", i, x_[i], "finite");
    if (i > 0 && !(x_[i] > x_[i - 1]))
      refuse_table("x", i, x_[i], "greater than the previous value");
    if (i > 0 && !std::isfinite(x_[i] - x_[i - 1]))
      refuse_table("x", i, x_[i], "at a finite distance from the previous value");
    if (!(p_[i] >= 0.0 && std::isfinite(p_[i])))
      refuse_table("density", i, p_[i], ">= 0 and finite");
    if (p_[i] == 0.0 && ((i > 0 && i < last) || last == 1))
      refuse_table("density", i, p_[i], "> 0 (only the first or last value may be 0)");
  }
  // Densities are scaled before the summation, so that densities of 1e300 do not overflow.
  const double top = *std::ranges::max_element(p_);
  const double extent = x_[last] - x_[0];
  if (!std::isfinite(extent))
    refuse_table("x", last, x_[last], "at a finite distance from the first value");
  double mass = 0.0;
  for (double& p : p_) p /= top;
  for (std::size_t i = 0; i < last; ++i)
    mass += 0.5 * (p_[i] + p_[i + 1]) * ((x_[i + 1] - x_[i]) / extent);
  for (double& p : p_) p /= mass * extent;
  below_.assign(last + 1, 0.0);
  above_.assign(last + 1, 0.0);
  for (std::size_t i = 0; i < last; ++i)
    below_[i + 1] = below_[i] + from_left(i, x_[i + 1] - x_[i]);
  for (std::size_t i = last; i > 0; --i)
    above_[i - 1] = above_[i] + from_right(i - 1, x_[i] - x_[i - 1]);
}

double TabulatedPrior::from_left(std::size_t i, double s) const {
  const double u = s / (x_[i + 1] - x_[i]);
  return s * p_[i] + 0.5 * u * s * (p_[i + 1] - p_[i]);
}

double TabulatedPrior::from_right(std::size_t i, double s) const {
  const double u = s / (x_[i + 1] - x_[i]);
  return s * p_[i + 1] + 0.5 * u * s * (p_[i] - p_[i + 1]);
}

double TabulatedPrior::log_density(double x) const {
  const auto right = std::ranges::upper_bound(x_, x);
  if (right == x_.begin() || right == x_.end()) return -std::numeric_limits<double>::infinity();
  const auto i = static_cast<std::size_t>(right - x_.begin()) - 1;
  const double s = (x - x_[i]) / (x_[i + 1] - x_[i]);
  return std::log((1.0 - s) * p_[i] + s * p_[i + 1]);
}

Distribution::Tails TabulatedPrior::tails(double x) const {
  if (x <= x_.front()) return {0.0, 1.0};
  if (x >= x_.back()) return {1.0, 0.0};
  const auto i = static_cast<std::size_t>(std::ranges::upper_bound(x_, x) - x_.begin()) - 1;
  return {below_[i] + from_left(i, x - x_[i]), above_[i + 1] + from_right(i, x_[i + 1] - x)};
}

double TabulatedPrior::quantile(Tails t) const {
  if (t.below < t.above) {
    const auto right = std::ranges::upper_bound(below_, t.below);
    const std::size_t i =
        std::min(static_cast<std::size_t>(right - below_.begin()), x_.size() - 1) - 1;
    const double width = x_[i + 1] - x_[i];
    return x_[i] + width * share_of_cell(p_[i] * width, p_[i + 1] * width, t.below - below_[i]);
  }
  // `above_` decreases. Finds the last entry above t.above.
  const auto left = std::ranges::partition_point(above_, [&](double a) { return a > t.above; });
  const std::size_t i =
      static_cast<std::size_t>(std::max<std::ptrdiff_t>(left - above_.begin(), 1)) - 1;
  if (i + 1 == x_.size()) return x_.back();
  const double width = x_[i + 1] - x_[i];
  return x_[i + 1] -
         width * share_of_cell(p_[i + 1] * width, p_[i] * width, t.above - above_[i + 1]);
}

std::string TabulatedPrior::describe() const {
  return "table of " + std::to_string(x_.size()) + " on [" + base::number(x_.front()) + ", " +
         base::number(x_.back()) + "]";
}

}  // namespace wheeltap::inference
