#include "emulator/multilinear_interpolant.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>

#include "emulator/vector_clones.hpp"

namespace wheeltap::emulator {
namespace {

/// out_k = Σ_c weight_c · corner_c[k] for k < responses. Blocks of responses stay in registers
/// while the corners stream past.
WHEELTAP_VECTOR_CLONES void weighted_sum(const double* __restrict weights,
                                         const double* const* __restrict corners, std::size_t count,
                                         double* __restrict out, std::size_t responses) {
  constexpr std::size_t kBlock = 8;
  std::size_t k = 0;
  for (; k + kBlock <= responses; k += kBlock) {
    double sum[kBlock] = {};
    for (std::size_t c = 0; c < count; ++c)
      for (std::size_t b = 0; b < kBlock; ++b) sum[b] += weights[c] * corners[c][k + b];
    for (std::size_t b = 0; b < kBlock; ++b) out[k + b] = sum[b];
  }
  for (; k < responses; ++k) {
    double sum = 0.0;
    for (std::size_t c = 0; c < count; ++c) sum += weights[c] * corners[c][k];
    out[k] = sum;
  }
}

}  // namespace

MultilinearInterpolant::MultilinearInterpolant(std::vector<Factor> factors, RowMatrix values)
    : factors_(std::move(factors)), values_(std::move(values)) {
  check_factors(factors_);
  if (factors_.size() > kMostFactors)
    throw std::invalid_argument("multilinear interpolation in " + std::to_string(factors_.size()) +
                                " factors; at most " + std::to_string(kMostFactors));
  if (values_.cols() < 1) throw std::invalid_argument("a table without responses");
  std::ptrdiff_t stride = values_.cols();
  axes_.resize(factors_.size());
  for (std::size_t j = factors_.size(); j-- > 0;) {
    const Factor& factor = factors_[j];
    axes_[j].stride = stride;
    stride *= static_cast<std::ptrdiff_t>(factor.levels.size());
    for (double level : factor.levels)
      axes_[j].coordinates.push_back(to_scale(factor.scale, level));
  }
  if (stride != values_.size())
    throw std::invalid_argument("a table of " + std::to_string(values_.rows()) +
                                " rows for a grid of " + std::to_string(stride / values_.cols()) +
                                " nodes");
  if (!values_.allFinite()) throw std::invalid_argument("a table with values that are not finite");
}

void MultilinearInterpolant::evaluate(std::span<const double> x, std::span<double> out) const {
  require_inside(factors_, x);
  if (out.size() != static_cast<std::size_t>(responses()))
    throw std::invalid_argument("room for " + std::to_string(out.size()) +
                                " responses; there are " + std::to_string(responses()));
  constexpr std::size_t kMostCorners = std::size_t{1} << kMostFactors;
  std::array<double, kMostCorners> weights;
  std::array<const double*, kMostCorners> corners;
  weights[0] = 1.0;
  corners[0] = values_.data();
  std::size_t count = 1;
  for (std::size_t j = 0; j < axes_.size(); ++j) {
    const auto& s = axes_[j].coordinates;
    const double at = to_scale(factors_[j].scale, x[j]);
    // The last level above `at` among the inner ones: x on the upper bound falls in the last cell.
    const auto upper = std::upper_bound(s.begin() + 1, s.end() - 1, at);
    const double t = (at - upper[-1]) / (upper[0] - upper[-1]);
    const std::ptrdiff_t offset = (upper - s.begin() - 1) * axes_[j].stride;
    for (std::size_t c = 0; c < count; ++c) {
      corners[c] += offset;
      corners[count + c] = corners[c] + axes_[j].stride;
      weights[count + c] = weights[c] * t;
      weights[c] *= 1.0 - t;
    }
    count *= 2;
  }
  weighted_sum(weights.data(), corners.data(), count, out.data(), out.size());
}

}  // namespace wheeltap::emulator
