#include "emulator/design.hpp"

#include <algorithm>
#include <array>
#include <boost/random/sobol.hpp>
#include <cmath>
#include <random>
#include <set>
#include <stdexcept>

#include "base/number.hpp"

namespace wheeltap::emulator {
namespace {

/// Draws a number with the uniform distribution on [0, 1) from the top 53 bits. The number is the
/// same on every platform, unlike numbers from the distributions of the standard library.
double unit_uniform(std::mt19937_64& generator) {
  return static_cast<double>(generator() >> 11) * 0x1p-53;
}

Eigen::Index uniform_below(std::mt19937_64& generator, Eigen::Index n) {
  return static_cast<Eigen::Index>(unit_uniform(generator) * static_cast<double>(n));
}

void check_scattered(const std::vector<Factor>& factors, Eigen::Index n) {
  check_factors(factors);
  if (n < 1)
    throw std::invalid_argument("a design of n = " + std::to_string(n) + " points is empty");
}

/// Converts unit-cube coordinates (uniform in each factor's scale) to factor units.
Design on_box(std::vector<Factor> factors, RowMatrix unit) {
  for (Eigen::Index j = 0; j < unit.cols(); ++j) {
    const Factor& factor = factors[static_cast<std::size_t>(j)];
    const double low = to_scale(factor.scale, factor.low());
    const double high = to_scale(factor.scale, factor.high());
    for (Eigen::Index i = 0; i < unit.rows(); ++i)
      // The clamp only corrects rounding at the ends of the range.
      unit(i, j) = std::clamp(from_scale(factor.scale, low + (high - low) * unit(i, j)),
                              factor.low(), factor.high());
  }
  return {std::move(factors), std::move(unit)};
}

}  // namespace

std::string_view name(Scale scale) {
  constexpr std::array<std::string_view, 4> kNames{"linear", "compliance", "reciprocal",
                                                   "logarithm"};
  return kNames.at(static_cast<std::size_t>(scale));
}

Scale scale_named(std::string_view text) {
  for (Scale scale : {Scale::linear, Scale::compliance, Scale::reciprocal, Scale::logarithm})
    if (text == name(scale)) return scale;
  throw std::invalid_argument("scale \"" + std::string(text) +
                              "\" is not one of linear, compliance, reciprocal, logarithm");
}

double to_scale(Scale scale, double x) {
  switch (scale) {
    case Scale::linear:
      return x;
    case Scale::compliance:
      return 1.0 / (1.0 - x);
    case Scale::reciprocal:
      return -1.0 / x;
    case Scale::logarithm:
      return std::log(x);
  }
  throw std::invalid_argument("unknown scale");
}

double from_scale(Scale scale, double s) {
  switch (scale) {
    case Scale::linear:
      return s;
    case Scale::compliance:
      return 1.0 - 1.0 / s;
    case Scale::reciprocal:
      return -1.0 / s;
    case Scale::logarithm:
      return std::exp(s);
  }
  throw std::invalid_argument("unknown scale");
}

void check_factors(const std::vector<Factor>& factors, std::size_t least_levels) {
  if (factors.empty()) throw std::invalid_argument("a design needs at least one factor");
  std::set<std::string> names;
  for (const Factor& factor : factors) {
    const std::string who = "factor \"" + factor.name + "\"";
    if (factor.name.empty()) throw std::invalid_argument("a factor has no name");
    if (!names.insert(factor.name).second) throw std::invalid_argument(who + " is listed twice");
    if (factor.levels.size() < least_levels)
      throw std::invalid_argument(who + " has " + std::to_string(factor.levels.size()) +
                                  " levels; at least " + std::to_string(least_levels) +
                                  " are needed");
    for (std::size_t i = 0; i < factor.levels.size(); ++i) {
      const double level = factor.levels[i];
      if (!std::isfinite(level))
        throw std::invalid_argument(who + " has the level " + base::number(level) +
                                    ", which is not finite");
      if (i > 0 && !(factor.levels[i - 1] < level))
        throw std::invalid_argument(who + ": level " + base::number(level) + " follows " +
                                    base::number(factor.levels[i - 1]) + "; levels must increase");
      const bool undefined =
          (factor.scale == Scale::compliance && !(level < 1.0)) ||
          ((factor.scale == Scale::reciprocal || factor.scale == Scale::logarithm) &&
           !(level > 0.0));
      if (undefined)
        throw std::invalid_argument(who + ": level " + base::number(level) + " has no " +
                                    std::string(name(factor.scale)) + " coordinate; it must be " +
                                    (factor.scale == Scale::compliance ? "< 1" : "> 0"));
    }
  }
}

bool contains(const std::vector<Factor>& factors, std::span<const double> x) {
  if (x.size() != factors.size()) return false;
  for (std::size_t j = 0; j < x.size(); ++j)
    if (!(x[j] >= factors[j].low() && x[j] <= factors[j].high())) return false;
  return true;
}

void require_inside(const std::vector<Factor>& factors, std::span<const double> x) {
  if (x.size() != factors.size())
    throw std::invalid_argument("a point has " + std::to_string(x.size()) + " values for " +
                                std::to_string(factors.size()) + " factors");
  for (std::size_t j = 0; j < x.size(); ++j)
    if (!(x[j] >= factors[j].low() && x[j] <= factors[j].high()))
      throw std::out_of_range("factor \"" + factors[j].name + "\" = " + base::number(x[j]) +
                              " lies outside the emulator's range [" +
                              base::number(factors[j].low()) + ", " +
                              base::number(factors[j].high()) + "]");
}

Design full_factorial(std::vector<Factor> factors) {
  check_factors(factors, 1);
  constexpr Eigen::Index kMostRuns = Eigen::Index{1} << 31;
  Eigen::Index runs = 1;
  for (const Factor& factor : factors) {
    runs *= static_cast<Eigen::Index>(factor.levels.size());
    if (runs > kMostRuns)
      throw std::invalid_argument("the full factorial design has more than 2^31 runs");
  }
  RowMatrix points(runs, static_cast<Eigen::Index>(factors.size()));
  Eigen::Index repeat = runs;
  for (std::size_t j = 0; j < factors.size(); ++j) {
    const auto& levels = factors[j].levels;
    repeat /= static_cast<Eigen::Index>(levels.size());
    for (Eigen::Index i = 0; i < runs; ++i)
      points(i, static_cast<Eigen::Index>(j)) =
          levels[static_cast<std::size_t>(i / repeat) % levels.size()];
  }
  return {std::move(factors), std::move(points)};
}

Design random_design(std::vector<Factor> factors, Eigen::Index n, std::uint64_t seed) {
  check_scattered(factors, n);
  std::mt19937_64 generator(seed);
  RowMatrix points(n, static_cast<Eigen::Index>(factors.size()));
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < points.cols(); ++j) {
      const Factor& factor = factors[static_cast<std::size_t>(j)];
      points(i, j) = factor.low() + (factor.high() - factor.low()) * unit_uniform(generator);
    }
  return {std::move(factors), std::move(points)};
}

Design latin_hypercube(std::vector<Factor> factors, Eigen::Index n, std::uint64_t seed) {
  check_scattered(factors, n);
  std::mt19937_64 generator(seed);
  const auto d = static_cast<Eigen::Index>(factors.size());
  RowMatrix unit(n, d);
  for (Eigen::Index j = 0; j < d; ++j) {
    for (Eigen::Index i = 0; i < n; ++i)
      unit(i, j) = (static_cast<double>(i) + 0.5) / static_cast<double>(n);
    for (Eigen::Index i = n - 1; i > 0; --i)
      std::swap(unit(i, j), unit(uniform_below(generator, i + 1), j));
  }
  // Distances are relative to the mean spacing, so that d^-p does not overflow.
  const double spacing = std::pow(static_cast<double>(n), -1.0 / static_cast<double>(d));
  const auto crowding = [&](Eigen::Index i, Eigen::Index skip) {
    double sum = 0.0;
    for (Eigen::Index k = 0; k < n; ++k) {
      if (k == i || k == skip) continue;
      const double squared = (unit.row(i) - unit.row(k)).squaredNorm() / (spacing * spacing);
      sum += std::pow(squared, -7.5);  // d^-15
    }
    return sum;
  };
  // Swapping one coordinate of rows a and b leaves their own distance and all other pairs
  // unchanged.
  const Eigen::Index swaps =
      n < 3 || d < 2 ? 0 : std::min<Eigen::Index>(10 * n * d, 20'000'000 / n);
  for (Eigen::Index swap = 0; swap < swaps; ++swap) {
    const Eigen::Index a = uniform_below(generator, n);
    const Eigen::Index b = uniform_below(generator, n);
    const Eigen::Index j = uniform_below(generator, d);
    if (a == b) continue;
    const double before = crowding(a, b) + crowding(b, a);
    std::swap(unit(a, j), unit(b, j));
    if (crowding(a, b) + crowding(b, a) > before) std::swap(unit(a, j), unit(b, j));
  }
  return on_box(std::move(factors), std::move(unit));
}

Design sobol(std::vector<Factor> factors, Eigen::Index n, std::uint64_t seed) {
  check_scattered(factors, n);
  boost::random::sobol sequence(factors.size());
  std::mt19937_64 generator(seed);
  std::vector<std::uint64_t> shift(factors.size());
  for (std::uint64_t& bits : shift) bits = generator();
  RowMatrix unit(n, static_cast<Eigen::Index>(factors.size()));
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < unit.cols(); ++j)
      unit(i, j) =
          static_cast<double>((sequence() ^ shift[static_cast<std::size_t>(j)]) >> 11) * 0x1p-53;
  return on_box(std::move(factors), std::move(unit));
}

Design with_corners(Design design) {
  std::vector<Factor> ends = design.factors;
  check_factors(ends);
  if (ends.size() > 20)
    throw std::invalid_argument("the corners of a box of " + std::to_string(ends.size()) +
                                " factors: at most 20 factors are supported");
  for (Factor& factor : ends) factor.levels = {factor.low(), factor.high()};
  std::set<std::vector<double>> there;
  for (const auto& row : design.points.rowwise()) there.emplace(row.begin(), row.end());
  const RowMatrix corners = full_factorial(ends).points;
  for (const auto& corner : corners.rowwise())
    if (!there.contains({corner.begin(), corner.end()})) {
      design.points.conservativeResize(design.points.rows() + 1, Eigen::NoChange);
      design.points.bottomRows<1>() = corner;
    }
  return design;
}

}  // namespace wheeltap::emulator
