// The time loops over vectors of parameter sets. Included by each kernel_*.cpp, which first defines
//   WHEELTAP_KERNEL  a namespace of its own, so that no two instruction sets share a symbol,
//   WHEELTAP_LANES   how many doubles a vector holds.
// Compiled without contraction to fused multiply-add: every width gives the same bits.
#pragma once

#include <type_traits>

#include "dynamics/kernel.hpp"
#include "dynamics/lane_math.hpp"
#include "dynamics/laws.hpp"

namespace wheeltap::dynamics::kernel::WHEELTAP_KERNEL {

using V __attribute__((vector_size(8 * WHEELTAP_LANES))) = double;

#define WHEELTAP_INLINE [[gnu::always_inline]] inline
#define WHEELTAP_UNROLL _Pragma("GCC unroll 8")

WHEELTAP_INLINE const V* vectors(const double* p) {
  return reinterpret_cast<const V*>(p);
}
WHEELTAP_INLINE V* vectors(double* p) {
  return reinterpret_cast<V*>(p);
}

WHEELTAP_INLINE bool all(V mask) {
  for (int lane = 0; lane < WHEELTAP_LANES; ++lane)
    if (mask[lane] == 0.0) return false;
  return true;
}

WHEELTAP_INLINE bool any(V mask) {
  for (int lane = 0; lane < WHEELTAP_LANES; ++lane)
    if (mask[lane] != 0.0) return true;
  return false;
}

/// 1 in every lane where x is not within the bound (NaN included), else 0.
WHEELTAP_INLINE V outside(V x, double bound) {
  return x <= bound ? V{} : V{} + 1.0;
}

constexpr std::int64_t kSamplesBetweenChecks = 64;

/// What both loops do with a sample: score it or store it.
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

  /// Whether there is no use in going on: sums of squares only grow.
  WHEELTAP_INLINE bool hopeless() const {
    if (task_.weights == nullptr) return false;
    V total{};
    for (int i = 0; i < task_.sensors; ++i) total += task_.weights[i] * vectors(task_.sums)[i];
    return all(outside(total, task_.limit));
  }

 private:
  const Task& task_;
  const V* c_;
  std::int64_t next_ = 0;
  std::int64_t sample_ = -1;
};

/// Whether trajectories go on, and which of them failed.
class Watch {
 public:
  explicit Watch(const Task& task) : task_(task) {}

  WHEELTAP_INLINE void saw(V displacement) { peak_ = lanes::max(lanes::abs(displacement), peak_); }

  /// Now and then: whether every lane has blown up, or is not worth going on with.
  WHEELTAP_INLINE bool over(std::int64_t sample, const Output& output) {
    if (sample % kSamplesBetweenChecks != 0) return false;
    if (all(outside(peak_, task_.bound))) return true;
    if (!output.hopeless()) return false;
    peak_ = V{} + 2.0 * task_.bound;
    return true;
  }

  /// `trace` is 0 times the sum of the state: a NaN stays in the state, and shows there.
  WHEELTAP_INLINE void finish(V trace) const {
    vectors(task_.failed)[0] = lanes::max(outside(peak_, task_.bound), outside(trace, 0.0));
  }

 private:
  const Task& task_;
  V peak_{};
};

/// visit(i, link, stiffness, threshold, side) for every law that is a spring beyond a threshold,
/// the i-th of them.
template <class Visitor>
WHEELTAP_INLINE void for_each_threshold(const Task& task, Visitor visit) {
  int i = 0;
  for (int l = 0; l < task.links; ++l) {
    const LinkTerm& link = task.link[l];
    for (int j = link.law_begin; j < link.law_end; ++j) {
      const V* c = vectors(task.coefficients) + task.law[j].slot;
      LawList::visit(task.law[j].kind, [&](auto law) {
        using Law = decltype(law);
        if constexpr (kPiecewiseLinear<Law>)
          visit(i++, link, c[0], Law::threshold(c), c[Law::kInfo.size()]);
      });
    }
  }
}

struct AnyLaw {};

/// N > 0: number of masses; 0: task.masses. kSerial: link i joins masses i and i + 1. OnlyLaw: the
/// one kind of law there is, which spares the choice at every link.
template <int N, bool kSerial, class OnlyLaw>
class RungeKutta {
 public:
  explicit RungeKutta(const Task& task)
      : task_(task), c_(vectors(task.coefficients)), masses_(N > 0 ? N : task.masses) {
    const int n = masses();
    const double h = task_.step / task_.substeps;
    inverse_mass_[0] = V{};
    WHEELTAP_UNROLL
    for (int i = 1; i <= n; ++i) {
      inverse_mass_[i] = 1.0 / c_[i - 1];
      half_inverse_[i] = 0.5 * h * inverse_mass_[i];
      full_inverse_[i] = h * inverse_mass_[i];
      sixth_inverse_[i] = h / 6.0 * inverse_mass_[i];
    }
  }

  void run() {
    const int n = masses();
    V y[M], v[M], q[kMaxMemories], drive_now[M], drive_next[M];
    y[0] = v[0] = V{};
    WHEELTAP_UNROLL
    for (int i = 1; i <= n; ++i) {
      y[i] = c_[task_.initial_slot + i - 1];
      v[i] = c_[task_.initial_slot + n + i - 1];
    }
    for (int m = 0; m < memories(); ++m) q[m] = V{};
    Output output(task_);
    Watch watch(task_);
    excite(0, drive_now);

    for (std::int64_t sample = 0;; ++sample) {
      const bool last = sample + 1 == task_.samples;
      excite(last ? sample : sample + 1, drive_next);
      advance(
          y, v, q, drive_now, drive_next, [&](const V* a) __attribute__((always_inline)) {
            if (output.due(sample)) emit(output, sample, y, v, a);
            return last;
          });
      if (last) break;
      WHEELTAP_UNROLL
      for (int i = 1; i <= n; ++i) {
        drive_now[i] = drive_next[i];
        watch.saw(y[i]);
      }
      if (watch.over(sample, output)) break;
    }
    V trace{};
    WHEELTAP_UNROLL
    for (int i = 1; i <= n; ++i) trace += 0.0 * y[i] + 0.0 * v[i];
    watch.finish(trace);
  }

  static constexpr int M = (N > 0 ? N : kMaxMasses) + 1;

  /// From one sample to the next, with drives linear between. `seen` is given the accelerations at
  /// the first sample, and whether to stop there.
  template <class Seen>
  WHEELTAP_INLINE void advance(V* y, V* v, V* q, const V* drive_now, const V* drive_next,
                               Seen seen) const {
    const int n = masses(), steps = task_.substeps;
    const double h = task_.step / steps, half = 0.5 * h, sixth = h / 6.0, area = h * h / 6.0;
    const double fraction = 0.5 / steps;
    V slope[M];
    WHEELTAP_UNROLL
    for (int i = 1; i <= n; ++i) slope[i] = (drive_next[i] - drive_now[i]) * fraction;
    for (int s = 0; s < steps; ++s) {
      // 0   |
      // 1/2 | 1/2
      // 1/2 | 0   1/2
      // 1   | 0   0   1
      //     | 1/6 1/3 1/3 1/6     Those of y are those of v: y gains h v + h²/6 (a1 + a2 + a3).
      // A stage is a chain of dependent operations: what it knows before its forces, v + h drive
      // / 2, is added beforehand.
      V a1[M], a2[M], a3[M], known[M], yi[M], vi[M], vn[M], drive[M], pull[M];
      V q1[kMaxMemories], q2[kMaxMemories], q3[kMaxMemories], q4[kMaxMemories], qi[kMaxMemories];
      yi[0] = vi[0] = vn[0] = V{};
      WHEELTAP_UNROLL
      for (int i = 1; i <= n; ++i) {
        drive[i] = drive_now[i] + (2.0 * s) * slope[i];
        known[i] = v[i] + half * drive[i];
        yi[i] = y[i] + half * v[i];
      }
      forces(y, v, q, pull, q1);
      WHEELTAP_UNROLL
      for (int i = 1; i <= n; ++i) {
        vi[i] = known[i] + half_inverse_[i] * pull[i];
        a1[i] = drive[i] + inverse_mass_[i] * pull[i];
      }
      if (s == 0 && seen(a1)) return;

      WHEELTAP_UNROLL
      for (int i = 1; i <= n; ++i) {
        drive[i] += slope[i];
        known[i] = v[i] + half * drive[i];
      }
      for (int m = 0; m < memories(); ++m) qi[m] = q[m] + half * q1[m];
      forces(yi, vi, qi, pull, q2);
      WHEELTAP_UNROLL
      for (int i = 1; i <= n; ++i) {
        yi[i] = y[i] + half * vi[i];
        vn[i] = known[i] + half_inverse_[i] * pull[i];
        a2[i] = drive[i] + inverse_mass_[i] * pull[i];
      }

      for (int m = 0; m < memories(); ++m) qi[m] = q[m] + half * q2[m];
      WHEELTAP_UNROLL
      for (int i = 1; i <= n; ++i) known[i] = v[i] + h * drive[i];
      forces(yi, vn, qi, pull, q3);
      WHEELTAP_UNROLL
      for (int i = 1; i <= n; ++i) {
        yi[i] = y[i] + h * vn[i];
        vi[i] = known[i] + full_inverse_[i] * pull[i];
        a3[i] = drive[i] + inverse_mass_[i] * pull[i];
      }

      for (int m = 0; m < memories(); ++m) qi[m] = q[m] + h * q3[m];
      WHEELTAP_UNROLL
      for (int i = 1; i <= n; ++i) {
        drive[i] += slope[i];
        const V middle = a2[i] + a3[i];
        known[i] = v[i] + sixth * (a1[i] + drive[i] + 2.0 * middle);
        y[i] += h * v[i] + area * (a1[i] + middle);
      }
      forces(yi, vi, qi, pull, q4);
      WHEELTAP_UNROLL
      for (int i = 1; i <= n; ++i) v[i] = known[i] + sixth_inverse_[i] * pull[i];
      for (int m = 0; m < memories(); ++m) q[m] += sixth * (q1[m] + q4[m] + 2.0 * (q2[m] + q3[m]));
    }
  }

  /// drive[i] = F_i / m_i - ÿ_base at a sample.
  WHEELTAP_INLINE void excite(std::int64_t sample, V* drive) const {
    const int n = masses();
    V force[M], base{};
    WHEELTAP_UNROLL
    for (int i = 1; i <= n; ++i) force[i] = V{};
    for (int j = 0; j < task_.drives; ++j) {
      const DriveTerm& term = task_.drive[j];
      const V value = c_[term.slot] * term.samples[sample] + c_[term.slot + 1];
      if (term.mass == 0)
        base += value;
      else
        force[term.mass] += value;
    }
    WHEELTAP_UNROLL
    for (int i = 1; i <= n; ++i) drive[i] = force[i] * inverse_mass_[i] - base;
  }

  /// Of laws without memory.
  WHEELTAP_INLINE void accelerations(std::int64_t sample, const V* y, const V* v, V* a) const {
    const int n = masses();
    V pull[M];
    excite(sample, a);
    forces(y, v, nullptr, pull, nullptr);
    a[0] = V{};
    WHEELTAP_UNROLL
    for (int i = 1; i <= n; ++i) a[i] += inverse_mass_[i] * pull[i];
  }

  /// The sum of the tensions on every mass, and the rates of the laws' own states.
  WHEELTAP_INLINE void forces(const V* y, const V* v, const V* q, V* pull, V* q_rate) const {
    const int n = masses();
    pull[0] = V{};
    WHEELTAP_UNROLL
    for (int i = 1; i <= n; ++i) pull[i] = V{};
    const int links = kSerial && N > 0 ? N : task_.links;
    WHEELTAP_UNROLL
    for (int l = 0; l < links; ++l) {
      const LinkTerm& link = task_.link[l];
      const int from = kSerial ? l : link.a, to = kSerial ? l + 1 : link.b;
      const V e = y[to] - y[from], rate = v[to] - v[from];
      V tension = c_[link.slot] * e;
      for (int j = link.law_begin; j < link.law_end; ++j)
        tension += apply(task_.law[j], e, rate, q, q_rate);
      tension += c_[link.slot + 1] * rate;  // last: within a stage the velocities are known last
      pull[from] += tension;
      pull[to] -= tension;
    }
  }

  WHEELTAP_INLINE V apply(const LawTerm& term, V e, V rate, const V* q, V* q_rate) const {
    if constexpr (std::is_same_v<OnlyLaw, AnyLaw>) {
      V tension{};
      LawList::visit(
          term.kind, [&](auto law) __attribute__((always_inline)) {
            tension = apply(law, term, e, rate, q, q_rate);
          });
      return tension;
    } else {
      return apply(OnlyLaw{}, term, e, rate, q, q_rate);
    }
  }

  template <class Law>
  WHEELTAP_INLINE V apply(Law, const LawTerm& term, V e, V rate, const V* q, V* q_rate) const {
    const V* c = c_ + term.slot;
    if constexpr (Law::kInfo.memory) {
      static_assert(!Law::kInfo.one_sided);
      q_rate[term.memory] = Law::memory_rate(c, e, rate, q[term.memory]);
      return Law::tension(c, e, rate, q[term.memory]);
    } else if constexpr (Law::kInfo.one_sided) {
      const V side = c[Law::kInfo.size()];
      return side * Law::tension(c, side * e, side * rate);
    } else {
      return Law::tension(c, e, rate);
    }
  }

  WHEELTAP_INLINE void emit(Output& output, std::int64_t sample, const V* y, const V* v,
                            const V* a) const {
    const int n = masses();
    V motion[3][M];  // a copy, so that y, v and a need not live in memory
    WHEELTAP_UNROLL
    for (int i = 1; i <= n; ++i) {
      motion[0][i] = y[i];
      motion[1][i] = v[i];
      motion[2][i] = a[i];
    }
    for (int i = 0; i < task_.sensors; ++i)
      output.take(sample, i, motion[task_.sensor[i].quantity][task_.sensor[i].mass]);
  }

 private:
  [[nodiscard]] WHEELTAP_INLINE int masses() const { return N > 0 ? N : masses_; }
  [[nodiscard]] WHEELTAP_INLINE int memories() const {
    if constexpr (std::is_same_v<OnlyLaw, AnyLaw>)
      return task_.memories;
    else
      return OnlyLaw::kInfo.memory ? task_.memories : 0;
  }

  const Task& task_;
  const V* c_;
  int masses_;
  V inverse_mass_[M], half_inverse_[M], full_inverse_[M], sixth_inverse_[M];
};

/// The exact solution of a linear chain. With the state x = (z, h ż) and the inputs u linear over a
/// step,
///
///   x⁺ = Φ x + Γ₀ u + Γ₁ u⁺,  Φ = e^A, Γ₁ = φ₂(A) B, Γ₀ = φ₁(A) B - Γ₁,
///   A = [0 1; -h² M⁻¹K  -h M⁻¹C],  φ₁(A) = Σ Aᵏ/(k+1)!,  φ₂(A) = Σ Aᵏ/(k+2)!
///
/// (the first-order hold; Van Loan 1978 gives the integrals). The loop propagates w = x - Γ₁ u,
/// which takes one product with u a step: w⁺ = Φ w + (Φ Γ₁ + Γ₀) u.
template <int N>
class Exact {
 public:
  /// With `thresholds` the constant input 1 follows the others, for the forces of springs that
  /// begin elsewhere than at e = 0.
  explicit Exact(const Task& task, bool thresholds = false)
      : task_(task),
        c_(vectors(task.coefficients)),
        free_(vectors(task.scratch)),
        masses_(N > 0 ? N : task.masses),
        inputs_(task.drives + (thresholds ? 1 : 0)) {
    const int n = order(), j = inputs_;
    transition_ = take(n * n);
    phi2_ = take(n * n);
    product_ = take(n * n);
    lower_ = take(masses() * n);
    input_ = take(masses() * j);
    gamma0_ = take(n * j);
    gamma1_ = take(n * j);
    gain_ = take(n * j);
    shifted_ = take(n * j);
    rows_ = take(task.sensors * n);
    feed_ = take(task.sensors * j);
    u_ = take(j);
    state_ = take(n);
  }

  void run() {
    discretise(0);
    observe();
    propagate();
  }

 protected:
  static constexpr int kOrder = N > 0 ? 2 * N : 2 * kMaxMasses;
  [[nodiscard]] WHEELTAP_INLINE int masses() const { return N > 0 ? N : masses_; }
  [[nodiscard]] WHEELTAP_INLINE int order() const { return 2 * masses(); }

  V* take(int size) {
    V* block = free_;
    free_ += size;
    return block;
  }

  /// The lower half of A and of B, in units of the step, with the laws whose bit is set in
  /// `regime`: springs T = k e - side · k · threshold.
  void assemble(unsigned regime) {
    const int m = masses(), n = order();
    const double h = task_.step, h2 = h * h;
    for (int i = 0; i < m * n; ++i) lower_[i] = V{};
    const auto add = [&](int row, int column, V k, V c) {
      lower_[row * n + column] -= k;
      lower_[row * n + m + column] -= c;
    };
    for (int l = 0; l < task_.links; ++l) {
      const LinkTerm& link = task_.link[l];
      const int a = link.a - 1, b = link.b - 1;
      const V k = h2 * c_[link.slot], c = h * c_[link.slot + 1];
      if (a >= 0) add(a, a, k, c);
      if (b >= 0) add(b, b, k, c);
      if (a >= 0 && b >= 0) {
        add(a, b, -k, -c);
        add(b, a, -k, -c);
      }
    }
    for (int i = 0; i < m * inputs_; ++i) input_[i] = V{};
    for_each_threshold(task_, [&](int j, const LinkTerm& link, V stiffness, V threshold, V side) {
      if ((regime >> j & 1U) == 0) return;
      const int a = link.a - 1, b = link.b - 1, last = inputs_ - 1;
      const V k = h2 * stiffness, force = side * k * threshold;
      if (a >= 0) add(a, a, k, V{});
      if (b >= 0) add(b, b, k, V{});
      if (a >= 0 && b >= 0) {
        add(a, b, -k, V{});
        add(b, a, -k, V{});
      }
      if (a >= 0) input_[a * inputs_ + last] -= force;
      if (b >= 0) input_[b * inputs_ + last] += force;
    });
    for (int i = 0; i < m; ++i) {
      for (int j = 0; j < n; ++j) lower_[i * n + j] /= c_[i];
      for (int j = 0; j < inputs_; ++j) input_[i * inputs_ + j] /= c_[i];
      for (int j = 0; j < task_.drives; ++j) {
        const int mass = task_.drive[j].mass;
        input_[i * inputs_ + j] = mass == 0 ? V{} - h2 : mass == i + 1 ? h2 / c_[i] : V{};
      }
    }
  }

  /// y ← factor A x, y and x n × columns. The upper half of A only moves rows up.
  void multiply_a(double factor, const V* x, V* y, int columns) const {
    const int m = masses(), n = order();
    for (int i = 0; i < m; ++i)
      for (int j = 0; j < columns; ++j) {
        y[i * columns + j] = factor * x[(m + i) * columns + j];
        V sum{};
        for (int k = 0; k < n; ++k) sum += lower_[i * n + k] * x[k * columns + j];
        y[(m + i) * columns + j] = factor * sum;
      }
  }

  /// y ← Φ x.
  void multiply_transition(const V* x, V* y, int columns) const {
    const int n = order();
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < columns; ++j) {
        V sum{};
        for (int k = 0; k < n; ++k) sum += transition_[i * n + k] * x[k * columns + j];
        y[i * columns + j] = sum;
      }
  }

  /// Taylor polynomials at A/2ˢ, whose norm is at most 1/2 (remainder 3e-18), then s doublings:
  /// Φ(2A) = Φ², φ₁(2A) = (Φ + 1) φ₁ / 2, φ₂(2A) = (Φ φ₂ + φ₁ + φ₂) / 4.
  void discretise(unsigned regime) {
    assemble(regime);
    const int m = masses(), n = order(), j = inputs_;
    constexpr int kDegree = 13;
    double factor = 1.0;
    for (int s = 0; s < task_.halvings; ++s) factor *= 0.5;
    double coefficient = 1.0;  // 1 / (degree + 2)!
    for (int k = 2; k <= kDegree + 2; ++k) coefficient /= k;
    for (int i = 0; i < n * n; ++i) phi2_[i] = V{};
    for (int i = 0; i < n; ++i) phi2_[i * n + i] = V{} + coefficient;
    for (int k = kDegree; k > 0; --k) {
      coefficient *= k + 2;
      multiply_a(factor, phi2_, product_, n);
      for (int i = 0; i < n * n; ++i) phi2_[i] = product_[i];
      for (int i = 0; i < n; ++i) phi2_[i * n + i] += coefficient;
    }
    multiply_a(factor, phi2_, product_, n);  // φ₁ = A φ₂ + 1
    for (int i = 0; i < n; ++i) product_[i * n + i] += 1.0;
    multiply_a(factor, product_, transition_, n);  // Φ = A φ₁ + 1
    for (int i = 0; i < n; ++i) transition_[i * n + i] += 1.0;

    // gamma1 = φ₂ B and gain = φ₁ B, B zero in its upper half. Over the short step B is factor · B.
    for (int i = 0; i < n; ++i)
      for (int c = 0; c < j; ++c) {
        V first{}, second{};
        for (int k = 0; k < m; ++k) {
          first += product_[i * n + m + k] * input_[k * j + c];
          second += phi2_[i * n + m + k] * input_[k * j + c];
        }
        gain_[i * j + c] = factor * first;
        gamma1_[i * j + c] = factor * second;
      }
    for (int s = 0; s < task_.halvings; ++s) {
      multiply_transition(gamma1_, gamma0_, j);
      multiply_transition(gain_, shifted_, j);
      for (int i = 0; i < n * j; ++i) {
        gamma1_[i] = 0.5 * (gamma0_[i] + gain_[i] + gamma1_[i]);
        gain_[i] = shifted_[i] + gain_[i];
      }
      multiply_transition(transition_, product_, n);
      for (int i = 0; i < n * n; ++i) transition_[i] = product_[i];
    }
    for (int i = 0; i < n * j; ++i) gamma0_[i] = gain_[i] - gamma1_[i];
    multiply_transition(gamma1_, gain_, j);
    for (int i = 0; i < n * j; ++i) gain_[i] += gamma0_[i];
  }

  /// Sensor i reads rows · w + feed · u: of w only one entry unless it is an accelerometer.
  void observe() {
    const int m = masses(), n = order(), j = inputs_;
    const double h = task_.step;
    for (int i = 0; i < task_.sensors; ++i) {
      const int mass = task_.sensor[i].mass - 1, quantity = task_.sensor[i].quantity;
      if (quantity == 2) {
        for (int k = 0; k < n; ++k) rows_[i * n + k] = lower_[mass * n + k] / (h * h);
        for (int c = 0; c < j; ++c) {
          V sum = input_[mass * j + c] / (h * h);
          for (int k = 0; k < n; ++k) sum += rows_[i * n + k] * gamma1_[k * j + c];
          feed_[i * j + c] = sum;
        }
      } else {
        const int row = quantity == 1 ? m + mass : mass;
        const double unit = quantity == 1 ? 1.0 / h : 1.0;
        rows_[i * n] = V{} + unit;
        for (int c = 0; c < j; ++c) feed_[i * j + c] = unit * gamma1_[row * j + c];
      }
    }
  }

  WHEELTAP_INLINE void excite(std::int64_t sample) {
    for (int j = 0; j < task_.drives; ++j) {
      const DriveTerm& term = task_.drive[j];
      u_[j] = c_[term.slot] * term.samples[sample] + c_[term.slot + 1];
    }
  }

  WHEELTAP_INLINE void emit(Output& output, std::int64_t sample) const {
    const int m = masses(), n = order();
    for (int i = 0; i < task_.sensors; ++i) {
      const SensorTerm& s = task_.sensor[i];
      V motion{};
      if (s.quantity == 2) {
        WHEELTAP_UNROLL
        for (int k = 0; k < n; ++k) motion += rows_[i * n + k] * state_[k];
      } else {
        motion = rows_[i * n] * state_[s.quantity == 1 ? m + s.mass - 1 : s.mass - 1];
      }
      for (int c = 0; c < inputs_; ++c) motion += feed_[i * inputs_ + c] * u_[c];
      output.take(sample, i, motion);
    }
  }

  void propagate() {
    const int m = masses(), n = order();
    V w[kOrder], next[kOrder];
    excite(0);
    WHEELTAP_UNROLL
    for (int i = 0; i < n; ++i) {
      w[i] = c_[task_.initial_slot + i] * (i < m ? 1.0 : task_.step);
      for (int j = 0; j < inputs_; ++j) w[i] -= gamma1_[i * inputs_ + j] * u_[j];
    }
    Output output(task_);
    Watch watch(task_);
    for (std::int64_t sample = 0;; ++sample) {
      if (output.due(sample)) {
        WHEELTAP_UNROLL
        for (int i = 0; i < n; ++i) state_[i] = w[i];
        emit(output, sample);
      }
      if (sample + 1 == task_.samples) break;
      WHEELTAP_UNROLL
      for (int i = 0; i < n; ++i) {
        V sum{};
        WHEELTAP_UNROLL
        for (int k = 0; k < n; ++k) sum += transition_[i * n + k] * w[k];
        for (int j = 0; j < inputs_; ++j) sum += gain_[i * inputs_ + j] * u_[j];
        next[i] = sum;
      }
      WHEELTAP_UNROLL
      for (int i = 0; i < n; ++i) w[i] = next[i];
      WHEELTAP_UNROLL
      for (int i = 0; i < m; ++i) watch.saw(w[i]);
      if (watch.over(sample, output)) break;
      excite(sample + 1);
    }
    V trace{};
    WHEELTAP_UNROLL
    for (int i = 0; i < n; ++i) trace += 0.0 * w[i];
    watch.finish(trace);
  }

  const Task& task_;
  const V* c_;
  V* free_;  ///< what is left of the scratch memory
  int masses_, inputs_;
  V *transition_, *phi2_, *product_, *lower_, *input_;
  V *gamma0_, *gamma1_, *gain_, *shifted_, *rows_, *feed_, *u_, *state_;
};

/// Springs that are polynomials, or linear beyond a threshold, by Taylor series in time: the
/// solution between two samples is analytic but for the times at which a law switches. A sample is
/// gone through in pieces, each a series that ends at its length or where the first law reaches its
/// threshold. (A step across a switch would be wrong by the square of its length, and by more or
/// less of it as the switch moves within the step: a likelihood is then rugged where it is not.)
template <int N, bool kSerial>
class Series {
 public:
  using Steps = RungeKutta<N, kSerial, AnyLaw>;
  static constexpr int M = Steps::M;

  explicit Series(const Task& task)
      : task_(task),
        c_(vectors(task.coefficients)),
        steps_(task),
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
    steps_.excite(0, now);
    for (std::int64_t sample = 0;; ++sample) {
      if (output.due(sample)) show(output, sample, y, v);
      if (sample + 1 == task_.samples) break;
      steps_.excite(sample + 1, then);
      advance(y, v, now, then, V{} + 1.0);
      WHEELTAP_UNROLL
      for (int i = 1; i <= m; ++i) {
        now[i] = then[i];
        watch.saw(y[i]);
      }
      if (watch.over(sample, output)) break;
    }
    V trace{};
    WHEELTAP_UNROLL
    for (int i = 1; i <= m; ++i) trace += 0.0 * y[i] + 0.0 * v[i];
    watch.finish(trace);
  }

  struct Threshold {
    int a, b;
    V side, threshold, stiffness;
  };
  [[nodiscard]] WHEELTAP_INLINE int switches() const { return switches_; }
  [[nodiscard]] WHEELTAP_INLINE const Threshold& threshold(int i) const { return thresholds_[i]; }
  /// 1 in the lanes in which a law acts, -1 where it does not.
  [[nodiscard]] WHEELTAP_INLINE V sign(int i) const { return sign_[i]; }

  /// The regime at y.
  WHEELTAP_INLINE void start(const V* y) {
    for (int i = 0; i < switches_; ++i)
      sign_[i] = reach(thresholds_[i], y) > 0.0 ? V{} + 1.0 : V{} - 1.0;
  }

  /// y and v (in units of a sample's time) one sample on, in the lanes that move; `now` and `then`
  /// are the drives at its ends.
  WHEELTAP_INLINE void advance(V* y, V* v, const V* now, const V* then, V moving) {
    const int m = masses(), degree = task_.degree;
    const V piece = V{} + 1.0 / task_.substeps;
    V terms[kMaxDegree + 1][M], fresh[kMaxThresholds], root[kMaxThresholds];
    for (int i = 0; i < switches_; ++i) fresh[i] = V{};
    V left = moving;  // of the sample
    for (int pieces = 0; any(left); ++pieces) {
      const bool watching = pieces < task_.substeps + kMostSwitches;
      const V length = left > 1.000001 * piece ? piece : left;
      expand(y, v, now, then, left, terms);
      V until = length;
      for (int i = 0; i < switches_; ++i) {
        root[i] = watching ? first_root(i, fresh[i], terms, length) : V{} + 2.0;
        until = root[i] < until ? root[i] : until;
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
      left = left > 0.0 ? left - until : left;
      for (int i = 0; i < switches_ && !watching; ++i) {
        const V now_acts = reach(thresholds_[i], y) > 0.0 ? V{} + 1.0 : V{} - 1.0;
        sign_[i] = moving > 0.0 ? now_acts : sign_[i];
      }
    }
  }

  /// `v` in units of a sample's time.
  WHEELTAP_INLINE void show(Output& output, std::int64_t sample, const V* y, const V* v) const {
    const double rate = 1.0 / task_.step;
    V speed[M], a[M];
    const int m = masses();
    speed[0] = V{};
    WHEELTAP_UNROLL
    for (int i = 1; i <= m; ++i) speed[i] = rate * v[i];
    if (accelerometers_) {
      steps_.accelerations(sample, y, speed, a);
    } else {
      for (int i = 0; i <= m; ++i) a[i] = V{};
    }
    steps_.emit(output, sample, y, speed, a);
  }

  WHEELTAP_INLINE void excite(std::int64_t sample, V* drive) const { steps_.excite(sample, drive); }

 private:
  /// Switches in one sample; a law that chatters about its threshold ends there.
  static constexpr int kMostSwitches = 32;
  static constexpr int kMaxPower = 3;
  struct Polynomial {
    int a, b;
    V square, cube;  ///< T = square e² + cube e³
  };

  [[nodiscard]] WHEELTAP_INLINE int masses() const { return N > 0 ? N : masses_; }

  /// side · e - threshold.
  WHEELTAP_INLINE static V reach(const Threshold& t, const V* y) {
    return t.side * (y[t.b] - y[t.a]) - t.threshold;
  }

  /// y_i(τ) = Σ terms[k][i] τᵏ, τ in samples from the time when `left` of this one is to come, by
  /// the equation of motion of the regime that `sign_` says:
  ///   (k + 1)(k + 2) y_{k+2} = h² (drive_k + M⁻¹ [-K y_k - C (k + 1) y_{k+1} / h - T(e)_k]),
  /// the powers of e by Cauchy products.
  WHEELTAP_INLINE void expand(const V* y, const V* v, const V* now, const V* then, V left,
                              V terms[][M]) const {
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
      terms[k + 2][0] = V{};
      WHEELTAP_UNROLL
      for (int i = 1; i <= m; ++i) {
        V sum = scaled_inverse_[i] * pull[i];
        if (k == 0) sum += h2 * (then[i] + left * (now[i] - then[i]));
        if (k == 1) sum += h2 * (then[i] - now[i]);
        terms[k + 2][i] = share * sum;
      }
    }
  }

  /// The first time in [0, length] at which law i, which keeps its state while sign · (side · e -
  /// threshold) > 0, has to change it; 2 where there is none. One that has just changed begins at
  /// its threshold, which is taken out of the polynomial.
  WHEELTAP_INLINE V first_root(int i, V fresh, const V terms[][M], V length) const {
    const Threshold& t = thresholds_[i];
    const int degree = task_.degree;
    V g[kMaxDegree + 2], falls[kMaxDegree + 1];
    for (int k = 0; k <= degree; ++k) {
      g[k] = terms[k][t.b] - terms[k][t.a];
      g[k] = sign_[i] * (t.side * g[k] - (k == 0 ? t.threshold : V{}));
    }
    g[degree + 1] = V{};
    for (int k = 0; k <= degree; ++k) g[k] = fresh > 0.0 ? g[k + 1] : g[k];
    for (int k = 0; k < degree; ++k) falls[k] = -(k + 1) * g[k + 1];
    const V end = horner(g, degree, length), fall = horner(falls, degree - 1, length);
    V high = length, at_high = end, found = end < 0.0 ? V{} + 1.0 : V{};
    // Between ends that are both above, where the tangents at both go below.
    const V tangents = lanes::max(g[0] + length * g[1], end + length * fall);
    const V dips = found > 0.0 ? V{} : tangents < 0.0 ? V{} + 1.0 : V{};
    if (any(dips)) {
      const V bottom = turn(falls, degree - 1, length, fall, dips);
      const V depth = horner(g, degree, bottom);
      const V reached = depth < 0.0 ? dips : V{};
      high = reached > 0.0 ? bottom : high;
      at_high = reached > 0.0 ? depth : at_high;
      found = reached > 0.0 ? reached : found;
    }
    if (!any(found)) return V{} + 2.0;
    const V root = turn(g, degree, high, at_high, found);
    return found > 0.0 ? root : V{} + 2.0;
  }

  WHEELTAP_INLINE static V horner(const V* g, int degree, V x) {
    V sum = g[degree];
    for (int k = degree - 1; k >= 0; --k) sum = g[k] + x * sum;
    return sum;
  }

  /// Where g turns negative in [0, high], g(high) = at_high < 0, in the lanes that are wanted:
  /// Newton's method, kept between the ends by halving. The last step is at most 1e-4 of a sample
  /// and leaves about its square; since a tension is continuous at its threshold, the state that
  /// follows is wrong by the square of that.
  static V turn(const V* g, int degree, V high, V at_high, V wanted) {
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
      const V inside = newton > low ? (newton < high ? newton : middle) : middle;  // NaN: outside
      const V moved = lanes::abs(inside - x);
      x = open > 0.0 ? inside : x;
      open = moved > 1e-4 ? open : V{};
    }
    return x;
  }

  const Task& task_;
  const V* c_;
  Steps steps_;
  int masses_;
  V scaled_inverse_[M];  ///< h² / m
  int switches_ = 0, polynomial_count_ = 0;
  bool cubes_ = false, accelerometers_ = false;
  Threshold thresholds_[kMaxThresholds];
  V sign_[kMaxThresholds];
  Polynomial polynomials_[kMaxPolynomials];
};

/// Chains whose laws are all springs beyond a threshold: linear between the switches. A sample in
/// which no law switches is stepped by the exact solution of its regime, one with a switch by
/// series. A switch shows in the sign of a law's e - threshold at the end, or in its tangents from
/// both ends crossing zero; where the sample is long beside the stiffest period all samples are
/// taken by series.
template <int N, bool kSerial>
class Piecewise : private Exact<N> {
 public:
  explicit Piecewise(const Task& task) : Exact<N>(task, true), series_(task) {
    const int n = order(), j = task.drives;
    for (unsigned r = 0; r <= 1U << task.laws; ++r)
      tables_[r] = {this->take(n * n), this->take(n * j), this->take(n * j), this->take(n), false};
    next_u_ = this->take(j);
  }

  void run() {
    const int m = this->masses(), n = order(), laws = task().laws, inputs = task().drives;
    const double h = task().step;
    V x[kOrder], next[kOrder];
    WHEELTAP_UNROLL
    for (int i = 0; i < n; ++i) x[i] = this->c_[task().initial_slot + i] * (i < m ? 1.0 : h);
    start(x);
    const Table* table = choose();
    Output output(task());
    Watch watch(task());
    this->excite(0);
    for (std::int64_t sample = 0;; ++sample) {
      if (output.due(sample)) show(output, sample, x);
      if (sample + 1 == task().samples) break;
      for (int j = 0; j < inputs; ++j) next_u_[j] = this->u_[j];
      this->excite(sample + 1);
      WHEELTAP_UNROLL
      for (int i = 0; i < n; ++i) {
        V sum = table->constant[i];
        for (int j = 0; j < inputs; ++j)
          sum += table->gamma0[i * inputs + j] * next_u_[j] +
                 table->gamma1[i * inputs + j] * this->u_[j];
        WHEELTAP_UNROLL
        for (int k = 0; k < n; ++k) sum += table->transition[i * n + k] * x[k];
        next[i] = sum;
      }
      V switched = V{} + (task().substeps > kFewPieces ? 1.0 : 0.0);
      for (int i = 0; i < laws; ++i) {
        const Threshold& t = series_.threshold(i);
        const V sign = series_.sign(i);
        const V before = sign * level(t, x), rise = sign * rate(t, x);
        const V after = sign * level(t, next), fall = sign * rate(t, next);
        const V tangents = lanes::max(before + rise, after - fall);
        switched = after < 0.0 ? V{} + 1.0 : tangents < 0.0 ? V{} + 1.0 : switched;
      }
      if (any(switched) && step(sample, x, switched, next)) table = choose();
      WHEELTAP_UNROLL
      for (int i = 0; i < n; ++i) x[i] = next[i];
      WHEELTAP_UNROLL
      for (int i = 0; i < m; ++i) watch.saw(x[i]);
      if (watch.over(sample, output)) break;
    }
    V trace{};
    WHEELTAP_UNROLL
    for (int i = 0; i < n; ++i) trace += 0.0 * x[i];
    watch.finish(trace);
  }

 private:
  using Threshold = Series<N, kSerial>::Threshold;
  static constexpr int kOrder = Exact<N>::kOrder;
  static constexpr int M = Series<N, kSerial>::M;
  static constexpr int kFewPieces = 2;
  struct Table {
    V *transition, *gamma0, *gamma1, *constant;
    bool ready;
  };

  [[nodiscard]] WHEELTAP_INLINE int order() const { return 2 * this->masses(); }
  [[nodiscard]] WHEELTAP_INLINE const Task& task() const { return this->task_; }

  /// side · e - threshold, and its growth in a step.
  WHEELTAP_INLINE V level(const Threshold& t, const V* x) const {
    return t.side * (end(t.b, x) - end(t.a, x)) - t.threshold;
  }
  WHEELTAP_INLINE V rate(const Threshold& t, const V* x) const {
    return t.side * (end(t.b, x + this->masses()) - end(t.a, x + this->masses()));
  }
  WHEELTAP_INLINE static V end(int mass, const V* x) { return mass == 0 ? V{} : x[mass - 1]; }

  /// The table of the regime that `series_` is in; lanes in different regimes have theirs woven
  /// together.
  [[gnu::noinline]] const Table* choose() {
    unsigned regime[WHEELTAP_LANES];
    bool same = true;
    for (int lane = 0; lane < WHEELTAP_LANES; ++lane) {
      regime[lane] = 0;
      for (int i = 0; i < task().laws; ++i)
        if (series_.sign(i)[lane] > 0.0) regime[lane] |= 1U << i;
      same = same && regime[lane] == regime[0];
      prepare(tables_[regime[lane]], regime[lane]);
    }
    if (same) return &tables_[regime[0]];
    const int n = order(), j = task().drives;
    Table& mixed = tables_[1U << task().laws];
    const auto weave = [&](V* Table::*field, int size) {
      for (int lane = 0; lane < WHEELTAP_LANES; ++lane) {
        const V* from = tables_[regime[lane]].*field;
        for (int i = 0; i < size; ++i) (mixed.*field)[i][lane] = from[i][lane];
      }
    };
    weave(&Table::transition, n * n);
    weave(&Table::gamma0, n * j);
    weave(&Table::gamma1, n * j);
    weave(&Table::constant, n);
    return &mixed;
  }

  void prepare(Table& table, unsigned regime) {
    if (table.ready) return;
    table.ready = true;
    this->discretise(regime);
    const int n = order(), j = task().drives;
    for (int i = 0; i < n * n; ++i) table.transition[i] = this->transition_[i];
    for (int i = 0; i < n; ++i) {
      for (int c = 0; c < j; ++c) {
        table.gamma0[i * j + c] = this->gamma0_[i * (j + 1) + c];
        table.gamma1[i * j + c] = this->gamma1_[i * (j + 1) + c];
      }
      table.constant[i] = this->gamma0_[i * (j + 1) + j] + this->gamma1_[i * (j + 1) + j];
    }
  }

  void start(const V* x) {
    V y[M], v[M];
    unpack(x, y, v);
    series_.start(y);
  }

  /// Lanes of `switched` take their next state from series. Returns whether a regime is another at
  /// the end.
  [[gnu::noinline]] bool step(std::int64_t sample, const V* x, V switched, V* next) {
    const int m = this->masses(), laws = task().laws;
    V y[M], v[M], now[M], then[M], before[kMaxThresholds];
    unpack(x, y, v);
    for (int i = 0; i < laws; ++i) before[i] = series_.sign(i);
    series_.excite(sample, now);
    series_.excite(sample + 1, then);
    series_.advance(y, v, now, then, switched);
    bool changed = false;
    for (int i = 0; i < laws; ++i) changed = changed || !all(before[i] + series_.sign(i));
    for (int i = 0; i < m; ++i) {
      next[i] = switched > 0.0 ? y[i + 1] : next[i];
      next[m + i] = switched > 0.0 ? v[i + 1] : next[m + i];
    }
    return changed;
  }

  WHEELTAP_INLINE void unpack(const V* x, V* y, V* v) const {
    const int m = this->masses();
    y[0] = v[0] = V{};
    WHEELTAP_UNROLL
    for (int i = 0; i < m; ++i) {
      y[i + 1] = x[i];
      v[i + 1] = x[m + i];
    }
  }

  WHEELTAP_INLINE void show(Output& output, std::int64_t sample, const V* x) const {
    V y[M], v[M];
    unpack(x, y, v);
    series_.show(output, sample, y, v);
  }

  Series<N, kSerial> series_;
  Table tables_[(1U << kMaxThresholds) + 1];
  V* next_u_;
};

template <int N>
void run_runge_kutta(const Task& task) {
  if (!task.serial)
    RungeKutta<N, false, AnyLaw>(task).run();
  else if (task.only_law == LawList::index_of<laws::Cubic>())
    RungeKutta<N, true, laws::Cubic>(task).run();
  else
    RungeKutta<N, true, AnyLaw>(task).run();
}

inline void runge_kutta(const Task& task) {
  switch (task.masses) {
    case 1:
      return run_runge_kutta<1>(task);
    case 2:
      return run_runge_kutta<2>(task);
    case 3:
      return run_runge_kutta<3>(task);
    default:
      return RungeKutta<0, false, AnyLaw>(task).run();
  }
}

inline void exact(const Task& task) {
  switch (task.masses) {
    case 1:
      return Exact<1>(task).run();
    case 2:
      return Exact<2>(task).run();
    case 3:
      return Exact<3>(task).run();
    default:
      return Exact<0>(task).run();
  }
}

template <int N>
void run_piecewise(const Task& task) {
  if (task.serial)
    Piecewise<N, true>(task).run();
  else
    Piecewise<N, false>(task).run();
}

template <int N>
void run_series(const Task& task) {
  if (task.serial)
    Series<N, true>(task).run();
  else
    Series<N, false>(task).run();
}

inline void series(const Task& task) {
  switch (task.masses) {
    case 1:
      return run_series<1>(task);
    case 2:
      return run_series<2>(task);
    case 3:
      return run_series<3>(task);
    default:
      return Series<0, false>(task).run();
  }
}

inline void piecewise(const Task& task) {
  switch (task.masses) {
    case 1:
      return run_piecewise<1>(task);
    case 2:
      return run_piecewise<2>(task);
    case 3:
      return run_piecewise<3>(task);
    default:
      return Piecewise<0, false>(task).run();
  }
}

}  // namespace wheeltap::dynamics::kernel::WHEELTAP_KERNEL

namespace wheeltap::dynamics::kernel {
#define WHEELTAP_JOIN2(a, b) a##b
#define WHEELTAP_JOIN(a, b) WHEELTAP_JOIN2(a, b)
Kernel WHEELTAP_JOIN(WHEELTAP_KERNEL, _kernel)() {
  return {.lanes = WHEELTAP_LANES,
          .runge_kutta = WHEELTAP_KERNEL::runge_kutta,
          .exact = WHEELTAP_KERNEL::exact,
          .piecewise = WHEELTAP_KERNEL::piecewise,
          .series = WHEELTAP_KERNEL::series};
}
}  // namespace wheeltap::dynamics::kernel
