// Classical Runge-Kutta scheme with adaptive time steps. Part of kernel_impl.hpp, which describes
// the compilation.
#pragma once

#include "dynamics/kernel/equation_of_motion.hpp"
#include "dynamics/kernel/friction.hpp"

namespace wheeltap::dynamics::kernel::WHEELTAP_KERNEL {

/// The scheme of RungeKutta for chains with force laws whose rate grows with |ė| (LawInfo::paced).
/// For these chains, no constant time step is suitable both near rest and at high velocities. Let r
/// be the rate per unit velocity of a link. The sum of r |ė| over the links is s, and the sum of r
/// (|ë| + largest change of the drive within a step) is s'. A time step τ is at most
/// 1/task.substeps of the sample interval, and at most
///
///   pace / (s + √(pace s')),   so that   s τ + s' τ² / 2 <= pace = task.pace.
///
/// The time steps of a SIMD lane depend only on the state of this lane. If a link with exact
/// friction comes to rest or breaks away within a step, the step ends at this time.
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
      : task_(task), c_(vectors(task.coefficients)), motion_(task), friction_(task, 1.0) {}

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
    if (friction_.size() > 0) {
      V free[M];
      accelerate(x, drive_now, free);
      friction_.start(x.v, free);
    }
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
        watch.check(x.y[i]);
      }
      if (watch.over(sample, output, kPacedSamplesBetweenChecks)) break;
    }
    WHEELTAP_UNROLL
    for (int i = 1; i <= n; ++i) {
      watch.check_last(x.y[i]);
      watch.check_last(x.v[i]);
    }
    for (int m = 0; m < task_.memories; ++m) watch.check_last(x.q[m]);
    watch.finish();
  }

 private:
  using Motion = EquationOfMotion<N, false, AnyLaw>;
  static constexpr int M = Motion::M;
  /// Limit of rate times time step above which the scheme counts as unstable (exact limit on the
  /// negative real axis: 2.79).
  static constexpr double kUnstable = 2.5;
  /// Largest number of friction events in a sample interval. After this number of events, links
  /// keep slipping or sticking until the end of the interval.
  static constexpr int kMostEvents = 64;
  static constexpr int kMostTrials = 80;
  static constexpr double kTimeCloseness = 1e-12;
  static constexpr double kAtTurn = 1e-3;  // least distance of a reversal from step ends [steps]

  struct State {
    V y[M], v[M], q[kMaxMemories];
  };
  /// Time derivatives of v and q; the time derivative of y is v.
  struct Rates {
    V v[M], q[kMaxMemories];
  };

  WHEELTAP_INLINE void rates(const State& x, const V* drive, Rates& k) const {
    V tension[kMaxFrictions];
    rates(x, drive, k, tension);
  }

  /// Computes the rates, including the effect of friction tensions.
  WHEELTAP_INLINE void rates(const State& x, const V* drive, Rates& k, V* tension) const {
    const int n = motion_.masses();
    V pull[M];
    motion_.forces(x.y, x.v, x.q, pull, k.q);
    k.v[0] = V{};
    WHEELTAP_UNROLL
    for (int i = 1; i <= n; ++i) k.v[i] = drive[i] + motion_.inverse_mass(i) * pull[i];
    if (friction_.size() > 0) friction_.pull(true, k.v, tension);
  }

  /// Computes the accelerations z̈ without friction.
  [[gnu::noinline]] void accelerate(const State& x, const V* drive, V* acceleration) const {
    const int n = motion_.masses();
    V pull[M], q_rate[kMaxMemories];
    motion_.forces(x.y, x.v, x.q, pull, q_rate);
    acceleration[0] = V{};
    for (int i = 1; i <= n; ++i) acceleration[i] = drive[i] + motion_.inverse_mass(i) * pull[i];
  }

  /// Computes `to` = x + τ (speed, k).
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

  /// Advances from one sample to the next; the excitation is linear between the samples.
  [[gnu::noinline]] void advance(State& x, const V* now, const V* next, Watch& watch) {
    const int n = motion_.masses();
    const V longest = V{} + 1.0 / task_.substeps;
    V left = watch.failed() > 0.0 ? V{} : V{} + 1.0;  // remaining fraction of the sample interval
    V events_left = V{} + static_cast<double>(kMostEvents);
    for (int steps = 0; any(left); ++steps) {
      if (steps == task_.most_steps) {
        V fast{};  // 1 if a displacement exceeds the bound: shorter steps would not help
        WHEELTAP_UNROLL
        for (int i = 1; i <= n; ++i)
          fast = lanes::max(fast, outside(x.v[i] * task_.step, task_.bound));
        const V stop = left > 0.0 ? V{} + 1.0 : V{};
        watch.out_of_steps(stop, fast);
        return;
      }
      // k1, at the beginning of the step
      V drive[M];
      Rates k1;
      drive_at(1.0 - left, now, next, drive);
      rates(x, drive, k1);
      const V length = pace(x, k1, now, next, left < longest ? left : longest, watch);
      V part = left > 2.0 * length ? length : left > 1.000001 * length ? 0.5 * left : left;
      State end;
      step(x, k1, now, next, left, part, end);
      if (task_.turning && stop_at_turn(x, k1, left, part, end))
        step(x, k1, now, next, left, part, end);
      V changes[kMaxFrictions];
      const bool events = friction_.size() > 0 &&
                          stop_at_event(x, k1, now, next, left, part, end, changes, events_left);
      WHEELTAP_UNROLL
      for (int i = 1; i <= n; ++i) {
        x.y[i] = end.y[i];
        x.v[i] = end.v[i];
      }
      for (int m = 0; m < task_.memories; ++m) x.q[m] = end.q[m];
      left = left > 0.0 ? left - part : left;
      if (events) stick_or_slip(x, changes, left, now, next);
    }
  }

  WHEELTAP_INLINE void drive_at(V time, const V* now, const V* next, V* drive) const {
    const int n = motion_.masses();
    WHEELTAP_UNROLL
    for (int i = 1; i <= n; ++i) drive[i] = now[i] + time * (next[i] - now[i]);
  }

  /// Makes one step of the length `part` (in sample intervals), in the lanes that have not reached
  /// the end of the sample interval.
  WHEELTAP_INLINE void step(const State& x, const Rates& k1, const V* now, const V* next, V left,
                            V part, State& end) const {
    const int n = motion_.masses();
    const V h = part * task_.step, half = 0.5 * h, begin = 1.0 - left;
    State stage;
    Rates k2, k3, k4;
    V drive[M];

    // k2, at the middle of the step: half a step with the rates k1
    go(x, half, x.v, k1, stage);
    drive_at(begin + 0.5 * part, now, next, drive);
    rates(stage, drive, k2);
    V speed2[M], speed3[M], speed4[M];
    WHEELTAP_UNROLL
    for (int i = 1; i <= n; ++i) speed2[i] = stage.v[i];

    // k3, at the middle of the step: half a step with the rates k2
    go(x, half, speed2, k2, stage);
    rates(stage, drive, k3);
    WHEELTAP_UNROLL
    for (int i = 1; i <= n; ++i) speed3[i] = stage.v[i];

    // k4, at the end of the step: a full step with the rates k3
    go(x, h, speed3, k3, stage);
    drive_at(begin + part, now, next, drive);
    rates(stage, drive, k4);
    WHEELTAP_UNROLL
    for (int i = 1; i <= n; ++i) speed4[i] = stage.v[i];

    // Step with 1/6 k1 + 1/3 k2 + 1/3 k3 + 1/6 k4, in the lanes that advance
    const V sixth = left > 0.0 ? h / 6.0 : V{};
    end.y[0] = end.v[0] = V{};
    WHEELTAP_UNROLL
    for (int i = 1; i <= n; ++i) {
      end.y[i] = x.y[i] + sixth * (x.v[i] + speed4[i] + 2.0 * (speed2[i] + speed3[i]));
      end.v[i] = x.v[i] + sixth * (k1.v[i] + k4.v[i] + 2.0 * (k2.v[i] + k3.v[i]));
    }
    for (int m = 0; m < task_.memories; ++m)
      end.q[m] = x.q[m] + sixth * (k1.q[m] + k4.q[m] + 2.0 * (k2.q[m] + k3.q[m]));
  }

  /// Shortens the time step so that it ends when the rate of extension of a link with hysteresis,
  /// or the internal state of a force law, changes sign. At this zero, the rate of the internal
  /// state is not smooth. Returns true if the step of any lane was shortened.
  [[gnu::noinline]] bool stop_at_turn(const State& x, const Rates& k1, V left, V& part,
                                      const State& end) const {
    const V h = part * task_.step;
    V share = V{} + 1.0;
    for (int l = 0; l < task_.links; ++l) {
      const LinkTerm& link = task_.link[l];
      if (link.turning)
        first_zero(x.v[link.b] - x.v[link.a], h * (k1.v[link.b] - k1.v[link.a]),
                   end.v[link.b] - end.v[link.a], share);
    }
    for (int m = 0; m < task_.memories; ++m) first_zero(x.q[m], h * k1.q[m], end.q[m], share);
    const V shorter = left > 0.0 ? (share < 1.0 - kAtTurn ? V{} + 1.0 : V{}) : V{};
    if (!any(shorter)) return false;
    part = shorter > 0.0 ? part * share : part;
    return true;
  }

  /// Reduces `share`, a fraction of the step, to the zero of a parabola. The parabola has the value
  /// `from` and the slope `slope` at the start of the step, and the value `to` at its end. A zero
  /// within the fraction kAtTurn of the start of the step is ignored, so that the step keeps a
  /// positive length.
  WHEELTAP_INLINE static void first_zero(V from, V slope, V to, V& share) {
    V root = slope * slope - 4.0 * (to - from - slope) * from;
    for (int lane = 0; lane < WHEELTAP_LANES; ++lane)
      root[lane] = __builtin_sqrt(root[lane] > 0.0 ? root[lane] : 0.0);
    const V at = 2.0 * lanes::abs(from) / (root - (from > 0.0 ? slope : -slope));
    share = from * to < 0.0 && at < share && at > kAtTurn ? at : share;
  }

  /// Computes for each link with friction the distance [m/s] to its next stick-slip event. This
  /// margin is negative after the event. Returns the smallest margin.
  [[gnu::noinline]] V margins(const State& x, V time, const V* now, const V* next,
                              V* margin) const {
    V tension[kMaxFrictions], drive[M], least = V{} + 1e300;
    if (friction_.sticking()) {
      Rates k;
      drive_at(time, now, next, drive);
      rates(x, drive, k, tension);
    }
    for (int f = 0; f < friction_.size(); ++f) {
      const V state = friction_.state(f);
      margin[f] = state * friction_.across(f, x.v);
      if (friction_.sticking()) {
        const V spare = friction_.force(f) - lanes::abs(tension[f]);
        margin[f] = state == 0.0 ? task_.step * friction_.compliance(f) * spare : margin[f];
      }
      least = margin[f] < least ? margin[f] : least;
    }
    return least;
  }

  /// Shortens the step so that it ends at its first friction event. Bisection and false position
  /// (Illinois rule) locate the event to 1e-12 of a sample interval. Returns true if any lane has
  /// an event. Writes to changes[link] the direction (±1) in which the link breaks away, 2 if the
  /// link comes to rest, or 0.
  [[gnu::noinline]] bool stop_at_event(const State& x, const Rates& k1, const V* now, const V* next,
                                       V left, V& part, State& end, V* changes,
                                       V& events_left) const {
    const V begin = 1.0 - left;
    V margin[kMaxFrictions], at_high = margins(end, begin + part, now, next, margin);
    const V crossed = left > 0.0 ? (at_high < 0.0 ? V{} + 1.0 : V{}) : V{};
    const V found = events_left > 0.0 ? crossed : V{};
    if (!any(found)) return false;
    events_left -= found;
    V at_low = margins(x, begin, now, next, margin);
    V low{}, high = part, open = found, last{};
    for (int i = 0; i < kMostTrials && any(open); ++i) {
      // If the event is at the start of the step, only bisection reduces the interval.
      const V chord = low + (high - low) * (at_low / (at_low - at_high)),
              middle = 0.5 * (low + high);
      const V inside = at_low > 0.0 ? (i % 3 == 2 ? middle : chord) : middle;
      const V trial = open > 0.0 ? inside : high;
      step(x, k1, now, next, left, found > 0.0 ? trial : part, end);
      const V value = margins(end, begin + trial, now, next, margin);
      const V beyond = value < 0.0 ? open : V{}, before = value < 0.0 ? V{} : open;
      at_low = beyond * last > 0.0 ? 0.5 * at_low : before > 0.0 ? value : at_low;
      at_high = before * last < 0.0 ? 0.5 * at_high : beyond > 0.0 ? value : at_high;
      low = before > 0.0 ? trial : low;
      high = beyond > 0.0 ? trial : high;
      last = beyond > 0.0 ? V{} + 1.0 : before > 0.0 ? V{} - 1.0 : last;
      open = high - low > kTimeCloseness ? open : V{};
    }
    part = found > 0.0 ? high : part;
    step(x, k1, now, next, left, part, end);
    margins(end, begin + part, now, next, margin);
    V tension[kMaxFrictions], drive[M];
    Rates k;
    drive_at(begin + part, now, next, drive);
    rates(end, drive, k, tension);
    for (int f = 0; f < friction_.size(); ++f) {
      const V side = tension[f] > 0.0 ? V{} + 1.0 : V{} - 1.0;
      const V change = friction_.state(f) == 0.0 ? side : V{} + 2.0;
      changes[f] = margin[f] < 0.0 ? (found > 0.0 ? change : V{}) : V{};
    }
    return true;
  }

  /// Changes the stick-slip states of links at a friction event.
  [[gnu::noinline]] void stick_or_slip(State& x, const V* changes, V left, const V* now,
                                       const V* next) {
    V stopping{}, at_rest[kMaxFrictions] = {};
    for (int f = 0; f < friction_.size(); ++f) stopping = lanes::max(stopping, changes[f] - 1.0);
    for (int f = 0; f < friction_.size(); ++f) {
      const V stops = changes[f] > 1.5 ? V{} + 1.0 : V{};
      const V rests = friction_.state(f) == 0.0 ? V{} + 1.0 : stops;
      at_rest[f] = stopping > 0.0 ? rests : V{};
      friction_.break_away(f, stops > 0.0 ? V{} : changes[f]);
      friction_.stop(f, stops);
    }
    V drive[M], free[M];
    drive_at(1.0 - left, now, next, drive);
    accelerate(x, drive, free);
    friction_.settle(at_rest, x.v, free);
  }

  /// Returns the length of the next step, in sample intervals.
  WHEELTAP_INLINE V pace(const State& x, const Rates& k, const V* now, const V* next, V longest,
                         Watch& watch) const {
    // If a force law keeps the link at rest despite the excitation, ė and ë do not limit the time
    // step. The change of the excitation limits the time step instead.
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
    const V chosen = length < longest ? length : longest;  // `longest` if `length` is NaN (0/0)
    watch.mark_long_steps(rate * chosen * task_.step > kUnstable ? V{} + 1.0 : V{});
    return chosen;
  }

  const Task& task_;
  const V* c_;
  Motion motion_;
  Friction<N> friction_;
};

}  // namespace wheeltap::dynamics::kernel::WHEELTAP_KERNEL
