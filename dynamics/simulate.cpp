#include "dynamics/simulate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "dynamics/kernel.hpp"
#include "signals/spline.hpp"

namespace wheeltap::dynamics {

namespace {

[[noreturn]] void fail(const std::string& what) {
  throw std::invalid_argument("simulator: " + what);
}

bool cpu_has(Instructions instructions) {
#ifdef WHEELTAP_X86_KERNELS
  if (instructions == Instructions::avx2) return __builtin_cpu_supports("avx2") != 0;
  if (instructions == Instructions::avx512)
    return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512dq") != 0 &&
           __builtin_cpu_supports("avx512vl") != 0;
#else
  if (instructions == Instructions::avx2 || instructions == Instructions::avx512) return false;
#endif
  return true;
}

/// The kernels to choose from, narrowest first: the one asked for, or all that this processor has.
std::vector<kernel::Kernel> make_kernels(Instructions instructions) {
  if (!cpu_has(instructions)) fail("this processor lacks the vector instructions asked for");
  std::vector<kernel::Kernel> kernels;
  const auto add = [&](Instructions offered, kernel::Kernel (*make)()) {
    if (instructions == offered || (instructions == Instructions::automatic && cpu_has(offered)))
      kernels.push_back(make());
  };
#ifdef WHEELTAP_X86_KERNELS
  add(Instructions::avx2, kernel::avx2_kernel);
  add(Instructions::avx512, kernel::avx512_kernel);
#endif
  if (kernels.empty()) add(Instructions::baseline, kernel::baseline_kernel);
  return kernels;
}

void require_finite(const std::vector<double>& samples, const std::string& name) {
  const auto bad =
      std::find_if_not(samples.begin(), samples.end(), [](double x) { return std::isfinite(x); });
  if (bad != samples.end())
    fail(name + ", sample " + std::to_string(bad - samples.begin()) + " is not finite");
}

/// 64-byte aligned memory that grows and is kept by its thread.
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

/// What a group of parameter vectors must have in common.
struct Key {
  int substeps = 0, halvings = 0, degree = 0;
  auto operator<=>(const Key&) const = default;
};

constexpr Key kInfeasible{-1, -1, -1};

/// What one thread needs to evaluate a batch.
struct ThreadMemory {
  Scratch coefficients, exact, trajectory;
  std::vector<double> values;  ///< [set][slot]
  std::vector<std::pair<Key, int>> order;
};

ThreadMemory& thread_memory() {
  thread_local ThreadMemory memory;
  return memory;
}

int count_thresholds(const Chain& chain) {
  int count = 0;
  for (const Link& link : chain.links)
    for (const Law& law : link.laws)
      LawList::visit(law.kind, [&](auto l) { count += kPiecewiseLinear<decltype(l)> ? 1 : 0; });
  return count;
}

/// Whether kernel::piecewise can integrate the chain.
bool is_piecewise_linear(const Chain& chain) {
  int laws = 0;
  for (const Link& link : chain.links) laws += static_cast<int>(link.laws.size());
  return laws > 0 && laws <= kernel::kMaxThresholds && laws == count_thresholds(chain);
}

/// The longest piece of a series [1/ω], at a step limit of 0.2 or more.
constexpr double kLongestPiece = 0.7;

/// Of a series whose piece is x/ω long, so that of a velocity at most xᴰ/D! = 3e-10 is lost in a
/// piece; a cubic spring alone has its nearest pole at 3.2/ω, which costs about (x/3.2)ᴰ⁺¹.
int degree_of_series(double x) {
  return x <= 0.15 ? 7 : x <= 0.35 ? 9 : kernel::kMaxDegree;
}

/// The next of 1, 2, 3, 4, 6, 8, 12, …: few different counts, so that parameter vectors share
/// lanes.
int ladder(double steps) {
  for (int power = 1; power <= kMaxSubsteps; power *= 2) {
    if (steps <= power) return power;
    if (power > 1 && steps <= power + power / 2) return power + power / 2;
  }
  return -1;
}

/// `frequency` and `damping` in a sample.
Key with_halvings(Key key, double frequency, double damping) {
  const double norm = std::max(1.0, frequency * frequency + damping);
  key.halvings = 1 + static_cast<int>(std::ceil(std::log2(norm)));
  return key.halvings <= 60 ? key : kInfeasible;
}

}  // namespace

struct Simulator::Impl {
  Chain chain;
  Excitation excitation;
  std::vector<Sensor> sensors;
  InitialState initial;
  SimulatorOptions options;

  std::vector<double> base_velocity;
  std::vector<Coefficient> slots;
  std::vector<kernel::LinkTerm> links;
  std::vector<kernel::LawTerm> laws;
  std::vector<kernel::DriveTerm> drives;
  std::vector<kernel::SensorTerm> terms;
  kernel::Task task;
  std::vector<kernel::Kernel> kernels;
  Integrator integrator = Integrator::runge_kutta;
  int samples = 0;  ///< of the excitation
  int parameters = 0;
  int no_offset = 0;  ///< slots (1, 0)

  int add(std::initializer_list<Coefficient> coefficients) {
    const int first = static_cast<int>(slots.size());
    slots.insert(slots.end(), coefficients);
    return first;
  }
  int add(const Signal& signal) { return add({signal.scale, signal.offset}); }

  void check();
  void compile();
  [[nodiscard]] Key key(std::span<const double> theta) const;
  [[nodiscard]] int response_samples() const { return (samples - 1) / options.stride + 1; }

  /// Runs the sets in groups of equal key; receive(set, lane, lanes, failed) after each group. With
  /// `sums` false the trajectory is left in memory.trajectory.
  template <class Receive>
  void run(std::span<const double> thetas, int sets,
           const std::vector<kernel::SensorTerm>& sensor_terms,
           std::span<const Coefficient> all_slots, int lead_in, bool sums, Receive receive,
           std::span<const double> weights = {}, double limit = 0.0) const;
};

bool has_series(const Chain& chain) {
  int polynomials = 0;
  bool all = true;
  for (const Link& link : chain.links) {
    bool polynomial = false;
    for (const Law& law : link.laws)
      LawList::visit(law.kind, [&](auto l) {
        all = all && (kPiecewiseLinear<decltype(l)> || kPolynomial<decltype(l)>);
        polynomial = polynomial || kPolynomial<decltype(l)>;
      });
    polynomials += polynomial ? 1 : 0;
  }
  return all && count_thresholds(chain) <= kernel::kMaxThresholds &&
         polynomials <= kernel::kMaxPolynomials;
}

void Simulator::Impl::check() {
  validate(chain);
  const int n = chain.size();
  if (n > kernel::kMaxMasses)
    fail(std::to_string(n) + " masses, must be at most " + std::to_string(kernel::kMaxMasses));
  if (!(excitation.sample_rate_hz > 0.0) || !std::isfinite(excitation.sample_rate_hz))
    fail("sample rate = " + std::to_string(excitation.sample_rate_hz) + " Hz, must be > 0");
  if (options.stride < 1) fail("stride = " + std::to_string(options.stride) + ", must be >= 1");
  if (options.substeps < 0 || options.substeps > kMaxSubsteps)
    fail("substeps = " + std::to_string(options.substeps) + ", must be in [0, " +
         std::to_string(kMaxSubsteps) + "]");
  if (!(options.step_limit > 0.0))
    fail("step limit = " + std::to_string(options.step_limit) + ", must be > 0");
  if (!(options.displacement_bound > 0.0))
    fail("displacement bound = " + std::to_string(options.displacement_bound) + ", must be > 0");
  if (!options.extension.empty() && options.extension.size() != chain.links.size())
    fail(std::to_string(options.extension.size()) + " extensions, must be one a link (" +
         std::to_string(chain.links.size()) + ")");
  if (options.integrator == Integrator::exact && !chain.is_linear())
    fail("the exact solution is for chains without nonlinear laws");
  if (options.integrator == Integrator::series && !has_series(chain))
    fail("series are for chains whose laws are powers of the extension (on at most " +
         std::to_string(kernel::kMaxPolynomials) + " links), bilinear or contact (at most " +
         std::to_string(kernel::kMaxThresholds) + ")");
  if (options.integrator == Integrator::piecewise && !is_piecewise_linear(chain))
    fail("the piecewise exact solution is for chains with 1 to " +
         std::to_string(kernel::kMaxThresholds) + " laws, all bilinear or contact");

  std::size_t length = 0;
  const auto same_length = [&](const Signal& signal, const std::string& name) {
    if (signal.samples.empty()) fail(name + " has no samples");
    if (length != 0 && signal.samples.size() != length)
      fail(name + " has " + std::to_string(signal.samples.size()) + " samples, must be " +
           std::to_string(length) + " as the others");
    length = signal.samples.size();
    require_finite(signal.samples, name);
  };
  for (const Force& force : excitation.forces) {
    if (force.mass < 1 || force.mass > n)
      fail("force on mass " + std::to_string(force.mass) + ", must be in [1, " + std::to_string(n) +
           "]");
    same_length(force.signal, "the force on mass " + std::to_string(force.mass));
  }
  if (excitation.base) {
    const BaseMotion& base = *excitation.base;
    if (base.acceleration.samples.empty() && base.displacement.samples.empty())
      fail("base motion without acceleration or displacement");
    if (!base.acceleration.samples.empty()) same_length(base.acceleration, "the base acceleration");
    if (!base.displacement.samples.empty()) same_length(base.displacement, "the base displacement");
  }
  if (length == 0) fail("no excitation: give a force (of zeros for free vibration) or base motion");
  samples = static_cast<int>(length);

  if (sensors.empty()) fail("no sensors, must be at least 1");
  for (const Sensor& sensor : sensors) {
    if (sensor.mass < 1 || sensor.mass > n)
      fail("sensor on mass " + std::to_string(sensor.mass) + ", must be in [1, " +
           std::to_string(n) + "]");
    if (excitation.base && excitation.base->displacement.samples.empty() &&
        sensor.frame == Frame::absolute && sensor.quantity != Quantity::acceleration)
      fail("an absolute displacement or velocity of mass " + std::to_string(sensor.mass) +
           " needs the base displacement");
  }
  for (const auto* state : {&initial.displacement, &initial.velocity})
    if (!state->empty() && static_cast<int>(state->size()) != n)
      fail(std::to_string(state->size()) + " initial values, must be one a mass (" +
           std::to_string(n) + ")");
}

void Simulator::Impl::compile() {
  const int n = chain.size();
  for (const Coefficient& mass : chain.masses) add({mass});
  int memories = 0;
  for (const Link& link : chain.links) {
    kernel::LinkTerm term{.a = link.a, .b = link.b, .slot = add({link.stiffness, link.damping})};
    term.law_begin = static_cast<int>(laws.size());
    for (const Law& law : link.laws) {
      const LawInfo& info = law_infos()[static_cast<std::size_t>(law.kind)];
      kernel::LawTerm law_term{.kind = law.kind, .slot = static_cast<int>(slots.size())};
      slots.insert(slots.end(), law.coefficients.begin(), law.coefficients.begin() + info.size());
      add({law.side == Side::opening ? 1.0 : -1.0});
      if (info.memory) law_term.memory = memories++;
      laws.push_back(law_term);
    }
    term.law_end = static_cast<int>(laws.size());
    links.push_back(term);
  }
  if (memories > kernel::kMaxMemories)
    fail(std::to_string(memories) + " laws with memory, must be at most " +
         std::to_string(kernel::kMaxMemories));

  for (const Force& force : excitation.forces)
    drives.push_back(
        {.mass = force.mass, .samples = force.signal.samples.data(), .slot = add(force.signal)});
  no_offset = add({1.0, 0.0});
  const double dt = 1.0 / excitation.sample_rate_hz;
  if (excitation.base) {
    BaseMotion& base = *excitation.base;
    if (!base.displacement.samples.empty()) {
      const signals::Spline spline = signals::natural_spline(base.displacement.samples, dt);
      base_velocity = spline.first_derivative;
      if (base.acceleration.samples.empty())
        base.acceleration = {spline.second_derivative, base.displacement.scale, 0.0};
    }
    drives.push_back(
        {.mass = 0, .samples = base.acceleration.samples.data(), .slot = add(base.acceleration)});
  }
  for (const Sensor& sensor : sensors) {
    kernel::SensorTerm term{
        .mass = sensor.mass, .quantity = static_cast<int>(sensor.quantity), .slot = no_offset};
    if (excitation.base && sensor.frame == Frame::absolute) {
      const BaseMotion& base = *excitation.base;
      switch (sensor.quantity) {
        case Quantity::displacement:
          term.base = base.displacement.samples.data();
          term.base_slot = add(base.displacement);
          break;
        case Quantity::velocity:
          term.base = base_velocity.data();
          term.base_slot = add({base.displacement.scale, 0.0});
          break;
        case Quantity::acceleration:
          term.base = base.acceleration.samples.data();
          term.base_slot = add(base.acceleration);
          break;
      }
    }
    terms.push_back(term);
  }
  task.initial_slot = static_cast<int>(slots.size());
  for (const auto* state : {&initial.displacement, &initial.velocity}) {
    if (state->empty())
      slots.insert(slots.end(), static_cast<std::size_t>(n), 0.0);
    else
      slots.insert(slots.end(), state->begin(), state->end());
  }
  for (const Coefficient& c : slots) parameters = std::max(parameters, c.parameter + 1);

  integrator = options.integrator;
  if (integrator == Integrator::automatic)
    integrator = options.substeps > 0         ? Integrator::runge_kutta
                 : chain.is_linear()          ? Integrator::exact
                 : is_piecewise_linear(chain) ? Integrator::piecewise
                 : has_series(chain) && (options.prefer_series || count_thresholds(chain) > 0)
                     ? Integrator::series
                     : Integrator::runge_kutta;
  kernels = make_kernels(options.instructions);
  task.masses = n;
  task.links = static_cast<int>(links.size());
  task.laws = static_cast<int>(laws.size());
  task.link = links.data();
  task.law = laws.data();
  task.drives = static_cast<int>(drives.size());
  task.drive = drives.data();
  task.memories = memories;
  task.serial = task.links == n;
  for (int l = 0; l < task.links; ++l) {
    const auto& link = links[static_cast<std::size_t>(l)];
    task.serial = task.serial && link.a == l && link.b == l + 1;
  }
  const auto same_kind = [&](const kernel::LawTerm& law) { return law.kind == laws.front().kind; };
  if (!laws.empty() && std::all_of(laws.begin(), laws.end(), same_kind))
    task.only_law = laws.front().kind;
  task.step = dt;
  task.samples = samples;
  task.stride = options.stride;
  task.bound = options.displacement_bound;
}

Key Simulator::Impl::key(std::span<const double> theta) const {
  for (const Coefficient& mass : chain.masses)
    if (!(mass.at(theta) > 0.0)) return kInfeasible;
  for (const Link& link : chain.links)
    for (const Law& law : link.laws) {
      std::array<double, kMaxLawCoefficients> c;
      for (std::size_t i = 0; i < c.size(); ++i) c[i] = law.coefficients[i].at(theta);
      bool feasible = false;
      LawList::visit(law.kind, [&](auto l) { feasible = decltype(l)::feasible(c.data()); });
      if (!feasible) return kInfeasible;
    }
  const bool exact = integrator == Integrator::exact;
  if (integrator == Integrator::runge_kutta && options.substeps > 0)
    return {.substeps = options.substeps};
  const Rates rates = stiffest_rates(chain, theta, options.extension);
  const double h = task.step, frequency = rates.frequency * h, damping = rates.damping * h;
  if (!std::isfinite(frequency) || !std::isfinite(damping)) return kInfeasible;
  if (exact) return with_halvings({}, frequency, damping);
  const double fastest = std::max(frequency, damping);
  if (integrator == Integrator::runge_kutta) {
    const int substeps = ladder(std::max(frequency / options.step_limit, damping));
    return substeps > 0 ? Key{.substeps = substeps} : kInfeasible;
  }
  const double longest = kLongestPiece * std::min(1.0, options.step_limit / 0.2);
  const int pieces = options.substeps > 0 ? options.substeps : ladder(fastest / longest);
  if (pieces < 0) return kInfeasible;
  const Key key{.substeps = pieces, .degree = degree_of_series(fastest / pieces)};
  return integrator == Integrator::series ? key : with_halvings(key, frequency, damping);
}

template <class Receive>
void Simulator::Impl::run(std::span<const double> thetas, int sets,
                          const std::vector<kernel::SensorTerm>& sensor_terms,
                          std::span<const Coefficient> all_slots, int lead_in, bool sums,
                          Receive receive, std::span<const double> weights, double limit) const {
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
    memory.order.emplace_back(key(theta), static_cast<int>(set));
  }
  std::sort(memory.order.begin(), memory.order.end());

  const auto most = static_cast<std::size_t>(kernels.back().lanes);
  alignas(64) std::array<double, 8> failed;
  kernel::Task work = task;
  work.sensor = sensor_terms.data();
  work.sensors = static_cast<int>(sensor_terms.size());
  work.lead_in = lead_in;
  work.failed = failed.data();
  if (!weights.empty()) {
    work.weights = weights.data();
    work.limit = limit;
  }
  const std::size_t channels = sensor_terms.size();
  double* table = memory.coefficients.take((width + channels) * most);
  double* totals = table + width * most;
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
    // The narrowest kernel that holds the group: a wide vector costs more than a narrow one.
    const kernel::Kernel& kernel = *std::find_if(
        kernels.begin(), kernels.end() - 1,
        [&](const kernel::Kernel& k) { return static_cast<std::size_t>(k.lanes) >= end - begin; });
    const auto lanes = static_cast<std::size_t>(kernel.lanes);
    if (group != kInfeasible) {
      for (std::size_t lane = 0; lane < lanes; ++lane) {  // idle lanes repeat the last set
        const auto set =
            static_cast<std::size_t>(memory.order[std::min(begin + lane, end - 1)].second);
        for (std::size_t slot = 0; slot < width; ++slot)
          table[slot * lanes + lane] = memory.values[set * width + slot];
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
      receive(static_cast<std::size_t>(memory.order[i].second), group, i - begin, lanes,
              group == kInfeasible || failed[i - begin] != 0.0, work);
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
  options.substeps *= factor;
  return {impl_->chain, impl_->excitation, impl_->sensors, impl_->initial, options};
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

namespace {

void require_parameters(std::span<const double> thetas, int sets, int parameters) {
  if (sets < 0) fail("sets = " + std::to_string(sets) + ", must be >= 0");
  const auto count = static_cast<std::size_t>(sets);
  if (count > 0 &&
      (thetas.size() % count != 0 || thetas.size() / count < static_cast<std::size_t>(parameters)))
    fail(std::to_string(thetas.size()) + " numbers for " + std::to_string(sets) +
         " parameter vectors, must be at least " + std::to_string(parameters) + " each");
}

}  // namespace

int Simulator::substeps(std::span<const double> theta) const {
  require_parameters(theta, 1, impl_->parameters);
  return impl_->key(theta).substeps;
}

Response Simulator::simulate(std::span<const double> theta) const {
  return std::move(simulate_batch(theta, 1).front());
}

std::vector<Response> Simulator::simulate_batch(std::span<const double> thetas, int sets) const {
  require_parameters(thetas, sets, impl_->parameters);
  std::vector<Response> responses(static_cast<std::size_t>(sets));
  const auto samples = static_cast<Eigen::Index>(this->samples());
  const auto channels = static_cast<Eigen::Index>(impl_->sensors.size());
  impl_->run(thetas, sets, impl_->terms, impl_->slots, 0, false,
             [&](std::size_t set, Key key, std::size_t lane, std::size_t lanes, bool failed,
                 const kernel::Task& task) {
               Response& response = responses[set];
               response.failed = failed;
               response.substeps = std::max(0, key.substeps);
               if (failed) return;
               response.values.resize(samples, channels);
               const double* value = task.trajectory + lane;
               for (Eigen::Index n = 0; n < samples; ++n)
                 for (Eigen::Index c = 0; c < channels; ++c, value += lanes)
                   response.values(n, c) = *value;
             });
  return responses;
}

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
    fail(std::to_string(impl->observed.size()) + " observed signals, must be one a sensor (" +
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
  require_parameters(thetas, sets, impl_->parameters);
  const std::size_t channels = impl_->observed.size();
  if (out.size() != static_cast<std::size_t>(sets) * channels)
    fail("room for " + std::to_string(out.size()) + " sums, must be " +
         std::to_string(static_cast<std::size_t>(sets) * channels));
  impl_->simulator.impl_->run(
      thetas, sets, impl_->terms, impl_->slots, impl_->lead_in, true,
      [&](std::size_t set, Key /*key*/, std::size_t lane, std::size_t lanes, bool failed,
          const kernel::Task& task) {
        for (std::size_t c = 0; c < channels; ++c) {
          const double sum = failed ? 0.0 : task.sums[c * lanes + lane];
          out[set * channels + c] =
              failed || !std::isfinite(sum) ? std::numeric_limits<double>::infinity() : sum;
        }
      });
}

bool Misfit::sums_of_squares_within(std::span<const double> theta, std::span<const double> weights,
                                    double limit, std::span<double> out) const {
  require_parameters(theta, 1, impl_->parameters);
  const std::size_t channels = impl_->observed.size();
  if (out.size() != channels || weights.size() != channels)
    fail("room for " + std::to_string(out.size()) + " sums and " + std::to_string(weights.size()) +
         " weights, must be " + std::to_string(channels));
  bool within = false;
  impl_->simulator.impl_->run(
      theta, 1, impl_->terms, impl_->slots, impl_->lead_in, true,
      [&](std::size_t, Key, std::size_t lane, std::size_t lanes, bool failed,
          const kernel::Task& task) {
        if (failed) return;
        double total = 0.0;
        for (std::size_t c = 0; c < channels; ++c) {
          out[c] = task.sums[c * lanes + lane];
          total += weights[c] * out[c];
        }
        within = total <= limit;
      },
      weights, limit);
  return within;
}

bool Misfit::residuals(std::span<const double> theta, std::span<double> out) const {
  require_parameters(theta, 1, impl_->parameters);
  const auto samples = static_cast<std::size_t>(this->samples());
  const std::size_t channels = impl_->observed.size();
  if (out.size() != samples * channels)
    fail("room for " + std::to_string(out.size()) + " residuals, must be " +
         std::to_string(samples * channels));
  bool done = false;
  impl_->simulator.impl_->run(
      theta, 1, impl_->terms, impl_->slots, 0, false,
      [&](std::size_t, Key, std::size_t lane, std::size_t lanes, bool failed,
          const kernel::Task& task) {
        if (failed) return;
        const auto lead_in = static_cast<std::size_t>(impl_->lead_in);
        for (std::size_t c = 0; c < channels; ++c) {
          const Signal& signal = impl_->observed[c];
          const double scale = signal.scale.at(theta), offset = signal.offset.at(theta);
          for (std::size_t n = 0; n < samples; ++n)
            out[c * samples + n] = scale * signal.samples[n + lead_in] + offset -
                                   task.trajectory[((n + lead_in) * channels + c) * lanes + lane];
        }
        done = true;
      });
  return done;
}

}  // namespace wheeltap::dynamics
