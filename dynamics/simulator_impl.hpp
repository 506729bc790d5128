// Declarations shared by simulate.cpp, simulator_setup.cpp and misfit.cpp. Internal.
#pragma once

#include <compare>
#include <initializer_list>
#include <string>
#include <utility>

#include "dynamics/kernel.hpp"
#include "dynamics/simulate.hpp"

namespace wheeltap::dynamics {

namespace detail {

/// Throws std::invalid_argument with the message `what`.
[[noreturn]] void fail(const std::string& what);

/// Throws std::invalid_argument if `thetas` does not hold `sets` vectors of at least `parameters`
/// numbers each.
void require_parameters(std::span<const double> thetas, int sets, int parameters);

/// Returns the available kernels, sorted by ascending SIMD width: the kernel of the requested
/// instructions, or all kernels that this processor can run.
[[nodiscard]] std::vector<const kernel::Kernel*> make_kernels(Instructions instructions);

[[nodiscard]] int count_thresholds(const Chain& chain);

/// Returns the pairs of masses with exact friction between them, in the order of the links. In each
/// pair, the smaller index is first.
[[nodiscard]] std::vector<std::pair<int, int>> frictions(const Chain& chain);

/// Step limit (of ω h) for which the limit of γ h is 1, where γ is a damping rate. Below this step
/// limit, the limit of γ h is proportional to the step limit.
inline constexpr double kUsualStepLimit = 0.2;

/// Time-step parameters, which are equal for all parameter vectors of a group.
struct Key {
  int substeps = 0, halvings = 0, degree = 0;
  auto operator<=>(const Key&) const = default;
};

inline constexpr Key kInfeasible{-1, -1, -1};
/// Marks a parameter vector that would need more than kMaxSubsteps steps per sample.
inline constexpr Key kTooManySteps{-2, -1, -1};

/// Outcome for one parameter vector, and the lane of this vector in the memory of `task`.
struct Lane {
  std::size_t set = 0;
  Key key;
  Outcome outcome = Outcome::complete;
  std::size_t lane = 0, lanes = 1;
};

/// A reference to a function that is called for every parameter vector.
class Receiver {
 public:
  template <class F>
  Receiver(const F& f)  // NOLINT: implicit, like the function
      : object_(&f), call_([](const void* object, const Lane& lane, const kernel::Task& task) {
          (*static_cast<const F*>(object))(lane, task);
        }) {}
  void operator()(const Lane& lane, const kernel::Task& task) const { call_(object_, lane, task); }

 private:
  const void* object_;
  void (*call_)(const void*, const Lane&, const kernel::Task&);
};

}  // namespace detail

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
  std::vector<const kernel::Kernel*> kernels;
  Integrator integrator = Integrator::runge_kutta;
  int samples = 0;  ///< number of samples of the excitation
  int parameters = 0;
  int no_offset = 0;  ///< slot of the scale 1 and the offset 0

  int add(std::initializer_list<Coefficient> coefficients) {
    const int first = static_cast<int>(slots.size());
    slots.insert(slots.end(), coefficients);
    return first;
  }
  int add(const Signal& signal) { return add({signal.scale, signal.offset}); }

  void check();
  void compile();
  [[nodiscard]] detail::Key key(std::span<const double> theta) const;
  [[nodiscard]] int response_samples() const { return (samples - 1) / options.stride + 1; }

  /// Integrates the parameter vectors in groups with equal time-step parameters (Key). Calls
  /// receive(lane, task) for each parameter vector after the integration of its group. If `sums` is
  /// false, task.trajectory holds the trajectory. `weights` (per vector and sensor) and `limits`
  /// (per vector) are as in kernel::Task, or empty.
  void run(std::span<const double> thetas, int sets,
           const std::vector<kernel::SensorTerm>& sensor_terms,
           std::span<const Coefficient> all_slots, int lead_in, bool sums, detail::Receiver receive,
           std::span<const double> weights = {}, std::span<const double> limits = {}) const;
};

}  // namespace wheeltap::dynamics
