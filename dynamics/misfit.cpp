// The misfit of a simulated response to a measured response (class Misfit of simulate.hpp).
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "dynamics/simulator_impl.hpp"

namespace wheeltap::dynamics {

using detail::fail, detail::Lane, detail::require_parameters;

struct Misfit::Impl {
  Simulator simulator;
  std::vector<Signal> observed;
  int lead_in = 0;
  std::vector<Coefficient> slots;
  std::vector<kernel::SensorTerm> terms;
  int parameters = 0;
};

Misfit::Misfit(Simulator simulator, std::vector<Signal> observed, int lead_in) {
  auto impl =
      std::make_shared<Impl>(Impl{std::move(simulator), std::move(observed), lead_in, {}, {}});
  const Simulator::Impl& simulation = *impl->simulator.impl_;
  const int samples = impl->simulator.samples();
  if (impl->observed.size() != simulation.sensors.size())
    fail(std::to_string(impl->observed.size()) + " observed signals, must be one per sensor (" +
         std::to_string(simulation.sensors.size()) + ")");
  if (lead_in < 0 || lead_in >= samples)
    fail("lead-in = " + std::to_string(lead_in) + " samples, must be in [0, " +
         std::to_string(samples) + ")");
  impl->slots = simulation.slots;
  impl->terms = simulation.terms;
  for (std::size_t c = 0; c < impl->observed.size(); ++c) {
    const Signal& signal = impl->observed[c];
    if (signal.samples.size() != static_cast<std::size_t>(samples))
      fail("observed signal " + std::to_string(c) + " has " +
           std::to_string(signal.samples.size()) + " samples, must be " + std::to_string(samples));
    for (std::size_t n = static_cast<std::size_t>(lead_in); n < signal.samples.size(); ++n)
      if (!std::isfinite(signal.samples[n]))
        fail("observed signal " + std::to_string(c) + ", sample " + std::to_string(n) +
             " is not finite");
    impl->terms[c].observed = signal.samples.data();
    impl->terms[c].slot = static_cast<int>(impl->slots.size());
    impl->slots.push_back(signal.scale);
    impl->slots.push_back(signal.offset);
  }
  for (const Coefficient& c : impl->slots)
    impl->parameters = std::max(impl->parameters, c.parameter + 1);
  impl_ = std::move(impl);
}

Misfit Misfit::refined(int factor) const {
  return {impl_->simulator.refined(factor), impl_->observed, impl_->lead_in};
}

const Simulator& Misfit::simulator() const {
  return impl_->simulator;
}
int Misfit::channels() const {
  return static_cast<int>(impl_->observed.size());
}
int Misfit::samples() const {
  return impl_->simulator.samples() - impl_->lead_in;
}
int Misfit::parameters() const {
  return impl_->parameters;
}

void Misfit::sums_of_squares(std::span<const double> thetas, int sets,
                             std::span<double> out) const {
  sums_of_squares_within(thetas, sets, {}, {}, out);
}

void Misfit::sums_of_squares_within(std::span<const double> thetas, int sets,
                                    std::span<const double> weights, std::span<const double> limits,
                                    std::span<double> out) const {
  require_parameters(thetas, sets, impl_->parameters);
  const std::size_t channels = impl_->observed.size();
  if (out.size() != static_cast<std::size_t>(sets) * channels)
    fail("the array has " + std::to_string(out.size()) + " sums, must have " +
         std::to_string(static_cast<std::size_t>(sets) * channels));
  if (!limits.empty() &&
      (limits.size() != static_cast<std::size_t>(sets) || weights.size() != out.size()))
    fail(std::to_string(limits.size()) + " limits and " + std::to_string(weights.size()) +
         " weights, must be " + std::to_string(sets) + " and " + std::to_string(out.size()));
  const auto receive = [&](const Lane& lane, const kernel::Task& task) {
    const std::size_t first = lane.set * channels;
    bool complete = lane.outcome == Outcome::complete;
    double total = 0.0;
    for (std::size_t c = 0; c < channels; ++c) {
      const double sum = complete ? task.sums[c * lane.lanes + lane.lane] : 0.0;
      out[first + c] =
          complete && std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
      if (!limits.empty()) total += weights[first + c] * out[first + c];
    }
    complete = complete && (limits.empty() || total <= limits[lane.set]);
    if (!complete)
      std::fill_n(out.begin() + static_cast<std::ptrdiff_t>(first), channels,
                  std::numeric_limits<double>::infinity());
  };
  impl_->simulator.impl_->run(thetas, sets, impl_->terms, impl_->slots, impl_->lead_in, true,
                              receive, weights, limits);
}

bool Misfit::sums_of_squares_within(std::span<const double> theta, std::span<const double> weights,
                                    double limit, std::span<double> out) const {
  require_parameters(theta, 1, impl_->parameters);
  const std::size_t channels = impl_->observed.size();
  if (out.size() != channels || weights.size() != channels)
    fail("arrays of " + std::to_string(out.size()) + " sums and " + std::to_string(weights.size()) +
         " weights, must have " + std::to_string(channels));
  bool within = false;
  const auto receive = [&](const Lane& lane, const kernel::Task& task) {
    if (lane.outcome != Outcome::complete) return;
    double total = 0.0;
    for (std::size_t c = 0; c < channels; ++c) {
      out[c] = task.sums[c * lane.lanes + lane.lane];
      total += weights[c] * out[c];
    }
    within = total <= limit;
  };
  impl_->simulator.impl_->run(theta, 1, impl_->terms, impl_->slots, impl_->lead_in, true, receive,
                              weights, {&limit, 1});
  return within;
}

bool Misfit::residuals(std::span<const double> theta, std::span<double> out) const {
  char done = 0;
  residuals(theta, 1, out, {&done, 1});
  return done != 0;
}

void Misfit::residuals(std::span<const double> thetas, int sets, std::span<double> out,
                       std::span<char> done) const {
  require_parameters(thetas, sets, impl_->parameters);
  const auto samples = static_cast<std::size_t>(this->samples());
  const auto count = static_cast<std::size_t>(sets);
  const std::size_t channels = impl_->observed.size(), each = samples * channels;
  if (out.size() != each * count || done.size() != count)
    fail("arrays of " + std::to_string(out.size()) + " residuals of " +
         std::to_string(done.size()) + " vectors, must be " + std::to_string(each * count) +
         " of " + std::to_string(count));
  const std::size_t dimension = count == 0 ? 0 : thetas.size() / count;
  const auto receive = [&](const Lane& lane, const kernel::Task& task) {
    done[lane.set] = lane.outcome == Outcome::complete ? 1 : 0;
    if (done[lane.set] == 0) return;
    const auto theta = thetas.subspan(lane.set * dimension, dimension);
    const auto lead_in = static_cast<std::size_t>(impl_->lead_in);
    for (std::size_t c = 0; c < channels; ++c) {
      const Signal& signal = impl_->observed[c];
      const double scale = signal.scale.at(theta), offset = signal.offset.at(theta);
      for (std::size_t n = 0; n < samples; ++n)
        out[lane.set * each + c * samples + n] =
            scale * signal.samples[n + lead_in] + offset -
            task.trajectory[((n + lead_in) * channels + c) * lane.lanes + lane.lane];
    }
  };
  impl_->simulator.impl_->run(thetas, sets, impl_->terms, impl_->slots, 0, false, receive);
}

bool Misfit::depends_on(int parameter) const {
  return std::ranges::any_of(impl_->slots,
                             [&](const Coefficient& c) { return c.parameter == parameter; });
}

}  // namespace wheeltap::dynamics
