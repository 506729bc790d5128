#include "inference/mixtures/normal_mixture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "base/constants.hpp"
#include "inference/mixtures/packed_mixture.hpp"

namespace wheeltap::inference {
namespace {

using packed::group_stride;
using packed::groups_of;
using packed::kLanes;
using packed::kMaxComponents;
using packed::log_sum_diagonal;
using packed::pack;
using packed::routines;

}  // namespace

NormalMixture::NormalMixture(std::vector<Component> components, double degrees_of_freedom)
    : NormalMixture(std::move(components), degrees_of_freedom, false) {}

NormalMixture NormalMixture::restored(std::vector<Component> components,
                                      double degrees_of_freedom) {
  return {std::move(components), degrees_of_freedom, true};
}

NormalMixture::NormalMixture(std::vector<Component> components, double degrees_of_freedom,
                             bool normalised)
    : nu_(degrees_of_freedom), components_(std::move(components)) {
  if (components_.empty() || components_.size() > kMaxComponents)
    throw std::invalid_argument("normal mixture: " + std::to_string(components_.size()) +
                                " components, must be 1 to " + std::to_string(kMaxComponents));
  if (!(nu_ > 0.0))
    throw std::invalid_argument("normal mixture: degrees of freedom = " + std::to_string(nu_) +
                                ", must be > 0");
  const Eigen::Index d = components_.front().mean.size();
  dimension_ = static_cast<int>(d);
  double sum = 0.0;
  for (const Component& c : components_) {
    if (d == 0 || c.mean.size() != d || c.factor.rows() != d || c.factor.cols() != d)
      throw std::invalid_argument("normal mixture: a component of dimension " +
                                  std::to_string(c.mean.size()) + ", must be " + std::to_string(d) +
                                  " and at least 1");
    if (!(c.weight > 0.0 && std::isfinite(c.weight)))
      throw std::invalid_argument("normal mixture: weight = " + std::to_string(c.weight) +
                                  ", must be > 0 and finite");
    if (!c.mean.allFinite() || !c.factor.allFinite() || !(c.factor.diagonal().array() > 0.0).all())
      throw std::invalid_argument(
          "normal mixture: means and factors must be finite, factors with a positive diagonal");
    sum += c.weight;
  }
  double running = 0.0;
  for (Component& c : components_) {
    if (!normalised) c.weight /= sum;
    cumulative_.push_back(running += c.weight);
  }
  packed_ = pack(components_, nu_);
}

NormalMixture NormalMixture::standard(int dimension, double sd) {
  return NormalMixture({{1.0, Eigen::VectorXd::Zero(dimension),
                         sd * Eigen::MatrixXd::Identity(dimension, dimension)}});
}

double NormalMixture::log_density(std::span<const double> z) const {
  const auto d = static_cast<std::size_t>(dimension_);
  if (std::isinf(nu_)) {
    const double value = routines().log_density(packed_.data(), groups_of(components_.size()),
                                                group_stride(d), z.data(), d);
    return std::isnan(value) ? -kInfinity : value;
  }
  std::array<double, kMaxComponents> values;
  const std::span<double> used(values.data(), components_.size());
  component_log_densities(z, used);
  const double top = std::ranges::max(used);
  if (!(top > -kInfinity)) return -kInfinity;
  double sum = 0.0;
  for (const double v : used) sum += std::exp(v - top);
  return top + std::log(sum);
}

void NormalMixture::component_log_densities(std::span<const double> z,
                                            std::span<double> out) const {
  const auto d = static_cast<std::size_t>(dimension_);
  const std::size_t stride = group_stride(d);
  std::array<double, kMaxComponents> forms;
  routines().quadratic_forms(packed_.data(), groups_of(components_.size()), stride, z.data(), d,
                             forms.data());
  for (std::size_t k = 0; k < components_.size(); ++k) {
    const double c = packed_[(k / kLanes) * stride + k % kLanes];
    const double value = std::isinf(nu_)
                             ? c - 0.5 * forms[k]
                             : c - 0.5 * (nu_ + dimension_) * std::log1p(forms[k] / nu_);
    out[k] = std::isnan(value) ? -kInfinity : value;
  }
}

int NormalMixture::sample_component(base::Random& random) const {
  const double u = random.uniform();
  const auto k = std::ranges::upper_bound(cumulative_, u) - cumulative_.begin();
  return std::min(static_cast<int>(k), size() - 1);
}

void NormalMixture::sample(base::Random& random, std::span<double> out) const {
  const Component& c = (*this)[sample_component(random)];
  const auto d = static_cast<std::size_t>(dimension_);
  std::array<double, 64> small;
  std::vector<double> large;
  double* normal = small.data();
  if (d > small.size()) {
    large.resize(d);
    normal = large.data();
  }
  for (std::size_t i = 0; i < d; ++i) normal[i] = random.normal();
  const double stretch = std::isinf(nu_) ? 1.0 : std::sqrt(0.5 * nu_ / random.gamma(0.5 * nu_));
  for (std::size_t i = 0; i < d; ++i) {
    double sum = 0.0;
    for (std::size_t j = 0; j <= i; ++j)
      sum += c.factor(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) * normal[j];
    out[i] = c.mean[static_cast<Eigen::Index>(i)] + stretch * sum;
  }
}

void NormalMixture::standardise(int k, std::span<const double> z, std::span<double> u) const {
  const Component& c = (*this)[k];
  for (Eigen::Index i = 0; i < dimension_; ++i) {
    double rest = z[static_cast<std::size_t>(i)] - c.mean[i];
    for (Eigen::Index j = 0; j < i; ++j) rest -= c.factor(i, j) * u[static_cast<std::size_t>(j)];
    u[static_cast<std::size_t>(i)] = rest / c.factor(i, i);
  }
}

void NormalMixture::unstandardise(int k, std::span<const double> u, std::span<double> z) const {
  const Component& c = (*this)[k];
  for (Eigen::Index i = 0; i < dimension_; ++i) {
    double sum = c.mean[i];
    for (Eigen::Index j = 0; j <= i; ++j) sum += c.factor(i, j) * u[static_cast<std::size_t>(j)];
    z[static_cast<std::size_t>(i)] = sum;
  }
}

double NormalMixture::log_determinant(int k) const {
  return log_sum_diagonal((*this)[k].factor);
}

}  // namespace wheeltap::inference
