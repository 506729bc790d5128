#include "identification/sid/base_integration.hpp"

#include <algorithm>

#include "base/eigen_solvers.hpp"
#include "identification/invalid_input.hpp"

namespace wheeltap::identification {
namespace {

using Role = SidChannel::Role;
using dynamics::Quantity;

bool is_absolute_motion(const SidChannel& channel) {
  return channel.role == Role::response && channel.frame == dynamics::Frame::absolute &&
         channel.quantity != Quantity::acceleration;
}

std::vector<double> in_si(const SidCase& sid_case, const SidChannel& channel) {
  const auto& [samples, scale, offset] = channel.signal;
  if (!scale.is_constant() || !offset.is_constant()) {
    throw InvalidInput(
        InvalidInput::Part::channel,
        "the scale and offset of this channel must be numbers, because the base displacement is "
        "integrated from the channel: use numbers, or add a channel with the role "
        "\"base-displacement\"",
        static_cast<int>(&channel - sid_case.channels.data()));
  }
  std::vector<double> out;
  for (const double x : samples) out.push_back(scale.value * x + offset.value);
  return out;
}

/// Velocity and displacement, from rest, for an acceleration that is linear between samples.
struct Integral {
  std::vector<double> velocity, displacement;
};
Integral integrate(const std::vector<double>& a, double dt) {
  Integral out{.velocity = {0.0}, .displacement = {0.0}};
  for (std::size_t n = 0; n + 1 < a.size(); ++n) {
    const double v = out.velocity.back();
    out.displacement.push_back(out.displacement.back() + v * dt +
                               dt * dt * (2.0 * a[n] + a[n + 1]) / 6.0);
    out.velocity.push_back(v + 0.5 * dt * (a[n] + a[n + 1]));
  }
  return out;
}

/// Coefficients of a least-squares polynomial of y over times n · dt, lowest power first.
Eigen::VectorXd trend(const std::vector<double>& y, double dt, int degree) {
  const auto n = static_cast<Eigen::Index>(y.size());
  const double length = static_cast<double>(n) * dt;  // times are divided by this length
  Eigen::MatrixXd powers(n, degree + 1);
  for (Eigen::Index i = 0; i < n; ++i) {
    double power = 1.0;
    for (int p = 0; p <= degree; ++p, power *= static_cast<double>(i) * dt / length) {
      powers(i, p) = power;
    }
  }
  Eigen::VectorXd fit = powers.colPivHouseholderQr().solve(
      Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(y.data(), n)));
  double unit = 1.0;
  for (int p = 0; p <= degree; ++p, unit /= length) fit[p] *= unit;
  return fit;
}

}  // namespace

bool needs_integrated_base(const SidCase& sid_case) {
  return sid_case.find(Role::base_acceleration) != nullptr &&
         sid_case.find(Role::base_displacement) == nullptr &&
         std::ranges::any_of(sid_case.channels, is_absolute_motion);
}

void integrate_base(SidCase& sid_case) {
  const double dt = 1.0 / sid_case.sample_rate_hz, fine = dt / sid_case.stride;
  const Integral base = integrate(in_si(sid_case, *sid_case.find(Role::base_acceleration)), fine);
  const bool displacements = std::ranges::any_of(sid_case.channels, [](const SidChannel& channel) {
    return is_absolute_motion(channel) && channel.quantity == Quantity::displacement;
  });
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  int counted = 0;
  for (const SidChannel& channel : sid_case.channels) {
    const bool counts = is_absolute_motion(channel) &&
                        (channel.quantity == Quantity::displacement) == displacements;
    if (!counts) continue;
    std::vector<double> relative = in_si(sid_case, channel);
    const auto& of_base = displacements ? base.displacement : base.velocity;
    for (std::size_t n = 0; n < relative.size(); ++n) {
      relative[n] -= of_base[n * static_cast<std::size_t>(sid_case.stride)];
    }
    const Eigen::VectorXd fit = trend(relative, dt, displacements ? 2 : 1);
    if (displacements) {
      p += fit;
    } else {
      p += Eigen::Vector3d(0.0, fit[0], 0.5 * fit[1]);
    }
    ++counted;
  }
  p /= counted;
  SidChannel integrated{.column = "base displacement, integrated", .role = Role::base_displacement};
  for (std::size_t n = 0; n < base.displacement.size(); ++n) {
    const double t = static_cast<double>(n) * fine;
    integrated.signal.samples.push_back(base.displacement[n] + p[0] + t * (p[1] + t * p[2]));
  }
  // The acceleration is the second derivative of the displacement, without the sensor's offset.
  for (SidChannel& channel : sid_case.channels)
    if (channel.role == Role::base_acceleration) channel.signal.offset.value += 2.0 * p[2];
  sid_case.channels.push_back(std::move(integrated));
  sid_case.base_integrated = true;
  sid_case.beyond = 0;
  for (SidChannel& channel : sid_case.channels) channel.beyond.clear();
}

}  // namespace wheeltap::identification
