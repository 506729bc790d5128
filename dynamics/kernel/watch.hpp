// Output of samples and detection of failed trajectories, for all integrators. Part of
// kernel_impl.hpp, which describes the compilation.
#pragma once

#include <limits>

#include "dynamics/kernel/vectors.hpp"

namespace wheeltap::dynamics::kernel::WHEELTAP_KERNEL {

constexpr std::int64_t kSamplesBetweenChecks = 64;
/// Interval between two checks [samples] for integration with adaptive time steps. Adaptive
/// integration needs many steps per sample, and the number of steps differs between lanes.
constexpr std::int64_t kPacedSamplesBetweenChecks = 4;

/// Adds a sample to the sums of squares, or stores the sample.
class Output {
 public:
  explicit Output(const Task& task) : task_(task), c_(vectors(task.coefficients)) {
    if (task.sums != nullptr)
      for (int i = 0; i < task.sensors; ++i) vectors(task.sums)[i] = V{};
  }

  /// True if sample n of the excitation is a sample of the response.
  WHEELTAP_INLINE bool due(std::int64_t n) {
    if (n != next_) return false;
    next_ += task_.stride;
    ++sample_;
    return task_.sums == nullptr || sample_ >= task_.lead_in;
  }

  /// Processes sample n of sensor i; `motion` is the relative motion of the sensor.
  WHEELTAP_INLINE void take(std::int64_t n, int i, V motion) {
    const SensorTerm& s = task_.sensor[i];
    if (s.base != nullptr) motion += c_[s.base_slot] * s.base[n] + c_[s.base_slot + 1];
    if (task_.sums != nullptr) {
      const V residual = c_[s.slot] * s.observed[sample_] + c_[s.slot + 1] - motion;
      vectors(task_.sums)[i] += residual * residual;
    } else {
      vectors(task_.trajectory)[sample_ * task_.sensors + i] = motion;
    }
  }

  [[nodiscard]] WHEELTAP_INLINE bool limited() const { return task_.weights != nullptr; }
  /// Returns 1 in lanes whose sums of squares exceed the limit. The integration of such a lane can
  /// stop, because sums of squares can only increase.
  WHEELTAP_INLINE V over_limit() const {
    V total{};
    for (int i = 0; i < task_.sensors; ++i)
      total += vectors(task_.weights)[i] * vectors(task_.sums)[i];
    return lanes::abs(total) <= vectors(task_.limit)[0] ? V{} : V{} + 1.0;
  }

 private:
  const Task& task_;
  const V* c_;
  std::int64_t next_ = 0;
  std::int64_t sample_ = -1;
};

/// Records which trajectories have failed. The class detects NaN by comparisons, which are false
/// for NaN. Products such as 0 · x are not used, because the compiler may simplify them.
class Watch {
 public:
  explicit Watch(const Task& task) : task_(task), bound_(task.bound) {}

  /// Checks a displacement; the caller must call this function for every mass at every sample.
  /// After a displacement has exceeded the bound, the lane remains marked as failed.
  WHEELTAP_INLINE void check(V displacement) {
    outside_ = lanes::abs(displacement) <= bound_ ? outside_ : V{} + 1.0;
  }

  /// Checks a component of the state; the caller must call this function for the whole state at the
  /// last sample, including the internal states of force laws.
  WHEELTAP_INLINE void check_last(V x) {
    outside_ = lanes::max(outside_, outside(x, std::numeric_limits<double>::max()));
  }

  /// Marks lanes with a time step for which the scheme is unstable. If a marked lane fails, the
  /// reported reason is kStepsTooLong.
  WHEELTAP_INLINE void mark_long_steps(V too_long) {
    long_steps_ = lanes::max(long_steps_, too_long);
  }
  /// Marks the lanes of `stopped`, which need more time steps than allowed, as failed. In the lanes
  /// of `fast`, the motion is so fast that shorter time steps would not help.
  WHEELTAP_INLINE void out_of_steps(V stopped, V fast) {
    mark_long_steps(fast > 0.0 ? V{} : stopped);
    outside_ = lanes::max(outside_, stopped);
  }
  /// Returns 1 in the lanes whose trajectory has failed, else 0.
  [[nodiscard]] WHEELTAP_INLINE V failed() const { return outside_; }

  /// Returns true if all lanes have failed or exceeded their limits. The check is made only at
  /// intervals of several samples.
  WHEELTAP_INLINE bool over(std::int64_t sample, const Output& output,
                            std::int64_t between = kSamplesBetweenChecks) {
    if (sample % between != 0) return false;
    if (output.limited()) outside_ = lanes::max(outside_, output.over_limit());
    return all(outside_);
  }

  WHEELTAP_INLINE void finish() const {
    vectors(task_.failed)[0] =
        outside_ > 0.0 ? (long_steps_ > 0.0 ? V{} + kStepsTooLong : V{} + kDiverged) : V{};
  }

 private:
  const Task& task_;
  double bound_;
  V outside_{}, long_steps_{};
};

}  // namespace wheeltap::dynamics::kernel::WHEELTAP_KERNEL
