#include "dynamics/simulate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "dynamics/simulator_impl.hpp"

namespace wheeltap::dynamics {

using detail::fail, detail::Key, detail::kInfeasible, detail::kTooManySteps,
    detail::kUsualStepLimit, detail::Lane;

namespace {

/// Memory of one thread, aligned to 64 bytes; it grows as required.
class Scratch {
 public:
  double* take(std::size_t doubles) {
    if (doubles > size_) {
      memory_.reset(new (std::align_val_t{64}) double[doubles]);
      size_ = doubles;
    }
    return memory_.get();
  }

 private:
  struct Free {
    void operator()(double* p) const { operator delete[](p, std::align_val_t{64}); }
  };
  std::unique_ptr<double[], Free> memory_;
  std::size_t size_ = 0;
};

/// Memory of one thread for the simulation of several parameter vectors.
struct ThreadMemory {
  Scratch coefficients, exact, trajectory;
  std::vector<double> values;  ///< [set][slot]
  std::vector<double> paces;   ///< [link]
  std::vector<std::pair<Key, int>> order;
};

ThreadMemory& thread_memory() {
  thread_local ThreadMemory memory;
  return memory;
}

/// The longest piece of a series [1/ω] for step limits of at least kUsualStepLimit.
constexpr double kLongestPiece = 0.7;

/// Degree of a series for a piece of length x/ω: the truncation error of a velocity is at most
/// xᴰ/D! = 3e-10 per piece. A cubic spring alone has its nearest pole at 3.2/ω, with an error of
/// about (x/3.2)ᴰ⁺¹.
int degree_of_series(double x) {
  return x <= 0.15 ? 7 : x <= 0.35 ? 9 : kernel::kMaxDegree;
}

/// Rounds up to 1, 2, 3, 4, 6, 8, 12, …. With few different counts, more parameter vectors can be
/// integrated together.
int ladder(double steps) {
  for (int power = 1; power <= kMaxSubsteps; power *= 2) {
    if (steps <= power) return power;
    if (power > 1 && steps <= power + power / 2) return power + power / 2;
  }
  return -1;
}

Outcome outcome_of(double failed) {
  return failed == 0.0                     ? Outcome::complete
         : failed == kernel::kStepsTooLong ? Outcome::steps_too_long
                                           : Outcome::diverged;
}

/// Sets key.halvings. `frequency` and `damping` are ω h and γ h for the time h between samples.
Key with_halvings(Key key, double frequency, double damping) {
  const double norm = std::max(1.0, frequency * frequency + damping);
  key.halvings = 1 + static_cast<int>(std::ceil(std::log2(norm)));
  return key.halvings <= 60 ? key : kTooManySteps;
}

}  // namespace

Key Simulator::Impl::key(std::span<const double> theta) const {
  for (const Coefficient& mass : chain.masses)
    if (!(mass.at(theta) > 0.0)) return kInfeasible;
  for (const Link& link : chain.links)
    for (const Law& law : link.laws) {
      std::array<double, kMaxLawCoefficients> c;
      for (std::size_t i = 0; i < c.size(); ++i) c[i] = law.coefficients[i].at(theta);
      if (!is_feasible(law.kind, c.data()) || has_zero_creep_speed(law, c.data()))
        return kInfeasible;
    }
  const bool exact = integrator == Integrator::exact;
  if (integrator == Integrator::runge_kutta && options.substeps > 0)
    return {.substeps = options.substeps};
  const Rates rates = stiffest_rates(chain, theta, options.extension);
  const double h = task.step, frequency = rates.frequency * h, damping = rates.damping * h;
  if (!std::isfinite(frequency) || !std::isfinite(damping)) return kInfeasible;
  if (exact) return with_halvings({}, frequency, damping);
  const double fastest = std::max(frequency, damping);
  // A refined simulator makes at least `refinement` times as many steps as the coarse simulator,
  // even if rounding to the allowed counts would give fewer steps.
  const auto at_least_refined = [&](const auto& steps) {
    const int coarse = ladder(steps(options.step_limit * options.refinement));
    const int count = std::max(ladder(steps(options.step_limit)), options.refinement * coarse);
    return coarse > 0 && count <= kMaxSubsteps ? count : -1;
  };
  if (integrator == Integrator::runge_kutta) {
    const int substeps = at_least_refined([&](double limit) {
      return std::max(frequency / limit, damping * std::max(1.0, kUsualStepLimit / limit));
    });
    return substeps > 0 ? Key{.substeps = substeps} : kTooManySteps;
  }
  const int pieces = options.substeps > 0 ? options.substeps : at_least_refined([&](double limit) {
    return fastest / (kLongestPiece * std::min(1.0, limit / kUsualStepLimit));
  });
  if (pieces < 0) return kTooManySteps;
  int degree = degree_of_series(fastest / pieces);
  // The series of the tension of a sticking link has two terms fewer.
  if (task.frictions > 0) degree = std::min(degree + 2, kernel::kMaxDegree);
  const Key key{.substeps = pieces, .degree = degree};
  return integrator == Integrator::series ? key : with_halvings(key, frequency, damping);
}

void Simulator::Impl::run(std::span<const double> thetas, int sets,
                          const std::vector<kernel::SensorTerm>& sensor_terms,
                          std::span<const Coefficient> all_slots, int lead_in, bool sums,
                          detail::Receiver receive, std::span<const double> weights,
                          std::span<const double> limits) const {
  ThreadMemory& memory = thread_memory();
  const auto count = static_cast<std::size_t>(sets);
  const std::size_t dimension = count == 0 ? 0 : thetas.size() / count;
  const std::size_t width = all_slots.size();
  memory.values.resize(count * width);
  memory.order.clear();
  for (std::size_t set = 0; set < count; ++set) {
    const auto theta = thetas.subspan(set * dimension, dimension);
    for (std::size_t slot = 0; slot < width; ++slot)
      memory.values[set * width + slot] = all_slots[slot].at(theta);
    const Key group = key(theta);
    memory.order.emplace_back(group, static_cast<int>(set));
    if (!task.paced || group.substeps < 0) continue;
    memory.paces.resize(links.size());
    paces(chain, theta, memory.paces);
    for (std::size_t link = 0; link < links.size(); ++link)
      memory.values[set * width + static_cast<std::size_t>(links[link].pace_slot)] =
          memory.paces[link];
  }
  std::sort(memory.order.begin(), memory.order.end());

  const auto most = static_cast<std::size_t>(kernels.back()->lanes);
  alignas(64) std::array<double, 8> failed;
  kernel::Task work = task;
  work.sensor = sensor_terms.data();
  work.sensors = static_cast<int>(sensor_terms.size());
  work.lead_in = lead_in;
  work.failed = failed.data();
  const std::size_t channels = sensor_terms.size();
  double* table = memory.coefficients.take((width + 2 * channels + 1) * most);
  double* totals = table + width * most;
  double* weight_table = totals + channels * most;
  double* limit_table = weight_table + channels * most;
  if (!limits.empty()) {
    work.weights = weight_table;
    work.limit = limit_table;
  }
  work.coefficients = table;
  const auto scratch = static_cast<std::size_t>(
      integrator == Integrator::piecewise
          ? kernel::scratch_size(work.masses, work.drives, work.sensors, work.laws)
          : kernel::scratch_size(work.masses, work.drives, work.sensors));
  if (integrator == Integrator::exact || integrator == Integrator::piecewise)
    work.scratch = memory.exact.take(scratch * most);
  if (sums)
    work.sums = totals;
  else
    work.trajectory =
        memory.trajectory.take(static_cast<std::size_t>(response_samples()) * channels * most);

  for (std::size_t begin = 0; begin < count;) {
    const Key group = memory.order[begin].first;
    std::size_t end = begin;
    while (end < count && end - begin < most && memory.order[end].first == group) ++end;
    // The narrowest kernel with enough lanes for the group. Wider vectors take more time.
    const kernel::Kernel& kernel = **std::find_if(
        kernels.begin(), kernels.end() - 1,
        [&](const kernel::Kernel* k) { return static_cast<std::size_t>(k->lanes) >= end - begin; });
    const auto lanes = static_cast<std::size_t>(kernel.lanes);
    const bool possible = group != kInfeasible && group != kTooManySteps;
    if (possible) {
      for (std::size_t lane = 0; lane < lanes; ++lane) {  // idle lanes repeat the last set
        const auto set =
            static_cast<std::size_t>(memory.order[std::min(begin + lane, end - 1)].second);
        for (std::size_t slot = 0; slot < width; ++slot)
          table[slot * lanes + lane] = memory.values[set * width + slot];
        if (limits.empty()) continue;
        for (std::size_t c = 0; c < channels; ++c)
          weight_table[c * lanes + lane] = weights[set * channels + c];
        limit_table[lane] = limits[set];
      }
      work.substeps = group.substeps;
      work.degree = group.degree;
      work.halvings = group.halvings;
      (integrator == Integrator::exact       ? kernel.exact
       : integrator == Integrator::piecewise ? kernel.piecewise
       : integrator == Integrator::series    ? kernel.series
                                             : kernel.runge_kutta)(work);
    }
    for (std::size_t i = begin; i < end; ++i)
      receive({.set = static_cast<std::size_t>(memory.order[i].second),
               .key = group,
               .outcome = possible               ? outcome_of(failed[i - begin])
                          : group == kInfeasible ? Outcome::impossible
                                                 : Outcome::steps_too_long,
               .lane = i - begin,
               .lanes = lanes},
              work);
    begin = end;
  }
}

Simulator::Simulator(Chain chain, Excitation excitation, std::vector<Sensor> sensors,
                     InitialState initial, SimulatorOptions options) {
  auto impl = std::make_shared<Impl>();
  impl->chain = std::move(chain);
  impl->excitation = std::move(excitation);
  impl->sensors = std::move(sensors);
  impl->initial = std::move(initial);
  impl->options = std::move(options);
  impl->check();
  impl->compile();
  impl_ = std::move(impl);
}

Simulator Simulator::refined(int factor) const {
  if (factor < 1) fail("factor = " + std::to_string(factor) + ", must be at least 1");
  SimulatorOptions options = impl_->options;
  options.step_limit /= factor;
  options.refinement *= factor;
  options.substeps *= factor;
  return with(impl_->sensors, std::move(options));
}

Simulator Simulator::with(std::vector<Sensor> sensors, SimulatorOptions options) const {
  return {impl_->chain, impl_->excitation, std::move(sensors), impl_->initial, std::move(options)};
}

const Chain& Simulator::chain() const {
  return impl_->chain;
}
const SimulatorOptions& Simulator::options() const {
  return impl_->options;
}
Integrator Simulator::integrator() const {
  return impl_->integrator;
}
const std::vector<Sensor>& Simulator::sensors() const {
  return impl_->sensors;
}
int Simulator::samples() const {
  return impl_->response_samples();
}
int Simulator::parameters() const {
  return impl_->parameters;
}

int Simulator::substeps(std::span<const double> theta) const {
  detail::require_parameters(theta, 1, impl_->parameters);
  return std::max(-1, impl_->key(theta).substeps);
}

Response Simulator::simulate(std::span<const double> theta) const {
  return std::move(simulate_batch(theta, 1).front());
}

std::vector<Response> Simulator::simulate_batch(std::span<const double> thetas, int sets) const {
  detail::require_parameters(thetas, sets, impl_->parameters);
  std::vector<Response> responses(static_cast<std::size_t>(sets));
  const auto samples = static_cast<Eigen::Index>(this->samples());
  const auto channels = static_cast<Eigen::Index>(impl_->sensors.size());
  const auto receive = [&](const Lane& lane, const kernel::Task& task) {
    Response& response = responses[lane.set];
    response.outcome = lane.outcome;
    response.failed = lane.outcome != Outcome::complete;
    response.substeps = std::max(0, lane.key.substeps);
    if (response.failed) return;
    response.values.resize(samples, channels);
    const double* value = task.trajectory + lane.lane;
    for (Eigen::Index n = 0; n < samples; ++n)
      for (Eigen::Index c = 0; c < channels; ++c, value += lane.lanes)
        response.values(n, c) = *value;
  };
  impl_->run(thetas, sets, impl_->terms, impl_->slots, 0, false, receive);
  return responses;
}

}  // namespace wheeltap::dynamics
