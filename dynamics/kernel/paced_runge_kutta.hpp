// The classical Runge-Kutta scheme in steps that follow the motion. Part of kernel_impl.hpp, which
// says what it is compiled for.
#pragma once

#include "dynamics/kernel/equation_of_motion.hpp"

namespace wheeltap::dynamics::kernel::WHEELTAP_KERNEL {

/// The scheme of RungeKutta for chains with laws whose rate grows with the speed of their link
/// (LawInfo::paced): no step chosen beforehand suits both the rest and the stroke. With s the sum
/// over the links of (rate a unit of speed) · |ė|, and s' that of (rate a unit of speed) · (|ë| and
/// by how much the drive may change it within a step), a step τ is at most that of task.substeps
/// and keeps
///
///   s τ + s' τ² / 2 <= task.pace        by       τ = pace / (s + √(pace s')).
///
/// Every lane goes its own way through a sample, by its own state alone.
///
///   0   |
///   1/2 | 1/2
///   1/2 | 0   1/2
///   1   | 0   0   1
///   ----+------------------
///       | 1/6 1/3 1/3 1/6
template <int N>
class PacedRungeKutta {
 public:
  explicit PacedRungeKutta(const Task& task)
      : task_(task), c_(vectors(task.coefficients)), motion_(task) {}

  void run() {
    const int n = motion_.masses();
    State x;
    V drive_now[M], drive_next[M];
    x.y[0] = x.v[0] = V{};
    WHEELTAP_UNROLL
    for (int i = 1; i <= n; ++i) {
      x.y[i] = c_[task_.initial_slot + i - 1];
      x.v[i] = c_[task_.initial_slot + n + i - 1];
    }
    for (int m = 0; m < task_.memories; ++m) x.q[m] = V{};
    Output output(task_);
    Watch watch(task_);
    motion_.excite(0, drive_now);
    for (std::int64_t sample = 0;; ++sample) {
      if (output.due(sample)) {
        Rates k;
        rates(x, drive_now, k);
        motion_.emit(output, sample, x.y, x.v, k.v);
      }
      if (sample + 1 == task_.samples) break;
      motion_.excite(sample + 1, drive_next);
      advance(x, drive_now, drive_next, watch);
      WHEELTAP_UNROLL
      for (int i = 1; i <= n; ++i) {
        drive_now[i] = drive_next[i];
        watch.saw(x.y[i]);
      }
      if (watch.over(sample, output)) break;
    }
    WHEELTAP_UNROLL
    for (int i = 1; i <= n; ++i) {
      watch.saw_last(x.y[i]);
      watch.saw_last(x.v[i]);
    }
    for (int m = 0; m < task_.memories; ++m) watch.saw_last(x.q[m]);
    watch.finish();
  }

 private:
  using Motion = EquationOfMotion<N, false, AnyLaw>;
  static constexpr int M = Motion::M;
  /// Beyond this product of rate and step the scheme itself is unstable: 2.79 on the real axis.
  static constexpr double kUnstable = 2.5;

  struct State {
    V y[M], v[M], q[kMaxMemories];
  };
  /// The rates of v and q; that of y is v.
  struct Rates {
    V v[M], q[kMaxMemories];
  };

  WHEELTAP_INLINE void rates(const State& x, const V* drive, Rates& k) const {
    const int n = motion_.masses();
    V pull[M];
    motion_.forces(x.y, x.v, x.q, pull, k.q);
    k.v[0] = V{};
    WHEELTAP_UNROLL
    for (int i = 1; i <= n; ++i) k.v[i] = drive[i] + motion_.inverse_mass(i) * pull[i];
  }

  /// `to` = x + τ (speed, k).
  WHEELTAP_INLINE void go(const State& x, V tau, const V* speed, const Rates& k, State& to) const {
    const int n = motion_.masses();
    to.y[0] = to.v[0] = V{};
    WHEELTAP_UNROLL
    for (int i = 1; i <= n; ++i) {
      to.y[i] = x.y[i] + tau * speed[i];
      to.v[i] = x.v[i] + tau * k.v[i];
    }
    for (int m = 0; m < task_.memories; ++m) to.q[m] = x.q[m] + tau * k.q[m];
  }

  /// From one sample to the next, with drives linear between.
  [[gnu::noinline]] void advance(State& x, const V* now, const V* next, Watch& watch) const {
    const int n = motion_.masses();
    const V longest = V{} + 1.0 / task_.substeps;
    V left = watch.failed() > 0.0 ? V{} : V{} + 1.0;  // of the sample
    for (int steps = 0; any(left); ++steps) {
      if (steps == task_.most_steps) {
        V fast{};  // beyond the bound within a sample: no steps would help
        WHEELTAP_UNROLL
        for (int i = 1; i <= n; ++i)
          fast = lanes::max(fast, outside(x.v[i] * task_.step, task_.bound));
        const V stop = left > 0.0 ? V{} + 1.0 : V{};
        watch.out_of_steps(stop, fast);
        return;
      }
      State stage;
      Rates k1, k2, k3, k4;
      V drive[M];
      const auto at = [&](V time) __attribute__((always_inline)) {
        WHEELTAP_UNROLL
        for (int i = 1; i <= n; ++i) drive[i] = now[i] + time * (next[i] - now[i]);
      };
      // k1, at the beginning
      at(1.0 - left);
      rates(x, drive, k1);
      const V length = pace(x, k1, now, next, left < longest ? left : longest, watch);
      const V part = left > 2.0 * length ? length : left > 1.000001 * length ? 0.5 * left : left;
      const V h = part * task_.step, half = 0.5 * h, begin = 1.0 - left;

      // k2, in the middle after half a step of k1
      go(x, half, x.v, k1, stage);
      at(begin + 0.5 * part);
      rates(stage, drive, k2);
      V speed2[M], speed3[M], speed4[M];
      WHEELTAP_UNROLL
      for (int i = 1; i <= n; ++i) speed2[i] = stage.v[i];

      // k3, in the middle after half a step of k2
      go(x, half, speed2, k2, stage);
      rates(stage, drive, k3);
      WHEELTAP_UNROLL
      for (int i = 1; i <= n; ++i) speed3[i] = stage.v[i];

      // k4, at the end after a step of k3
      go(x, h, speed3, k3, stage);
      at(begin + part);
      rates(stage, drive, k4);
      WHEELTAP_UNROLL
      for (int i = 1; i <= n; ++i) speed4[i] = stage.v[i];

      // 1/6 k1 + 1/3 k2 + 1/3 k3 + 1/6 k4, in the lanes that move
      const V sixth = left > 0.0 ? h / 6.0 : V{};
      WHEELTAP_UNROLL
      for (int i = 1; i <= n; ++i) {
        x.y[i] += sixth * (x.v[i] + speed4[i] + 2.0 * (speed2[i] + speed3[i]));
        x.v[i] += sixth * (k1.v[i] + k4.v[i] + 2.0 * (k2.v[i] + k3.v[i]));
      }
      for (int m = 0; m < task_.memories; ++m)
        x.q[m] += sixth * (k1.q[m] + k4.q[m] + 2.0 * (k2.q[m] + k3.q[m]));
      left = left > 0.0 ? left - part : left;
    }
  }

  /// The length of the next step, in samples.
  WHEELTAP_INLINE V pace(const State& x, const Rates& k, const V* now, const V* next, V longest,
                         Watch& watch) const {
    // Where a law holds its link against the drive, ė and ë say nothing: what is to come does.
    const auto coming = [&](int mass) __attribute__((always_inline)) {
      return mass == 0 ? V{} : next[mass] - now[mass];
    };
    V rate{}, growth{};
    for (int l = 0; l < task_.links; ++l) {
      const LinkTerm& link = task_.link[l];
      const V quickness = c_[link.pace_slot];
      rate += quickness * lanes::abs(x.v[link.b] - x.v[link.a]);
      growth += quickness * (lanes::abs(k.v[link.b] - k.v[link.a]) +
                             longest * lanes::abs(coming(link.b) - coming(link.a)));
    }
    V root = task_.pace * growth;
    for (int lane = 0; lane < WHEELTAP_LANES; ++lane) root[lane] = __builtin_sqrt(root[lane]);
    const V length = task_.pace / ((rate + root) * task_.step);
    const V chosen = length < longest ? length : longest;  // NaN, and 0/0: the longest
    watch.mark_long_steps(rate * chosen * task_.step > kUnstable ? V{} + 1.0 : V{});
    return chosen;
  }

  const Task& task_;
  const V* c_;
  Motion motion_;
};

}  // namespace wheeltap::dynamics::kernel::WHEELTAP_KERNEL
