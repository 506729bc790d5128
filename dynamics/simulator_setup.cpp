// Validation of a simulator's input, and its conversion to the flat tables that the kernels read.
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "base/simd.hpp"
#include "dynamics/simulator_impl.hpp"
#include "signals/spline.hpp"

namespace wheeltap::dynamics {

namespace detail {

void fail(const std::string& what) {
  throw std::invalid_argument("simulator: " + what);
}

void require_parameters(std::span<const double> thetas, int sets, int parameters) {
  if (sets < 0) fail("sets = " + std::to_string(sets) + ", must be >= 0");
  const auto count = static_cast<std::size_t>(sets);
  if (count > 0 &&
      (thetas.size() % count != 0 || thetas.size() / count < static_cast<std::size_t>(parameters)))
    fail(std::to_string(thetas.size()) + " numbers for " + std::to_string(sets) +
         " parameter vectors, must be at least " + std::to_string(parameters) + " each");
}

int count_thresholds(const Chain& chain) {
  int count = 0;
  for (const Link& link : chain.links)
    for (const Law& law : link.laws)
      LawList::visit(law.kind, [&](auto l) { count += kPiecewiseLinear<decltype(l)> ? 1 : 0; });
  return count;
}

std::vector<std::pair<int, int>> frictions(const Chain& chain) {
  std::vector<std::pair<int, int>> pairs;
  for (const Link& link : chain.links) {
    const std::pair<int, int> pair = std::minmax(link.a, link.b);
    if (std::any_of(link.laws.begin(), link.laws.end(), is_dry) &&
        std::find(pairs.begin(), pairs.end(), pair) == pairs.end())
      pairs.push_back(pair);
  }
  return pairs;
}

std::vector<const kernel::Kernel*> make_kernels(Instructions instructions) {
  base::Compiled<kernel::Kernel> compiled{.baseline = &kernel::kBaselineKernel};
#ifdef WHEELTAP_X86_KERNELS
  compiled.avx2 = &kernel::kAvx2Kernel;
  compiled.avx512 = &kernel::kAvx512Kernel;
#endif
  auto kernels = base::runnable(compiled, instructions);
  if (kernels.empty()) fail("this processor lacks the requested vector instructions");
  // If four lanes are available, the kernel with two lanes takes as long as that with four.
  if (kernels.size() > 1) kernels.erase(kernels.begin());
  return kernels;
}

}  // namespace detail

namespace {

using detail::count_thresholds, detail::fail, detail::make_kernels;

void require_finite(const std::vector<double>& samples, const std::string& name) {
  const auto bad =
      std::find_if_not(samples.begin(), samples.end(), [](double x) { return std::isfinite(x); });
  if (bad != samples.end())
    fail(name + ", sample " + std::to_string(bad - samples.begin()) + " is not finite");
}

/// True if kernel::piecewise can integrate the chain.
bool is_piecewise_linear(const Chain& chain) {
  int laws = 0;
  for (const Link& link : chain.links) laws += static_cast<int>(link.laws.size());
  return laws > 0 && laws <= kernel::kMaxThresholds && laws == count_thresholds(chain);
}

}  // namespace

bool has_series(const Chain& chain) {
  int polynomials = 0;
  bool all = true;
  for (const Link& link : chain.links) {
    bool polynomial = false;
    for (const Law& law : link.laws)
      LawList::visit(law.kind, [&](auto l) {
        all = all && (kPiecewiseLinear<decltype(l)> || kPolynomial<decltype(l)> || is_dry(law));
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
    fail(std::to_string(options.extension.size()) + " extensions, must be one per link (" +
         std::to_string(chain.links.size()) + ")");
  if (options.integrator == Integrator::exact && !chain.is_linear())
    fail("the exact solution needs a chain without nonlinear force laws");
  if (options.integrator == Integrator::series && !has_series(chain))
    fail("Taylor series need a chain whose force laws are powers of the extension (at most " +
         std::to_string(kernel::kMaxPolynomials) + " links), bilinear or contact (at most " +
         std::to_string(kernel::kMaxThresholds) + "), or exact friction");
  if (detail::frictions(chain).size() > kernel::kMaxFrictions)
    fail("exact friction between " + std::to_string(detail::frictions(chain).size()) +
         " pairs of masses, must be at most " + std::to_string(kernel::kMaxFrictions) +
         ": give the coulomb laws of other pairs a velocity > 0");
  if (options.integrator == Integrator::piecewise && !is_piecewise_linear(chain))
    fail("the piecewise exact solution needs a chain with 1 to " +
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
      fail("base motion needs an acceleration or a displacement");
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
      fail(std::to_string(state->size()) + " initial values, must be one per mass (" +
           std::to_string(n) + ")");
}

void Simulator::Impl::compile() {
  const int n = chain.size();
  for (const Coefficient& mass : chain.masses) add({mass});
  int memories = 0;
  const auto dry = detail::frictions(chain);
  task.frictions = static_cast<int>(dry.size());
  task.paced = is_paced(chain);
  const bool fixed = options.substeps > 0;
  task.pace = fixed ? std::numeric_limits<double>::infinity()
                    : std::min(1.0, options.step_limit / detail::kUsualStepLimit);
  task.most_steps = kMaxPacedSubsteps;
  for (const Link& link : chain.links) {
    kernel::LinkTerm term{.a = link.a, .b = link.b, .slot = add({link.stiffness, link.damping})};
    if (task.paced || !dry.empty()) term.pace_slot = add({0.0});
    term.law_begin = static_cast<int>(laws.size());
    for (const Law& law : link.laws) {
      const LawInfo& info = law_infos()[static_cast<std::size_t>(law.kind)];
      kernel::LawTerm law_term{.kind = law.kind, .slot = static_cast<int>(slots.size())};
      slots.insert(slots.end(), law.coefficients.begin(), law.coefficients.begin() + info.size());
      add({law.side == Side::opening ? 1.0 : -1.0});
      if (info.memory) {
        law_term.memory = memories++;
        term.turning = task.turning = true;
      }
      if (is_dry(law)) {
        const std::pair<int, int> pair = std::minmax(link.a, link.b);
        law_term.dry = static_cast<int>(std::find(dry.begin(), dry.end(), pair) - dry.begin());
      }
      laws.push_back(law_term);
    }
    term.law_end = static_cast<int>(laws.size());
    links.push_back(term);
  }
  if (memories > kernel::kMaxMemories)
    fail(std::to_string(memories) + " force laws with memory, must be at most " +
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
                 : has_series(chain) &&
                         (options.prefer_series || count_thresholds(chain) > 0 || !dry.empty())
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

}  // namespace wheeltap::dynamics
