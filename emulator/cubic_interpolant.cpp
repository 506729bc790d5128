#include "emulator/cubic_interpolant.hpp"

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "base/vector_clones.hpp"

namespace wheeltap::emulator {
namespace {

/// Number of responses that are processed together: one cache line of doubles.
constexpr std::size_t kBlock = 8;

/// The levels of one factor that an evaluation uses, and their weights. Slopes are linear in the
/// secants of the cell and of its two neighbours. Instead of a neighbour outside the range, the
/// cell's secant enters with weight 0.
struct Stencil {
  std::ptrdiff_t first;  // offset of the first node used
  std::ptrdiff_t stride;
  std::size_t nodes = 1;             // 1 at a level, 2 for linear, else up to 4
  std::size_t at[4] = {0, 0, 1, 1};  // indices of the nodes left of, in, and right of the cell
  double inverse[3] = {0, 0, 0};     // 1 / spacing: left, cell, right; 0 outside the range
  double d0[3] = {0, 1, 0}, d1[3] = {0, 1, 0};  // weights of the three secants in the end slopes
  double t = 0, h = 1;                          // position in the cell and its width
  bool limited = false;
};

Stencil stencil(const GridAxis& axis, AxisRule rule, double at) {
  const auto levels = static_cast<std::ptrdiff_t>(axis.coordinates.size());
  std::ptrdiff_t cell = axis.cell(at);
  const double* s = axis.coordinates.data() + cell;
  if (at == s[1]) {
    ++cell;
    ++s;
  }
  Stencil a{.first = cell * axis.stride, .stride = axis.stride};
  if (at == s[0]) return a;
  a.nodes = 2;
  a.h = s[1] - s[0];
  a.inverse[1] = 1.0 / a.h;
  a.t = (at - s[0]) / a.h;
  if (rule == AxisRule::linear) return a;
  a.limited = rule == AxisRule::monotone_cubic;
  const bool has_left = cell > 0, has_right = cell + 2 < levels;
  if (has_left) {
    a.first -= axis.stride;
    a.nodes = 3;
    for (std::size_t i : {1, 2, 3}) ++a.at[i];
    const double h_left = s[0] - s[-1];
    a.inverse[0] = 1.0 / h_left;
    // Slope of the parabola at its middle node; the shorter interval has the larger weight.
    a.d0[0] = a.h / (a.h + h_left);
    a.d0[1] = h_left / (a.h + h_left);
  }
  if (has_right) {
    ++a.nodes;
    ++a.at[3];
    const double h_right = s[2] - s[1];
    a.inverse[2] = 1.0 / h_right;
    a.d1[2] = a.h / (a.h + h_right);
    a.d1[1] = h_right / (a.h + h_right);
  }
  // Slope of the parabola at an end of the range; its mean slope over the cell is the secant.
  if (!has_left && has_right)
    for (std::size_t i : {1, 2}) a.d0[i] = (i == 1 ? 2.0 : 0.0) - a.d1[i];
  if (has_left && !has_right)
    for (std::size_t i : {0, 1}) a.d1[i] = (i == 1 ? 2.0 : 0.0) - a.d0[i];
  return a;
}

/// Limits the slope d so that the interpolant is monotone on both sides of the level.
inline double limit(double d, double left, double right) {
  const double bound = 3.0 * std::min(std::abs(left), std::abs(right));
  const double limited = std::copysign(std::min(std::abs(d), bound), left);
  return (left * right > 0.0) & (d * left > 0.0) ? limited : 0.0;
}

/// Interpolates a block of responses between the nodes of a stencil of at least two nodes.
WHEELTAP_VECTOR_CLONES void join(const Stencil& a, const double (*__restrict y)[kBlock],
                                 double* __restrict out) {
  const double *const y_left = y[a.at[0]], *const y0 = y[a.at[1]], *const y1 = y[a.at[2]],
                      *const y_right = y[a.at[3]];
  const double no_left = a.inverse[0] == 0.0 ? 1.0 : 0.0;
  const double no_right = a.inverse[2] == 0.0 ? 1.0 : 0.0;
  double secant[kBlock], left[kBlock], right[kBlock], d0[kBlock], d1[kBlock];
  for (std::size_t b = 0; b < kBlock; ++b) {
    secant[b] = (y1[b] - y0[b]) * a.inverse[1];
    left[b] = (y0[b] - y_left[b]) * a.inverse[0] + no_left * secant[b];
    right[b] = (y_right[b] - y1[b]) * a.inverse[2] + no_right * secant[b];
    d0[b] = a.d0[0] * left[b] + a.d0[1] * secant[b] + a.d0[2] * right[b];
    d1[b] = a.d1[0] * left[b] + a.d1[1] * secant[b] + a.d1[2] * right[b];
  }
  if (a.limited)
    for (std::size_t b = 0; b < kBlock; ++b) {
      d0[b] = limit(d0[b], left[b], secant[b]);
      d1[b] = limit(d1[b], secant[b], right[b]);
    }
  const double t = a.t;
  for (std::size_t b = 0; b < kBlock; ++b) {
    const double curl = d0[b] + d1[b] - 2.0 * secant[b];
    out[b] = y0[b] + t * a.h * (d0[b] + t * (secant[b] - d0[b] - curl + t * curl));
  }
}

}  // namespace

CubicInterpolant::CubicInterpolant(std::vector<Factor> factors, RowMatrix values,
                                   std::vector<AxisRule> rules)
    : factors_(std::move(factors)), values_(std::move(values)), rules_(std::move(rules)) {
  axes_ = grid_axes(factors_, values_);
  if (rules_.size() != factors_.size())
    throw std::invalid_argument(std::to_string(rules_.size()) + " interpolation rules for " +
                                std::to_string(factors_.size()) + " factors");
  std::size_t nodes = 1;
  for (AxisRule rule : rules_) {
    nodes *= rule == AxisRule::linear ? 2 : 4;
    if (nodes > kMostNodes)
      throw std::invalid_argument("a cubic stencil has more than " + std::to_string(kMostNodes) +
                                  " nodes: interpolate linearly along more of the " +
                                  std::to_string(factors_.size()) + " factors");
  }
}

void CubicInterpolant::evaluate(std::span<const double> x, std::span<double> out) const {
  require_inside(factors_, x);
  if (out.size() != static_cast<std::size_t>(responses()))
    throw std::invalid_argument("the output array has " + std::to_string(out.size()) +
                                " responses, must have " + std::to_string(responses()));
  std::array<Stencil, 12> stencils;  // kMostNodes = 2^12
  std::array<const double*, kMostNodes> nodes;
  nodes[0] = values_.data();
  std::size_t count = 1, active = 0;
  for (std::size_t j = 0; j < axes_.size(); ++j) {
    const Stencil a = stencil(axes_[j], rules_[j], to_scale(axes_[j].scale, x[j]));
    // The loop runs backwards, so that each node is overwritten only after its last use.
    for (std::size_t c = count; c-- > 0;)
      for (std::size_t n = a.nodes; n-- > 0;)
        nodes[c * a.nodes + n] = nodes[c] + a.first + static_cast<std::ptrdiff_t>(n) * a.stride;
    count *= a.nodes;
    if (a.nodes > 1) stencils[active++] = a;
  }
  double work[kMostNodes][kBlock];
  for (std::size_t k = 0; k < out.size(); k += kBlock) {
    const std::size_t width = std::min(kBlock, out.size() - k);
    for (std::size_t c = 0; c < count; ++c)
      for (std::size_t b = 0; b < kBlock; ++b) work[c][b] = b < width ? nodes[c][k + b] : 0.0;
    std::size_t left = count;
    for (std::size_t j = active; j-- > 0;) {
      left /= stencils[j].nodes;
      for (std::size_t c = 0; c < left; ++c) {
        double joined[kBlock];
        join(stencils[j], work + c * stencils[j].nodes, joined);
        std::copy(joined, joined + kBlock, work[c]);
      }
    }
    std::copy(work[0], work[0] + width, out.begin() + static_cast<std::ptrdiff_t>(k));
  }
}

namespace {

constexpr std::size_t kMostCubicFactors = 6;
static_assert(CubicInterpolant::kMostNodes == 1U << 2 * kMostCubicFactors);

}  // namespace

constinit const InterpolantType kCubic = {
    .name = "cubic",
    .words = "cubic",
    .most_factors = kMostCubicFactors,
    .train = [](Table& table,
                const TrainingOptions& options) -> std::unique_ptr<const Interpolant> {
      if (!options.waves.empty() && options.waves.size() != table.factors.size()) {
        throw std::invalid_argument(std::to_string(options.waves.size()) +
                                    " entries of waves for " +
                                    std::to_string(table.factors.size()) + " factors");
      }
      std::vector<AxisRule> rules(table.factors.size(), AxisRule::monotone_cubic);
      for (std::size_t j = 0; j < options.waves.size(); ++j) {
        if (options.waves[j]) rules[j] = AxisRule::cubic;
      }
      return std::make_unique<CubicInterpolant>(table.factors, table.values, std::move(rules));
    }};

constinit const InterpolantType kMonotoneCubic = {
    .name = "monotone-cubic",
    .words = "monotone cubic",
    .most_factors = kMostCubicFactors,
    .train = [](Table& table, const TrainingOptions&) -> std::unique_ptr<const Interpolant> {
      return std::make_unique<CubicInterpolant>(
          table.factors, table.values,
          std::vector<AxisRule>(table.factors.size(), AxisRule::monotone_cubic));
    }};

}  // namespace wheeltap::emulator
