#include <algorithm>
#include <cmath>
#include <numeric>

#include "identification/sid/residuals/residual_model.hpp"
#include "signals/residuals.hpp"

namespace wheeltap::identification {
namespace {

using Span = std::span<const double>;

/// p(r | σ) = ∏ N(r_n | 0, σ²).
class White final : public ResidualModel {
 public:
  ResidualWords words() const override { return {.name = "white"}; }
  std::vector<ResidualParameter> parameters(const std::string& /*channel*/) const override {
    return {};
  }
  bool is_white() const override { return true; }
  double log_density(Span r, double sigma, Span /*c*/) const override {
    return signals::gaussian_log_likelihood(std::inner_product(r.begin(), r.end(), r.begin(), 0.0),
                                            static_cast<int>(r.size()), sigma);
  }
  void standardise(Span r, Span /*c*/, std::span<double> out) const override {
    if (out.data() != r.data()) std::ranges::copy(r, out.begin());
  }
};

}  // namespace

Innovations ResidualModel::innovations(Span residuals, double sigma, Span c) const {
  Innovations out{.values = std::vector<double>(residuals.size()), .variance = std::pow(sigma, 2)};
  standardise(residuals, c, out.values);
  return out;
}

std::shared_ptr<const ResidualModel> white_residuals() {
  static const auto kWhite = std::make_shared<const White>();
  return kWhite;
}

}  // namespace wheeltap::identification
