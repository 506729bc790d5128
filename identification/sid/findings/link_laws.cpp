#include "identification/sid/findings/link_laws.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "dynamics/link_tension.hpp"
#include "identification/findings/marginal.hpp"
#include "identification/sid/sid_fit.hpp"

namespace wheeltap::identification {
namespace {

constexpr std::size_t kMostLawDraws = 400;
constexpr int kPoints = 41;

// Parameters of the case for draws of one model, evenly spread over the chains.
std::vector<std::vector<double>> draws_of(const SidProblem& problem,
                                          const inference::Posterior& posterior, int model) {
  std::vector<std::pair<std::size_t, std::size_t>> at;
  for (std::size_t c = 0; c < posterior.chains.size(); ++c) {
    for (std::size_t i = 0; i < posterior.chains[c].model.size(); ++i) {
      if (posterior.chains[c].model[i] == model) at.emplace_back(c, i);
    }
  }
  const auto width = static_cast<std::size_t>(posterior.dimension);
  const std::size_t n = std::min(at.size(), kMostLawDraws);
  std::vector<std::vector<double>> draws;
  for (std::size_t j = 0; j < n; ++j) {
    const auto [c, i] = at[j * at.size() / n];
    draws.push_back(problem.theta(model, {posterior.chains[c].theta.data() + i * width, width}));
  }
  return draws;
}

// Relative displacements or velocities of the masses, samples × masses.
Eigen::MatrixXd motion(const SidProblem& problem, int model, const std::vector<double>& theta,
                       dynamics::Quantity quantity) {
  const SidModel& m = problem.sid_case.models[static_cast<std::size_t>(model)];
  const dynamics::Simulator& simulator =
      problem.misfits[static_cast<std::size_t>(model)].simulator();
  std::vector<dynamics::Sensor> sensors;
  for (int mass = 1; mass <= m.chain.size(); ++mass) {
    sensors.push_back({.mass = mass, .quantity = quantity, .frame = dynamics::Frame::relative});
  }
  return dynamics::Simulator(m.chain, problem.sid_case.excitation(), sensors, m.initial,
                             simulator.options())
      .simulate(theta)
      .values;
}

// Extension or its rate for a link, from the motion of the masses.
Eigen::VectorXd of_link(const Eigen::MatrixXd& z, const dynamics::Link& link) {
  const auto mass = [&](int i) -> Eigen::VectorXd {
    return i == 0 ? Eigen::VectorXd(Eigen::VectorXd::Zero(z.rows()))
                  : Eigen::VectorXd(z.col(i - 1));
  };
  return mass(link.b) - mass(link.a);
}

struct Band {
  std::vector<double> at, q2_5, q50, q97_5;
};

// Quantiles of value(draw, x) over `draws`, at points x evenly spread over the range of `along`.
template <class Value>
Band band(std::size_t draws, const Eigen::VectorXd& along, const Value& value) {
  const double low = along.minCoeff(), high = along.maxCoeff();
  Band out;
  std::vector<double> values(draws);
  for (int i = 0; i < kPoints; ++i) {
    const double x = low + (high - low) * i / (kPoints - 1);
    for (std::size_t d = 0; d < draws; ++d) values[d] = value(d, x);
    std::ranges::sort(values);
    out.at.push_back(x);
    out.q2_5.push_back(quantile(values, 0.025));
    out.q50.push_back(quantile(values, 0.5));
    out.q97_5.push_back(quantile(values, 0.975));
  }
  return out;
}

LinkCurve curve(const dynamics::Link& link, Band band) {
  return {.a = link.a,
          .b = link.b,
          .extension = std::move(band.at),
          .q2_5 = std::move(band.q2_5),
          .q50 = std::move(band.q50),
          .q97_5 = std::move(band.q97_5)};
}

struct Drawn {
  int model = 0;
  std::vector<double> theta;
};

// Draws of all models, in proportion to their weights: evenly spaced over the cumulative weight.
std::vector<Drawn> draws_of_all(const SidProblem& problem, const inference::Posterior& posterior) {
  const std::vector<double> weights = model_weights(posterior);
  double all = 0.0;
  for (const auto& chain : posterior.chains) {
    for (const int m : chain.model) all += weights[static_cast<std::size_t>(m)];
  }
  const auto width = static_cast<std::size_t>(posterior.dimension);
  std::vector<Drawn> out;
  double before = 0.0, next = 0.5 * all / static_cast<double>(kMostLawDraws);
  for (const auto& chain : posterior.chains) {
    for (std::size_t i = 0; i < chain.model.size(); ++i) {
      const int m = chain.model[i];
      before += weights[static_cast<std::size_t>(m)];
      if (before < next) continue;
      out.push_back({m, problem.theta(m, {chain.theta.data() + i * width, width})});
      while (next <= before) next += all / static_cast<double>(kMostLawDraws);
    }
  }
  return out;
}

// ẋ by central differences over ±`step` samples; shorter steps at the ends.
Eigen::VectorXd central_derivative(const Eigen::VectorXd& x, double rate_hz, Eigen::Index step) {
  const Eigen::Index n = x.size();
  Eigen::VectorXd out(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index a = std::max<Eigen::Index>(i - step, 0), b = std::min(i + step, n - 1);
    out(i) = (x(b) - x(a)) * rate_hz / static_cast<double>(b - a);
  }
  return out;
}

// ẍ by second differences over ±`step` samples.
Eigen::VectorXd second_derivative(const Eigen::VectorXd& x, double rate_hz, Eigen::Index step) {
  const Eigen::Index n = x.size();
  Eigen::VectorXd out(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index k = std::clamp<Eigen::Index>(i, step, n - 1 - step);
    out(i) = (x(k + step) - 2.0 * x(k) + x(k - step)) *
             std::pow(rate_hz / static_cast<double>(step), 2.0);
  }
  return out;
}

// Differences over a step h amplify noise by 1/h² and reduce a second derivative by (ωh)²/12.
// Returns the longest step with ωh <= 1/2, where ω is the frequency of the motion.
Eigen::Index difference_step(const Eigen::VectorXd& extension, const Eigen::VectorXd& rate,
                             double rate_hz) {
  const double omega = (rate.array() - rate.mean()).matrix().norm() /
                       (extension.array() - extension.mean()).matrix().norm();
  const double step = 0.5 * rate_hz / omega;
  const auto most = static_cast<double>((extension.size() - 1) / 2);
  return static_cast<Eigen::Index>(std::clamp(std::isfinite(step) ? step : 1.0, 1.0, most));
}

// An excitation at the sampling times of the responses.
Eigen::VectorXd driven(const SidProblem& problem, const SidChannel& channel,
                       std::span<const double> theta, Eigen::Index n) {
  const double scale = channel.signal.scale.at(theta), offset = channel.signal.offset.at(theta);
  Eigen::VectorXd out(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    out(i) = scale * channel.signal.samples[static_cast<std::size_t>(i) *
                                            static_cast<std::size_t>(problem.sid_case.stride)] +
             offset;
  }
  return out;
}

// ∫f dt or, if `twice`, ∫∫f dt², for f linear between samples.
Eigen::VectorXd integral(const Eigen::VectorXd& f, double rate_hz, bool twice) {
  const double dt = 1.0 / rate_hz;
  Eigen::VectorXd once = Eigen::VectorXd::Zero(f.size()), both = once;
  for (Eigen::Index i = 0; i + 1 < f.size(); ++i) {
    once(i + 1) = once(i) + 0.5 * dt * (f(i) + f(i + 1));
    both(i + 1) = both(i) + dt * once(i) + dt * dt * (2.0 * f(i) + f(i + 1)) / 6.0;
  }
  return twice ? both : once;
}

// The force-state map (LinkLaw::map).
std::vector<LinkLaw::Point> force_state_map(const SidProblem& problem, const dynamics::Chain& chain,
                                            const dynamics::Link& link,
                                            const std::vector<double>& theta,
                                            Eigen::VectorXd extension, Eigen::VectorXd rate) {
  const SidCase& sid_case = problem.sid_case;
  const int mass = std::max(link.a, link.b);
  const auto holds = [&](const dynamics::Link& l) { return l.a == mass || l.b == mass; };
  if (std::min(link.a, link.b) != 0 || std::ranges::count_if(chain.links, holds) != 1) return {};
  const double sign = link.b == mass ? 1.0 : -1.0;  // e = y_b - y_a
  const bool moving = sid_case.find(SidChannel::Role::base_acceleration) != nullptr ||
                      sid_case.find(SidChannel::Role::base_displacement) != nullptr;
  const SidChannel* sensor = nullptr;
  for (const SidChannel* channel : sid_case.responses()) {
    if (channel->mass == mass && (sensor == nullptr || channel->quantity > sensor->quantity)) {
      sensor = channel;
    }
  }
  const SidChannel* base = sid_case.find(SidChannel::Role::base_acceleration);
  if (sensor == nullptr || extension.size() < 4 || (moving && base == nullptr)) return {};
  const Eigen::Index n = extension.size();
  Eigen::VectorXd measured(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    measured(i) =
        sensor->signal.scale.at(theta) * sensor->signal.samples[static_cast<std::size_t>(i)] +
        sensor->signal.offset.at(theta);
  }
  const double hz = sid_case.sample_rate_hz;
  const Eigen::Index step = difference_step(extension, rate, hz);
  const bool relative = !moving || sensor->frame == dynamics::Frame::relative;
  if (sensor->quantity != dynamics::Quantity::acceleration && !relative) return {};
  // Differences average the acceleration over their step. The differences of the integrated
  // excitation average in the same way.
  const auto as_accelerations = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
    return sensor->quantity == dynamics::Quantity::displacement ? second_derivative(x, hz, step)
           : sensor->quantity == dynamics::Quantity::velocity   ? central_derivative(x, hz, step)
                                                                : x;
  };
  const auto averaged = [&](const SidChannel& channel) -> Eigen::VectorXd {
    const Eigen::VectorXd f = driven(problem, channel, theta, n);
    if (sensor->quantity == dynamics::Quantity::acceleration) return f;
    return as_accelerations(integral(f, hz, sensor->quantity == dynamics::Quantity::displacement));
  };
  if (sensor->quantity == dynamics::Quantity::displacement) {
    extension = sign * measured;
    rate = sign * central_derivative(measured, hz, step);
  } else if (sensor->quantity == dynamics::Quantity::velocity) {
    rate = sign * measured;
  }
  Eigen::VectorXd acceleration = as_accelerations(measured);
  if (moving && relative) acceleration += averaged(*base);
  const double m = chain.masses[static_cast<std::size_t>(mass - 1)].at(theta);
  Eigen::VectorXd force = -m * acceleration;
  for (const SidChannel& channel : sid_case.channels) {
    if (channel.role == SidChannel::Role::force && channel.mass == mass) {
      force += averaged(channel);
    }
  }
  constexpr Eigen::Index kMostPoints = 500;
  const Eigen::Index first = sid_case.lead_in, scored = n - first;
  const Eigen::Index each = std::max<Eigen::Index>(1, (scored + kMostPoints - 1) / kMostPoints);
  std::vector<LinkLaw::Point> out;
  // The tension of the link acts on mass b with negative sign.
  for (Eigen::Index i = first; i < n; i += each) {
    out.push_back({extension(i), rate(i), sign * force(i)});
  }
  return out;
}

}  // namespace

std::vector<LinkLaw> averaged_laws(const SidProblem& problem, const inference::Posterior& posterior,
                                   int shown, const std::vector<int>& links) {
  const std::vector<double> theta = posterior_mean(problem, posterior, shown);
  const Eigen::MatrixXd z = motion(problem, shown, theta, dynamics::Quantity::displacement);
  const Eigen::MatrixXd v = motion(problem, shown, theta, dynamics::Quantity::velocity);
  if (z.rows() == 0 || v.rows() == 0) return {};
  const std::vector<Drawn> draws = draws_of_all(problem, posterior);
  const dynamics::Chain& chain = problem.sid_case.models[static_cast<std::size_t>(shown)].chain;
  std::vector<LinkLaw> out;
  for (const int l : links) {
    const auto at = static_cast<std::size_t>(l);
    const dynamics::Link& link = chain.links[at];
    const Eigen::VectorXd e = of_link(z, link), rate = of_link(v, link);
    const auto tension = [&](std::size_t d, double extension, double speed) {
      const auto m = static_cast<std::size_t>(draws[d].model);
      return dynamics::tension(problem.sid_case.models[m].chain.links[at], draws[d].theta,
                               extension, speed);
    };
    LinkLaw law;
    law.at_rest = curve(
        link, band(draws.size(), e, [&](std::size_t d, double x) { return tension(d, x, 0.0); }));
    Band moving =
        band(draws.size(), rate, [&](std::size_t d, double x) { return tension(d, 0.0, x); });
    law.rate = std::move(moving.at), law.q2_5 = std::move(moving.q2_5);
    law.q50 = std::move(moving.q50), law.q97_5 = std::move(moving.q97_5);
    law.map = force_state_map(problem, chain, link, theta, e, rate);
    out.push_back(std::move(law));
  }
  return out;
}

std::optional<std::vector<LinkCurve>> link_laws(const SidProblem& problem,
                                                const inference::Posterior& posterior, int model) {
  const Eigen::MatrixXd z = motion(problem, model, posterior_mean(problem, posterior, model),
                                   dynamics::Quantity::displacement);
  if (z.rows() == 0) return {};
  const auto draws = draws_of(problem, posterior, model);
  std::vector<LinkCurve> out;
  for (const auto& link : problem.sid_case.models[static_cast<std::size_t>(model)].chain.links) {
    const Eigen::VectorXd e = of_link(z, link);
    if (!(e.maxCoeff() > e.minCoeff())) continue;
    out.push_back(curve(link, band(draws.size(), e, [&](std::size_t d, double x) {
                          return dynamics::resting_tension(link, draws[d], x);
                        })));
  }
  return out;
}

}  // namespace wheeltap::identification
