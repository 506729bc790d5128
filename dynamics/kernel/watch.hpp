// What every integrator does with a sample, and how it sees that a trajectory failed. Part of
// kernel_impl.hpp, which says what it is compiled for.
#pragma once

#include <limits>

#include "dynamics/kernel/vectors.hpp"

namespace wheeltap::dynamics::kernel::WHEELTAP_KERNEL {

constexpr std::int64_t kSamplesBetweenChecks = 64;
/// Of trajectories that take many steps a sample, each lane as many as it needs.
constexpr std::int64_t kPacedSamplesBetweenChecks = 4;

/// What the integrators do with a sample: score it or store it.
class Output {
 public:
  explicit Output(const Task& task) : task_(task), c_(vectors(task.coefficients)) {
    if (task.sums != nullptr)
      for (int i = 0; i < task.sensors; ++i) vectors(task.sums)[i] = V{};
  }

  /// True if sample n of the excitation is wanted.
  WHEELTAP_INLINE bool due(std::int64_t n) {
    if (n != next_) return false;
    next_ += task_.stride;
    ++sample_;
    return task_.sums == nullptr || sample_ >= task_.lead_in;
  }

  /// `motion` is the sensor's relative motion.
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
  /// 1 where there is no use in going on: sums of squares only grow.
  WHEELTAP_INLINE V hopeless() const {
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

/// Whether trajectories go on, and which of them failed. All by comparisons that a NaN does not
/// pass: arithmetic that a NaN should survive, such as 0 · x, is for the compiler to fold.
class Watch {
 public:
  explicit Watch(const Task& task) : task_(task), bound_(task.bound) {}

  /// For every mass at every sample. A lane once outside stays so.
  WHEELTAP_INLINE void saw(V displacement) {
    outside_ = lanes::abs(displacement) <= bound_ ? outside_ : V{} + 1.0;
  }

  /// For the whole state at the last sample, the laws' own included.
  WHEELTAP_INLINE void saw_last(V x) {
    outside_ = lanes::max(outside_, outside(x, std::numeric_limits<double>::max()));
  }

  /// Lanes in which a step was so long that the scheme was unstable: where they fail, it is this.
  WHEELTAP_INLINE void mark_long_steps(V too_long) {
    long_steps_ = lanes::max(long_steps_, too_long);
  }
  /// Lanes that stop because they would need more steps than there may be; in those that are `fast`
  /// none would be short enough.
  WHEELTAP_INLINE void out_of_steps(V stopped, V fast) {
    mark_long_steps(fast > 0.0 ? V{} : stopped);
    outside_ = lanes::max(outside_, stopped);
  }
  /// 1 where a trajectory has failed.
  [[nodiscard]] WHEELTAP_INLINE V failed() const { return outside_; }

  /// Now and then: whether every lane has failed, or is not worth going on with.
  WHEELTAP_INLINE bool over(std::int64_t sample, const Output& output,
                            std::int64_t between = kSamplesBetweenChecks) {
    if (sample % between != 0) return false;
    if (output.limited()) outside_ = lanes::max(outside_, output.hopeless());
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
