#include "inference/moves/regional_walk.hpp"

#include <algorithm>
#include <cmath>

namespace wheeltap::inference {

namespace {

double squared_norm(std::span<const double> u) {
  double sum = 0.0;
  for (const double v : u) sum += v * v;
  return sum;
}

// Writes L_k⁻¹ (z - μ_k) of every component k, and ln r_k up to a constant. Returns this
// constant.
double responsibilities(const NormalMixture& mixture, std::span<const double> z,
                        std::vector<double>& standardised, std::vector<double>& log_r) {
  const std::size_t d = z.size();
  const auto size = static_cast<std::size_t>(mixture.size());
  standardised.resize(size * d);
  log_r.resize(size);
  for (std::size_t k = 0; k < size; ++k) {
    const int component = static_cast<int>(k);
    const std::span<double> u = std::span(standardised).subspan(k * d, d);
    mixture.standardise(component, z, u);
    log_r[k] = std::log(mixture[component].weight) - mixture.log_determinant(component) -
               0.5 * static_cast<double>(d + 1) * std::log1p(squared_norm(u));
  }
  const double top = *std::ranges::max_element(log_r);
  double sum = 0.0;
  for (const double r : log_r) sum += std::exp(r - top);
  return top + std::log(sum);
}

}  // namespace

std::optional<double> RegionalWalk::propose(const State& from, const Step& step, State& to) {
  constexpr double kShortest = 1e-2;
  const auto& mixture = fit_->density[static_cast<std::size_t>(from.model)];
  if (!mixture) return std::nullopt;
  const std::size_t d = from.z.size();
  const auto size = static_cast<std::size_t>(mixture->size());
  const double all_from = responsibilities(*mixture, from.z, from_, r_from_);
  double v = step.random.uniform();
  std::size_t k = 0;
  for (; k + 1 < size; ++k) {
    v -= std::exp(r_from_[k] - all_from);
    if (v < 0.0) break;
  }
  const double scale =
      std::pow(kShortest, step.random.uniform()) * 2.38 / std::sqrt(static_cast<double>(d));
  // In the component's coordinates the step is N(0, scale²).
  std::vector<double>& u = to_;
  u.resize(d);
  for (std::size_t i = 0; i < d; ++i) u[i] = from_[k * d + i] + scale * step.random.normal();
  mixture->unstandardise(static_cast<int>(k), u, to.z);
  if (!step.target.is_sorted(to)) return std::nullopt;
  const double all_to = responsibilities(*mixture, to.z, to_, r_to_);

  double forward = -HUGE_VAL, backward = -HUGE_VAL;  // the largest terms
  terms_.resize(size);                               // ln A_k
  for (std::size_t j = 0; j < size; ++j) {
    double square = 0.0;
    for (std::size_t i = 0; i < d; ++i) {
      const double difference = to_[j * d + i] - from_[j * d + i];
      square += difference * difference;
    }
    terms_[j] = -0.5 * square / (scale * scale) - mixture->log_determinant(static_cast<int>(j));
    forward = std::max(forward, r_from_[j] + terms_[j]);
    backward = std::max(backward, r_to_[j] + terms_[j]);
  }
  if (forward == -HUGE_VAL || backward == -HUGE_VAL) return std::nullopt;
  double there = 0.0, back = 0.0;
  for (std::size_t j = 0; j < size; ++j) {
    there += std::exp(r_from_[j] + terms_[j] - forward);
    back += std::exp(r_to_[j] + terms_[j] - backward);
  }
  return backward + std::log(back) - all_to - (forward + std::log(there) - all_from);
}

}  // namespace wheeltap::inference
