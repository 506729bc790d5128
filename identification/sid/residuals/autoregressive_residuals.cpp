#include <cmath>

#include "identification/sid/residuals/residual_model.hpp"
#include "signals/residuals.hpp"

namespace wheeltap::identification {
namespace {

using Span = std::span<const double>;

/// r_n = Σ φ_j r_{n-j} + e_n, φ from the partial autocorrelations π = c (signals/residuals.hpp).
class Autoregressive final : public ResidualModel {
 public:
  explicit Autoregressive(int order) : order_(order) {}

  ResidualWords words() const override {
    return {.article = "an",
            .name = "autoregression",
            .detail = " of order " + std::to_string(order_),
            .remedy = "let Wheeltap choose its order (\"residuals\": {\"ar\": \"auto\"})"};
  }
  const ResidualKind* kind() const override { return &kAutoregressive; }
  int value() const override { return order_; }
  std::vector<ResidualParameter> parameters(const std::string& channel) const override {
    std::vector<ResidualParameter> out;
    for (int j = 1; j <= order_; ++j)
      out.push_back(
          {"ar" + channel + "[" + std::to_string(j) + "]", inference::Uniform{-1.0, 1.0}, "1"});
    return out;
  }
  double log_density(Span r, double sigma, Span c) const override {
    return signals::ar_log_likelihood(r, c, sigma);
  }
  void standardise(Span r, Span c, std::span<double> out) const override {
    signals::ar_innovations(r, c, out);
  }
  /// All innovations except the first p; their variance is σ² ∏ (1 - π_j²).
  Innovations innovations(Span r, double sigma, Span c) const override {
    Innovations out{.values = {}, .variance = std::pow(sigma, 2)};
    for (const double pi : c) out.variance *= 1.0 - std::pow(pi, 2);
    const std::vector<double> phi = signals::ar_coefficients(c);
    for (std::size_t n = phi.size(); n < r.size(); ++n) {
      double e = r[n];
      for (std::size_t j = 0; j < phi.size(); ++j) e -= phi[j] * r[n - 1 - j];
      out.values.push_back(e);
    }
    return out;
  }

 private:
  int order_;
};

}  // namespace

const ResidualKind kAutoregressive = {
    .key = "ar",
    .description =
        "{\"ar\": p}: the residuals are an autoregression of order p; {\"ar\": \"auto\"}: "
        "Wheeltap chooses the order",
    .value_description =
        "the order, 0 to 20, or \"auto\": chosen by BIC from the residuals of the best fit "
        "with white residuals",
    .highest = 20,
    .make = [](int order) -> std::shared_ptr<const ResidualModel> {
      if (order == 0) return white_residuals();
      return std::make_shared<const Autoregressive>(order);
    },
    .choose =
        [](Span residuals) {
          return signals::autoregressive_order(residuals, kAutoregressive.highest);
        },
    .criterion = "BIC"};

}  // namespace wheeltap::identification
