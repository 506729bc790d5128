// Taylor series between the switching times of force laws. Part of kernel_impl.hpp, which describes
// the compilation.
#pragma once

#include "dynamics/kernel/equation_of_motion.hpp"
#include "dynamics/kernel/friction.hpp"

namespace wheeltap::dynamics::kernel::WHEELTAP_KERNEL {

/// Integrates chains by Taylor series in time, for springs whose tension is a polynomial or is
/// linear beyond a threshold. The solution between two samples is analytic except where a force law
/// switches. Each sample interval is divided into segments, with one series for each segment. A
/// segment ends after its full length, or earlier when the first force law reaches its threshold. A
/// time step across a switch would have an error proportional to its squared length. This error
/// would depend on the position of the switch and make the likelihood discontinuous. Exact friction
/// adds events: a slipping link comes to rest, or the tension of a sticking link exceeds the slip
/// force.
template <int N, bool kSerial>
class Series {
 public:
  using Motion = EquationOfMotion<N, kSerial, AnyLaw>;
  static constexpr int M = Motion::M;

  explicit Series(const Task& task)
      : task_(task),
        c_(vectors(task.coefficients)),
        motion_(task),
        friction_(task, task.step * task.step),
        masses_(N > 0 ? N : task.masses) {
    for_each_threshold(task, [&](int i, const LinkTerm& link, V stiffness, V threshold, V side) {
      thresholds_[i] = {link.a, link.b, side, threshold, stiffness};
      switches_ = i + 1;
    });
    for (int l = 0; l < task.links; ++l) {
      const LinkTerm& link = task.link[l];
      V powers[kMaxPower + 1] = {};
      bool any_power = false;
      for (int j = link.law_begin; j < link.law_end; ++j) {
        LawList::visit(task.law[j].kind, [&](auto law) {
          using Law = decltype(law);
          if constexpr (kPolynomial<Law>) {
            static_assert(2 <= Law::kPower && Law::kPower <= kMaxPower,
                          "series expand squares and cubes of the extension; a higher power needs "
                          "its Cauchy product in expand()");
            static_assert(!Law::kInfo.one_sided && !Law::kInfo.memory && Law::kInfo.size() == 1,
                          "a power of the extension is T = c[0] e^power on both sides");
            powers[Law::kPower] += c_[task.law[j].slot];
            any_power = true;
            cubes_ |= Law::kPower == 3;
          }
        });
      }
      if (any_power) polynomials_[polynomial_count_++] = {link.a, link.b, powers[2], powers[3]};
    }
    for (int i = 1; i <= masses(); ++i) scaled_inverse_[i] = task.step * task.step / c_[i - 1];
    for (int i = 0; i < task.sensors; ++i) accelerometers_ |= task.sensor[i].quantity == 2;
  }

  void run() {
    const int m = masses();
    V y[M], v[M], now[M], then[M];
    y[0] = v[0] = now[0] = then[0] = V{};
    WHEELTAP_UNROLL
    for (int i = 1; i <= m; ++i) {
      y[i] = c_[task_.initial_slot + i - 1];
      v[i] = task_.step * c_[task_.initial_slot + m + i - 1];
    }
    start(y);
    Output output(task_);
    Watch watch(task_);
    motion_.excite(0, now);
    if (friction_.size() > 0) {
      V free[M];
      accelerate(y, v, now, free);
      friction_.start(v, free);
      for (int f = 0; f < friction_.size(); ++f) {
        const V begins = friction_.state(f) == 0.0 ? V{} : V{} + 1.0;
        fresh_slip_[f] = friction_.across(f, v) == 0.0 ? begins : V{};
      }
    }
    for (std::int64_t sample = 0;; ++sample) {
      if (output.due(sample)) show(output, sample, y, v);
      if (sample + 1 == task_.samples) break;
      motion_.excite(sample + 1, then);
      advance(y, v, now, then, V{} + 1.0);
      WHEELTAP_UNROLL
      for (int i = 1; i <= m; ++i) {
        now[i] = then[i];
        watch.check(y[i]);
      }
      if (watch.over(sample, output)) break;
    }
    WHEELTAP_UNROLL
    for (int i = 1; i <= m; ++i) {
      watch.check_last(y[i]);
      watch.check_last(v[i]);
    }
    watch.finish();
  }

  struct Threshold {
    int a, b;
    V side, threshold, stiffness;
  };
  [[nodiscard]] WHEELTAP_INLINE int switches() const { return switches_; }
  [[nodiscard]] WHEELTAP_INLINE const Threshold& threshold(int i) const { return thresholds_[i]; }
  /// Returns 1 in the lanes in which force law i is active, else -1.
  [[nodiscard]] WHEELTAP_INLINE V sign(int i) const { return sign_[i]; }

  /// Sets sign(i) of every force law i for the displacements y.
  WHEELTAP_INLINE void start(const V* y) {
    for (int i = 0; i < switches_; ++i)
      sign_[i] = reach(thresholds_[i], y) > 0.0 ? V{} + 1.0 : V{} - 1.0;
  }

  /// Advances y and v (in units of the sample interval) by one sample, in the lanes of `moving`.
  /// `now` and `then` are the drives at the ends of the sample interval.
  WHEELTAP_INLINE void advance(V* y, V* v, const V* now, const V* then, V moving) {
    const int m = masses(), degree = task_.degree;
    const V piece = V{} + 1.0 / task_.substeps;
    V terms[kMaxDegree + 1][M], fresh[kMaxThresholds], root[kMaxThresholds];
    for (int i = 0; i < switches_; ++i) fresh[i] = V{};
    V left = moving;  // remaining fraction of the sample interval
    for (int pieces = 0; any(left); ++pieces) {
      const bool watching = pieces < task_.substeps + kMostSwitches;
      const V length = left > 1.000001 * piece ? piece : left;
      expand(y, v, now, then, left, terms);
      V until = length;
      for (int i = 0; i < switches_; ++i) {
        root[i] = watching ? first_root(i, fresh[i], terms, length) : V{} + 2.0;
        until = root[i] < until ? root[i] : until;
      }
      V change[kMaxFrictions], side[kMaxFrictions];
      for (int f = 0; f < friction_.size(); ++f) {
        side[f] = V{};
        change[f] = watching ? first_change(f, terms, length, side[f]) : V{} + 2.0;
        until = change[f] < until ? change[f] : until;
      }
      WHEELTAP_UNROLL
      for (int i = 1; i <= m; ++i) {
        V position = terms[degree][i], growth = degree * terms[degree][i];
        for (int k = degree - 1; k > 0; --k) {
          position = terms[k][i] + until * position;
          growth = k * terms[k][i] + until * growth;
        }
        position = terms[0][i] + until * position;
        y[i] = left > 0.0 ? position : y[i];
        v[i] = left > 0.0 ? growth : v[i];
      }
      for (int i = 0; i < switches_; ++i) {
        const V crossed = left > 0.0 ? (root[i] <= until ? V{} + 1.0 : V{}) : V{};
        sign_[i] = crossed > 0.0 ? -sign_[i] : sign_[i];
        fresh[i] = crossed > 0.0 ? V{} + 1.0 : until > 0.0 ? V{} : fresh[i];
      }
      const V moved = left > 0.0 ? V{} + 1.0 : V{};
      left = left > 0.0 ? left - until : left;
      for (int i = 0; i < switches_ && !watching; ++i) {
        const V now_acts = reach(thresholds_[i], y) > 0.0 ? V{} + 1.0 : V{} - 1.0;
        sign_[i] = moved > 0.0 ? now_acts : sign_[i];  // unchanged in lanes that waited for other
                                                       // lanes
      }
      if (friction_.size() > 0) {
        for (int f = 0; f < friction_.size(); ++f)
          change[f] = moved > 0.0 ? (change[f] <= until ? V{} + 1.0 : V{}) : V{};
        stick_or_slip(change, side, until, y, v, now, then, left, watching ? V{} : moved);
      }
    }
  }

  /// Writes the sensor signals at a sample to `output`; the unit of time of `v` is the sample
  /// interval.
  WHEELTAP_INLINE void show(Output& output, std::int64_t sample, const V* y, const V* v) const {
    const double rate = 1.0 / task_.step;
    V speed[M], a[M];
    const int m = masses();
    speed[0] = V{};
    WHEELTAP_UNROLL
    for (int i = 1; i <= m; ++i) speed[i] = rate * v[i];
    if (accelerometers_) {
      motion_.accelerations(sample, y, speed, a);
      if (friction_.size() > 0) {
        const double unit = task_.step * task_.step;
        V tension[kMaxFrictions];
        for (int i = 0; i <= m; ++i) a[i] *= unit;
        friction_.pull(true, a, tension);
        for (int i = 0; i <= m; ++i) a[i] /= unit;
      }
    } else {
      for (int i = 0; i <= m; ++i) a[i] = V{};
    }
    motion_.emit(output, sample, y, speed, a);
  }

  WHEELTAP_INLINE void excite(std::int64_t sample, V* drive) const {
    motion_.excite(sample, drive);
  }

 private:
  /// Largest number of switches per sample interval. After this number of switches, the force laws
  /// keep their state (active or inactive) until the end of the interval.
  static constexpr int kMostSwitches = 32;
  static constexpr int kMaxPower = 3;
  /// Tolerances of switching times [sample intervals], for springs and for friction. The tension of
  /// a spring is continuous at its threshold, so the error of the response is quadratic in the
  /// error of the switching time. Friction tension is discontinuous, so its tolerance is smaller.
  static constexpr double kSwitchCloseness = 1e-4, kSlipCloseness = 1e-8;
  struct Polynomial {
    int a, b;
    V square, cube;  ///< T = square e² + cube e³
  };

  [[nodiscard]] WHEELTAP_INLINE int masses() const { return N > 0 ? N : masses_; }

  /// Computes side · e - threshold.
  WHEELTAP_INLINE static V reach(const Threshold& t, const V* y) {
    return t.side * (y[t.b] - y[t.a]) - t.threshold;
  }

  /// Computes the coefficients of y_i(τ) = Σ terms[k][i] τᵏ from the equation of motion in the
  /// regime of `sign_`. The time τ [sample intervals] is 0 at the instant at which the fraction
  /// `left` of the sample interval remains:
  ///   (k + 1)(k + 2) y_{k+2} = h² (drive_k + M⁻¹ [-K y_k - C (k + 1) y_{k+1} / h - T(e)_k]),
  /// with the powers of e by Cauchy products.
  WHEELTAP_INLINE void expand(const V* y, const V* v, const V* now, const V* then, V left,
                              V terms[][M]) {
    const int m = masses(), links = kSerial && N > 0 ? N : task_.links, degree = task_.degree;
    const double h2 = task_.step * task_.step, per_step = 1.0 / task_.step;
    V stretch[kMaxPolynomials][kMaxDegree], square[kMaxPolynomials][kMaxDegree];
    terms[0][0] = terms[1][0] = V{};
    WHEELTAP_UNROLL
    for (int i = 1; i <= m; ++i) {
      terms[0][i] = y[i];
      terms[1][i] = v[i];
    }
    for (int k = 0; k + 2 <= degree; ++k) {
      V pull[M];
      WHEELTAP_UNROLL
      for (int i = 0; i <= m; ++i) pull[i] = V{};
      WHEELTAP_UNROLL
      for (int l = 0; l < links; ++l) {
        const LinkTerm& link = task_.link[l];
        const int from = kSerial ? l : link.a, to = kSerial ? l + 1 : link.b;
        const V e = terms[k][to] - terms[k][from], rate = terms[k + 1][to] - terms[k + 1][from];
        const V tension = c_[link.slot] * e + ((k + 1) * per_step) * c_[link.slot + 1] * rate;
        pull[from] += tension;
        pull[to] -= tension;
      }
      for (int i = 0; i < switches_; ++i) {
        const Threshold& t = thresholds_[i];
        V e = terms[k][t.b] - terms[k][t.a];
        if (k == 0) e -= t.side * t.threshold;
        const V tension = sign_[i] > 0.0 ? t.stiffness * e : V{};
        pull[t.a] += tension;
        pull[t.b] -= tension;
      }
      for (int p = 0; p < polynomial_count_; ++p) {
        const Polynomial& law = polynomials_[p];
        V *e = stretch[p], *q = square[p];
        e[k] = terms[k][law.b] - terms[k][law.a];
        V twice{};
        for (int j = 0; 2 * j < k; ++j) twice += e[j] * e[k - j];
        q[k] = 2.0 * twice;
        if (k % 2 == 0) q[k] += e[k / 2] * e[k / 2];
        V tension = law.square * q[k];
        if (cubes_) {
          V third{};
          for (int j = 0; j <= k; ++j) third += e[j] * q[k - j];
          tension += law.cube * third;
        }
        pull[law.a] += tension;
        pull[law.b] -= tension;
      }
      const double share = 1.0 / ((k + 1) * (k + 2));
      V sum[M];
      sum[0] = terms[k + 2][0] = V{};
      WHEELTAP_UNROLL
      for (int i = 1; i <= m; ++i) {
        sum[i] = scaled_inverse_[i] * pull[i];
        if (k == 0) sum[i] += h2 * (then[i] + left * (now[i] - then[i]));
        if (k == 1) sum[i] += h2 * (then[i] - now[i]);
      }
      if (friction_.size() > 0) friction_.pull(k == 0, sum, tension_[k]);
      WHEELTAP_UNROLL
      for (int i = 1; i <= m; ++i) terms[k + 2][i] = share * sum[i];
    }
  }

  /// Computes h² z̈ without friction.
  void accelerate(const V* y, const V* v, const V* drive, V* acceleration) const {
    const double rate = 1.0 / task_.step, unit = task_.step * task_.step;
    V speed[M], pull[M];
    speed[0] = acceleration[0] = V{};
    for (int i = 1; i <= masses(); ++i) speed[i] = rate * v[i];
    motion_.forces(y, speed, nullptr, pull, nullptr);
    for (int i = 1; i <= masses(); ++i)
      acceleration[i] = unit * drive[i] + scaled_inverse_[i] * pull[i];
  }

  /// Returns the first time in [0, length] at which link f changes between stick and slip (length
  /// <= 1 sample interval), or 2 if the link does not change. Writes to `side` the direction (+1 or
  /// -1) in which the friction link starts to slide.
  V first_change(int f, const V terms[][M], V length, V& side) const {
    const int degree = task_.degree;
    const V state = friction_.state(f), force = friction_.force(f);
    V g[kMaxDegree + 2], other[kMaxDegree + 2];
    for (int k = 0; k <= degree; ++k) {
      const V rate = k < degree ? (k + 1) * state * friction_.across(f, terms[k + 1]) : V{};
      const V held = k + 2 <= degree ? tension_[k][f] : V{};
      const V spare = k == 0 ? force : V{};
      g[k] = state == 0.0 ? spare - held : rate;
      other[k] = state == 0.0 ? spare + held : V{};
    }
    g[degree + 1] = V{};
    shift(g, fresh_slip_[f] > 0.0 ? V{} + 1.0 : V{});
    shift(g, fresh_slip_[f] > 1.0 ? V{} + 1.0 : V{});
    const V first = first_root(g, length, kSlipCloseness);
    side = V{} + 1.0;
    if (!friction_.sticking()) return first;
    other[0] = state == 0.0 ? other[0] : V{} + 1.0;
    const V second = first_root(other, length, kSlipCloseness);
    side = second < first ? V{} - 1.0 : side;
    return second < first ? second : first;
  }

  /// Changes the stick-slip state of the links in the lanes of `change` (one entry per link). In
  /// the lanes of `unwatched`, events are not detected; the velocities give the stick-slip state.
  void stick_or_slip(const V* change, const V* side, V until, const V* y, V* v, const V* now,
                     const V* then, V left, V unwatched) {
    const int links = friction_.size();
    V stopping = unwatched, breaking{}, at_rest[kMaxFrictions] = {}, was[kMaxFrictions];
    for (int f = 0; f < links; ++f) {
      was[f] = friction_.state(f);
      const V broken = was[f] == 0.0 ? change[f] : V{};
      // The value is 2 at break-away (ė = ë = 0). If no time has elapsed, links that already slip
      // keep their value. All other values become 0.
      const V kept = was[f] == 0.0 ? V{} : fresh_slip_[f];
      fresh_slip_[f] = broken > 0.0 ? V{} + 2.0 : until > 0.0 ? V{} : kept;
      stopping = lanes::max(stopping, was[f] == 0.0 ? V{} : change[f]);
      breaking = lanes::max(breaking, broken);
      friction_.break_away(f, broken > 0.0 ? side[f] : V{});
    }
    if (any(breaking)) friction_.factor();
    if (!any(stopping)) return;
    for (int f = 0; f < links; ++f) {
      const V missed = friction_.state(f) * friction_.across(f, v) < 0.0 ? unwatched : V{};
      const V stopped = lanes::max(change[f], missed);
      at_rest[f] = stopping > 0.0 ? (was[f] == 0.0 ? V{} + 1.0 : stopped) : V{};
      friction_.stop(f, was[f] == 0.0 ? V{} : stopped);
    }
    V drive[M], free[M];
    drive[0] = V{};
    for (int i = 1; i <= masses(); ++i) drive[i] = then[i] + left * (now[i] - then[i]);
    accelerate(y, v, drive, free);
    friction_.settle(at_rest, v, free);
    for (int f = 0; f < links; ++f) {
      const V fresh = at_rest[f] > 0.0 ? V{} + 1.0 : fresh_slip_[f];
      fresh_slip_[f] = friction_.state(f) == 0.0 ? V{} : fresh;
    }
  }

  /// Returns the first time in [0, length] at which force law i switches (length <= 1 sample
  /// interval): sign · (side · e - threshold) becomes negative. Returns 2 if the law does not
  /// switch. If the force law has just switched, the polynomial has a root at the start, which is
  /// first removed.
  WHEELTAP_INLINE V first_root(int i, V fresh, const V terms[][M], V length) const {
    const Threshold& t = thresholds_[i];
    const int degree = task_.degree;
    V g[kMaxDegree + 2];
    for (int k = 0; k <= degree; ++k) {
      g[k] = terms[k][t.b] - terms[k][t.a];
      g[k] = sign_[i] * (t.side * g[k] - (k == 0 ? t.threshold : V{}));
    }
    g[degree + 1] = V{};
    shift(g, fresh);
    return first_root(g, length, kSwitchCloseness);
  }

  /// In the lanes of `fresh`, divides the polynomial g by τ, which removes the root of g at τ = 0.
  WHEELTAP_INLINE void shift(V* g, V fresh) const {
    for (int k = 0; k <= task_.degree; ++k) g[k] = fresh > 0.0 ? g[k + 1] : g[k];
  }

  /// Returns the first time in [0, length] at which g becomes negative (length <= 1 sample
  /// interval), or 2 if g does not become negative.
  WHEELTAP_INLINE V first_root(const V* g, V length, double closeness) const {
    const int degree = task_.degree;
    V falls[kMaxDegree + 1] = {};
    for (int k = 0; k < degree; ++k) falls[k] = -(k + 1) * g[k + 1];
    const V end = horner(g, degree, length), fall = horner(falls, degree - 1, length);
    V high = length, at_high = end, found = end < 0.0 ? V{} + 1.0 : V{};
    // If g is positive at both ends, a root is possible if each end tangent is negative at the
    // other end.
    const V tangents = lanes::max(g[0] + length * g[1], end + length * fall);
    const V dips = found > 0.0 ? V{} : tangents < 0.0 ? V{} + 1.0 : V{};
    if (any(dips)) {
      const V bottom = turn(falls, degree - 1, length, fall, dips, closeness);
      const V depth = horner(g, degree, bottom);
      const V reached = depth < 0.0 ? dips : V{};
      high = reached > 0.0 ? bottom : high;
      at_high = reached > 0.0 ? depth : at_high;
      found = reached > 0.0 ? reached : found;
    }
    if (!any(found)) return V{} + 2.0;
    const V root = turn(g, degree, high, at_high, found, closeness);
    return found > 0.0 ? root : V{} + 2.0;
  }

  WHEELTAP_INLINE static V horner(const V* g, int degree, V x) {
    V sum = g[degree];
    for (int k = degree - 1; k >= 0; --k) sum = g[k] + x * sum;
    return sum;
  }

  /// Finds the root of g in [0, high] in each lane that `wanted` selects, by Newton's method with
  /// bisection as safeguard. Requires at_high = g(high) < 0. The last Newton step is at most
  /// `closeness` sample intervals, so that the error of the root is about the square of
  /// `closeness`.
  static V turn(const V* g, int degree, V high, V at_high, V wanted, double closeness) {
    V low{}, x = g[0] > 0.0 ? high * g[0] / (g[0] - at_high) : 0.5 * high, open = wanted;
    for (int i = 0; i < 60 && any(open); ++i) {
      V value = g[degree], slope{};
      for (int k = degree - 1; k >= 0; --k) {
        slope = value + x * slope;
        value = g[k] + x * value;
      }
      low = value >= 0.0 ? x : low;
      high = value >= 0.0 ? high : x;
      const V newton = x - value / slope, middle = 0.5 * (low + high);
      const V inside = newton > low ? (newton < high ? newton : middle) : middle;  // also if NaN
      const V moved = lanes::abs(inside - x);
      x = open > 0.0 ? inside : x;
      open = moved > closeness ? open : V{};
    }
    return x;
  }

  const Task& task_;
  const V* c_;
  Motion motion_;
  Friction<N> friction_;
  int masses_;
  V scaled_inverse_[M];  ///< h² / m
  int switches_ = 0, polynomial_count_ = 0;
  bool cubes_ = false, accelerometers_ = false;
  Threshold thresholds_[kMaxThresholds];
  V sign_[kMaxThresholds];
  Polynomial polynomials_[kMaxPolynomials];
  V tension_[kMaxDegree][kMaxFrictions];  ///< friction tension in the current segment, as a series
  /// 1 if slip began with ė = 0 at the start of the segment, 2 if slip began with ė = 0 and ë = 0.
  V fresh_slip_[kMaxFrictions];
};

}  // namespace wheeltap::dynamics::kernel::WHEELTAP_KERNEL
