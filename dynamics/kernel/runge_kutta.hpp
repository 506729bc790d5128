// Classical Runge-Kutta scheme. Part of kernel_impl.hpp, which describes the compilation.
#pragma once

#include "dynamics/kernel/equation_of_motion.hpp"

namespace wheeltap::dynamics::kernel::WHEELTAP_KERNEL {

/// The classical fourth-order scheme with task.substeps equal time steps per sample, for force laws
/// without memory. Its Butcher tableau:
///
///   0   |
///   1/2 | 1/2
///   1/2 | 0   1/2
///   1   | 0   0   1
///   ----+------------------
///       | 1/6 1/3 1/3 1/6
template <int N, bool kSerial, class OnlyLaw>
class RungeKutta {
 public:
  explicit RungeKutta(const Task& task)
      : task_(task), c_(vectors(task.coefficients)), motion_(task) {
    const int n = motion_.masses();
    const double h = task_.step / task_.substeps;
    WHEELTAP_UNROLL
    for (int i = 1; i <= n; ++i) {
      const V inverse = motion_.inverse_mass(i);
      half_inverse_[i] = 0.5 * h * inverse;
      full_inverse_[i] = h * inverse;
      sixth_inverse_[i] = h / 6.0 * inverse;
    }
  }

  void run() {
    const int n = motion_.masses();
    V y[M], v[M], drive_now[M], drive_next[M];
    y[0] = v[0] = V{};
    WHEELTAP_UNROLL
    for (int i = 1; i <= n; ++i) {
      y[i] = c_[task_.initial_slot + i - 1];
      v[i] = c_[task_.initial_slot + n + i - 1];
    }
    Output output(task_);
    Watch watch(task_);
    motion_.excite(0, drive_now);

    for (std::int64_t sample = 0;; ++sample) {
      const bool last = sample + 1 == task_.samples;
      motion_.excite(last ? sample : sample + 1, drive_next);
      advance(
          y, v, drive_now, drive_next, [&](const V* a) __attribute__((always_inline)) {
            if (output.due(sample)) motion_.emit(output, sample, y, v, a);
            return last;
          });
      if (last) break;
      WHEELTAP_UNROLL
      for (int i = 1; i <= n; ++i) {
        drive_now[i] = drive_next[i];
        watch.check(y[i]);
      }
      if (watch.over(sample, output)) break;
    }
    WHEELTAP_UNROLL
    for (int i = 1; i <= n; ++i) {
      watch.check_last(y[i]);
      watch.check_last(v[i]);
    }
    watch.finish();
  }

 private:
  using Motion = EquationOfMotion<N, kSerial, OnlyLaw>;
  static constexpr int M = Motion::M;

  /// Advances the state from one sample to the next, with drives that are linear between the
  /// samples. Passes the accelerations at the first sample to `seen`, and stops if `seen` returns
  /// true.
  template <class Seen>
  WHEELTAP_INLINE void advance(V* y, V* v, const V* drive_now, const V* drive_next,
                               Seen seen) const {
    const int n = motion_.masses(), steps = task_.substeps;
    const double h = task_.step / steps, half = 0.5 * h, sixth = h / 6.0, area = h * h / 6.0;
    const double fraction = 0.5 / steps;
    V slope[M];
    WHEELTAP_UNROLL
    for (int i = 1; i <= n; ++i) slope[i] = (drive_next[i] - drive_now[i]) * fraction;
    for (int s = 0; s < steps; ++s) {
      // k_j = (velocity, acceleration a_j) at stage j. The velocities of the stages are v, v + h/2
      // a1, v + h/2 a2, v + h a3, so y increases by h v + h²/6 (a1 + a2 + a3). The operations of a
      // stage depend on each other. The partial sum v + h drive / 2 does not depend on the forces
      // of the stage, and is therefore computed first.
      V a1[M], a2[M], a3[M], known[M], yi[M], vi[M], vn[M], drive[M], pull[M];
      yi[0] = vi[0] = vn[0] = V{};

      // k1, at the beginning of the step
      WHEELTAP_UNROLL
      for (int i = 1; i <= n; ++i) {
        drive[i] = drive_now[i] + (2.0 * s) * slope[i];
        known[i] = v[i] + half * drive[i];
        yi[i] = y[i] + half * v[i];
      }
      motion_.forces(y, v, nullptr, pull, nullptr);
      WHEELTAP_UNROLL
      for (int i = 1; i <= n; ++i) {
        vi[i] = known[i] + half_inverse_[i] * pull[i];
        a1[i] = drive[i] + motion_.inverse_mass(i) * pull[i];
      }
      if (s == 0 && seen(a1)) return;

      // k2, at the middle of the step: half a step with the rates k1
      WHEELTAP_UNROLL
      for (int i = 1; i <= n; ++i) {
        drive[i] += slope[i];
        known[i] = v[i] + half * drive[i];
      }
      motion_.forces(yi, vi, nullptr, pull, nullptr);
      WHEELTAP_UNROLL
      for (int i = 1; i <= n; ++i) {
        yi[i] = y[i] + half * vi[i];
        vn[i] = known[i] + half_inverse_[i] * pull[i];
        a2[i] = drive[i] + motion_.inverse_mass(i) * pull[i];
      }

      // k3, at the middle of the step: half a step with the rates k2
      WHEELTAP_UNROLL
      for (int i = 1; i <= n; ++i) known[i] = v[i] + h * drive[i];
      motion_.forces(yi, vn, nullptr, pull, nullptr);
      WHEELTAP_UNROLL
      for (int i = 1; i <= n; ++i) {
        yi[i] = y[i] + h * vn[i];
        vi[i] = known[i] + full_inverse_[i] * pull[i];
        a3[i] = drive[i] + motion_.inverse_mass(i) * pull[i];
      }

      // k4, at the end: a full step with the rates k3; then 1/6 k1 + 1/3 k2 + 1/3 k3 + 1/6 k4
      WHEELTAP_UNROLL
      for (int i = 1; i <= n; ++i) {
        drive[i] += slope[i];
        const V middle = a2[i] + a3[i];
        known[i] = v[i] + sixth * (a1[i] + drive[i] + 2.0 * middle);
        y[i] += h * v[i] + area * (a1[i] + middle);
      }
      motion_.forces(yi, vi, nullptr, pull, nullptr);
      WHEELTAP_UNROLL
      for (int i = 1; i <= n; ++i) v[i] = known[i] + sixth_inverse_[i] * pull[i];
    }
  }

  const Task& task_;
  const V* c_;
  Motion motion_;
  V half_inverse_[M], full_inverse_[M], sixth_inverse_[M];
};

}  // namespace wheeltap::dynamics::kernel::WHEELTAP_KERNEL
