#include "emulator/multilinear_interpolant.hpp"

#include <array>
#include <stdexcept>
#include <string>

#include "base/vector_clones.hpp"

namespace wheeltap::emulator {
namespace {

/// Computes out_k = Σ_c weight_c · corner_c[k] for k < responses. Blocks of responses stay in
/// registers while the loop reads the corners.
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
  axes_ = grid_axes(factors_, values_);
  if (factors_.size() > kMostFactors)
    throw std::invalid_argument("multilinear interpolation in " + std::to_string(factors_.size()) +
                                " factors; at most " + std::to_string(kMostFactors));
}

void MultilinearInterpolant::evaluate(std::span<const double> x, std::span<double> out) const {
  require_inside(factors_, x);
  if (out.size() != static_cast<std::size_t>(responses()))
    throw std::invalid_argument("the output array has " + std::to_string(out.size()) +
                                " responses, must have " + std::to_string(responses()));
  constexpr std::size_t kMostCorners = std::size_t{1} << kMostFactors;
  std::array<double, kMostCorners> weights;
  std::array<const double*, kMostCorners> corners;
  weights[0] = 1.0;
  corners[0] = values_.data();
  std::size_t count = 1;
  for (std::size_t j = 0; j < axes_.size(); ++j) {
    const GridAxis& axis = axes_[j];
    const double at = to_scale(axis.scale, x[j]);
    const std::ptrdiff_t cell = axis.cell(at);
    const double* const s = axis.coordinates.data() + cell;
    const double t = (at - s[0]) / (s[1] - s[0]);
    const std::ptrdiff_t offset = cell * axis.stride;
    for (std::size_t c = 0; c < count; ++c) {
      corners[c] += offset;
      corners[count + c] = corners[c] + axis.stride;
      weights[count + c] = weights[c] * t;
      weights[c] *= 1.0 - t;
    }
    count *= 2;
  }
  weighted_sum(weights.data(), corners.data(), count, out.data(), out.size());
}

constinit const InterpolantType kMultilinear = {
    .name = "multilinear",
    .words = "multilinear",
    .most_factors = MultilinearInterpolant::kMostFactors,
    .train = [](Table& table, const TrainingOptions&) -> std::unique_ptr<const Interpolant> {
      return std::make_unique<MultilinearInterpolant>(table.factors, table.values);
    }};

}  // namespace wheeltap::emulator
