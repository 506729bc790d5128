#include "identification/sid/findings/link_paths.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "base/eigen_solvers.hpp"
#include "identification/sid/sid_predictive.hpp"

namespace wheeltap::identification {
namespace {

using dynamics::Frame;
using dynamics::Quantity;

constexpr double kMostNoise = 0.1;   // relative to the range of the tension
constexpr double kUnused = 1e-9;     // a smaller coefficient of a mass counts as zero
constexpr std::size_t kReach = 4;    // samples on each side of an eighth-order difference
constexpr std::size_t kFewest = 16;  // samples

// Central differences of order eight (Fornberg 1988, table 1): weights of samples 0, ±1, … ±4.
constexpr std::array<double, kReach + 1> kFirst = {0.0, 4.0 / 5, -1.0 / 5, 4.0 / 105, -1.0 / 280};
constexpr std::array<double, kReach + 1> kSecond = {-205.0 / 72, 8.0 / 5, -1.0 / 5, 8.0 / 315,
                                                    -1.0 / 560};

// Samples and the sd of their noise.
struct Noisy {
  std::vector<double> values;
  double sd = 0.0;
  bool differentiated = false;
};

// Sixth differences of white noise of variance σ² have variance C(12, 6) σ²; a motion with at least
// ten samples per period contributes little.
double noise_sd(const std::vector<double>& y) {
  double sum = 0.0;
  for (std::size_t n = 3; n + 3 < y.size(); ++n) {
    const double d = -20.0 * y[n] + 15.0 * (y[n - 1] + y[n + 1]) - 6.0 * (y[n - 2] + y[n + 2]) +
                     y[n - 3] + y[n + 3];
    sum += d * d;
  }
  return std::sqrt(sum / (924.0 * static_cast<double>(y.size() - 6)));
}

// Derivative of `order` 1 or 2; NaN at the ends.
Noisy derivative(const std::vector<double>& y, int order, double rate) {
  const auto& weights = order == 1 ? kFirst : kSecond;
  const double sign = order == 1 ? -1.0 : 1.0, scale = std::pow(rate, order);
  Noisy out{std::vector<double>(y.size(), std::numeric_limits<double>::quiet_NaN()), 0.0, true};
  for (std::size_t n = kReach; n + kReach < y.size(); ++n) {
    double sum = weights[0] * y[n];
    for (std::size_t j = 1; j <= kReach; ++j) sum += weights[j] * (y[n + j] + sign * y[n - j]);
    out.values[n] = scale * sum;
  }
  double squares = weights[0] * weights[0];
  for (std::size_t j = 1; j <= kReach; ++j) squares += 2.0 * weights[j] * weights[j];
  out.sd = scale * std::sqrt(squares) * noise_sd(y);
  return out;
}

// The scored samples of an excitation channel [SI].
std::vector<double> scored(const SidCase& sid_case, const SidChannel& channel, std::size_t samples,
                           std::span<const double> theta) {
  const auto stride = static_cast<std::size_t>(sid_case.stride);
  const double scale = channel.signal.scale.at(theta), offset = channel.signal.offset.at(theta);
  std::vector<double> out;
  for (std::size_t n = 0; n < samples; ++n) {
    const std::size_t at = (static_cast<std::size_t>(sid_case.lead_in) + n) * stride;
    out.push_back(scale * channel.signal.samples[at] + offset);
  }
  return out;
}

// The measured motion of each mass.
class Record {
 public:
  Record(const SidProblem& problem, std::span<const double> theta, std::size_t samples)
      : problem_(problem), theta_(theta), samples_(samples) {
    const SidCase& c = problem.sid_case;
    base_ = c.find(SidChannel::Role::base_acceleration);
    driven_ = base_ != nullptr || c.find(SidChannel::Role::base_displacement) != nullptr;
  }

  // Absolute acceleration.
  [[nodiscard]] std::optional<Noisy> acceleration(int mass) const {
    for (const Quantity q : {Quantity::acceleration, Quantity::velocity, Quantity::displacement}) {
      const auto [channel, response] = find(mass, q);
      if (channel == nullptr) continue;
      const bool relative = driven_ && channel->frame == Frame::relative;
      if (relative && base_ == nullptr) continue;
      std::vector<double> y = observed(problem_, response, theta_);
      Noisy out = q == Quantity::acceleration ? Noisy{std::move(y), 0.0, false}
                                              : derivative(y, q == Quantity::velocity ? 1 : 2,
                                                           problem_.sid_case.sample_rate_hz);
      if (relative) {
        const auto base = scored(problem_.sid_case, *base_, samples_, theta_);
        for (std::size_t n = 0; n < samples_; ++n) out.values[n] += base[n];
      }
      return out;
    }
    return {};
  }

  // Displacement relative to the base.
  [[nodiscard]] std::vector<double> displacement(int mass) const {
    if (mass == 0) return std::vector<double>(samples_);
    const auto [channel, response] = find(mass, Quantity::displacement);
    if (channel == nullptr || (driven_ && channel->frame == Frame::absolute)) return {};
    return observed(problem_, response, theta_);
  }

 private:
  [[nodiscard]] std::pair<const SidChannel*, std::size_t> find(int mass, Quantity quantity) const {
    const auto responses = problem_.sid_case.responses();
    for (std::size_t c = 0; c < responses.size(); ++c) {
      if (responses[c]->mass == mass && responses[c]->quantity == quantity) {
        return {responses[c], c};
      }
    }
    return {nullptr, 0};
  }

  const SidProblem& problem_;
  std::span<const double> theta_;
  std::size_t samples_;
  const SidChannel* base_ = nullptr;
  bool driven_ = false;
};

// T = Σ_j W_j (m_j ÿ_j - F_j) with measured ÿ_j; empty if an ÿ_j is missing or too noisy.
Noisy measured_tension(const Record& record, const Eigen::RowVectorXd& weights,
                       std::span<const double> masses, const Eigen::MatrixXd& forces,
                       double range) {
  Noisy out;
  double variance = 0.0;
  for (Eigen::Index j = 0; j < weights.size(); ++j) {
    if (std::abs(weights[j]) < kUnused) continue;
    const auto acceleration = record.acceleration(static_cast<int>(j) + 1);
    if (!acceleration) return {};
    const double inertia = weights[j] * masses[static_cast<std::size_t>(j)];
    variance += std::pow(inertia * acceleration->sd, 2);
    out.differentiated = out.differentiated || acceleration->differentiated;
    out.values.resize(acceleration->values.size());
    for (std::size_t n = 0; n < out.values.size(); ++n) {
      out.values[n] +=
          inertia * acceleration->values[n] - weights[j] * forces(static_cast<Eigen::Index>(n), j);
    }
  }
  out.sd = std::sqrt(variance);
  return out.sd <= kMostNoise * range ? out : Noisy{};
}

}  // namespace

std::vector<LinkPath> link_paths(const SidProblem& problem, int model,
                                 std::span<const double> theta) {
  const SidCase& sid_case = problem.sid_case;
  const dynamics::Chain& chain = sid_case.models[static_cast<std::size_t>(model)].chain;
  const dynamics::Misfit& misfit = problem.misfits[static_cast<std::size_t>(model)];
  const auto samples = static_cast<std::size_t>(misfit.samples());
  const int n = chain.size();
  std::vector<LinkPath> out;
  for (const dynamics::Link& link : chain.links) {
    const bool known = std::ranges::any_of(out, [&](const LinkPath& p) {
      return std::minmax(p.a, p.b) == std::minmax(link.a, link.b);
    });
    if (known) continue;
    out.emplace_back();
    out.back().a = link.a, out.back().b = link.b;
  }
  // Balance of forces Σ ±T = B T: the tension acts as +T on mass a and as -T on mass b.
  Eigen::MatrixXd pull = Eigen::MatrixXd::Zero(n, static_cast<Eigen::Index>(out.size()));
  for (std::size_t p = 0; p < out.size(); ++p) {
    if (out[p].a > 0) pull(out[p].a - 1, static_cast<Eigen::Index>(p)) = 1.0;
    if (out[p].b > 0) pull(out[p].b - 1, static_cast<Eigen::Index>(p)) = -1.0;
  }
  const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solved(pull);
  if (samples < kFewest || solved.rank() < pull.cols()) return {};
  const Eigen::MatrixXd weights = solved.pseudoInverse();

  std::vector<dynamics::Sensor> sensors;
  for (int mass = 1; mass <= n; ++mass) {
    sensors.push_back({mass, Quantity::displacement, Frame::relative});
    sensors.push_back({mass, Quantity::velocity, Frame::relative});
    sensors.push_back({mass, Quantity::acceleration, Frame::absolute});
  }
  const dynamics::Response motion =
      misfit.simulator().with(sensors, misfit.simulator().options()).simulate(theta);
  if (motion.failed) return {};
  const Eigen::MatrixXd scored_motion =
      motion.values.bottomRows(static_cast<Eigen::Index>(samples));
  const auto moved = [&](int mass, int what, std::size_t at) {
    return mass == 0 ? 0.0 : scored_motion(static_cast<Eigen::Index>(at), 3 * (mass - 1) + what);
  };

  Eigen::MatrixXd forces = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(samples), n);
  for (const SidChannel& channel : sid_case.channels) {
    if (channel.role != SidChannel::Role::force) continue;
    const auto values = scored(sid_case, channel, samples, theta);
    for (std::size_t s = 0; s < samples; ++s) {
      forces(static_cast<Eigen::Index>(s), channel.mass - 1) += values[s];
    }
  }
  std::vector<double> masses;
  for (const auto& mass : chain.masses) masses.push_back(mass.at(theta));

  const Record record(problem, theta, samples);
  for (std::size_t p = 0; p < out.size(); ++p) {
    LinkPath& path = out[p];
    const Eigen::RowVectorXd w = weights.row(static_cast<Eigen::Index>(p));
    for (std::size_t s = 0; s < samples; ++s) {
      path.extension.push_back(moved(path.b, 0, s) - moved(path.a, 0, s));
      path.rate.push_back(moved(path.b, 1, s) - moved(path.a, 1, s));
      double tension = 0.0;
      for (int j = 0; j < n; ++j) {
        tension += w[j] * (masses[static_cast<std::size_t>(j)] * moved(j + 1, 2, s) -
                           forces(static_cast<Eigen::Index>(s), j));
      }
      path.tension.push_back(tension);
    }
    const auto [low, high] = std::ranges::minmax(path.tension);
    Noisy measured = measured_tension(record, w, masses, forces, high - low);
    if (measured.values.empty()) continue;
    path.measured = std::move(measured.values);
    path.differentiated = measured.differentiated;
    const auto a = record.displacement(path.a), b = record.displacement(path.b);
    if (a.empty() || b.empty()) continue;
    for (std::size_t s = 0; s < samples; ++s) path.measured_extension.push_back(b[s] - a[s]);
  }
  return out;
}

}  // namespace wheeltap::identification
